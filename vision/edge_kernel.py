"""The loops of the edge fit and of the pose fit, compiled by numba."""

import math
from typing import Any

import numba as nb
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

EDGE = 6
"""Unknowns of a side: offset, slope, dark, bright, blur, gradient."""

SETTLED = 4
"""Iterations in which the band of pixels still moves with the line."""

_INVERSE_ROOT_TWO = 1.0 / math.sqrt(2.0)
_INVERSE_ROOT_TWO_PI = 1.0 / math.sqrt(2.0 * math.pi)


def _compiled(function: Any) -> Any:
    return nb.njit(cache=True, error_model="numpy")(function)


@_compiled
def fit_edges(  # noqa: PLR0912  one loop over pixels, kept whole
    t: Array,
    e: Array,
    level: Array,
    used: Array,
    inward: Array,
    outward: Array,
    usual: Array,
    weight: Array,
    largest_step: Array,
    blur_limits: Array,
    iterations: int,
) -> Any:
    """Gauss-Newton on each side: the blurred step of `vision.corners`.

    Parameters
    ----------
    t, e, level, used
        Pixels beside m sides, (m, k): place along and across, grey level, 1 where used.
    inward, outward
        How far from the line pixels count, (m,).
    usual, weight
        Prior mean and weight of the unknowns, (6,); those of the levels are filled in here.
    largest_step
        Of each unknown in one iteration, (6,).
    blur_limits
        Least and greatest blur, px.
    iterations
        How many.

    Returns
    -------
    tuple
        Values (m, 6), normal matrices (m, 6, 6), sums of squares (m,), pixels (m,).
    """
    count, most = t.shape
    values = np.zeros((count, EDGE))
    normals = np.zeros((count, EDGE, EDGE))
    squares, pixels = np.zeros(count), np.zeros(count)
    j = np.zeros(EDGE)
    pull = np.zeros(EDGE)
    near = np.zeros(most, np.bool_)
    for m in range(count):
        value, normal = values[m], normals[m]
        prior = usual.copy()
        dark, darks, bright, brights = 0.0, 0.0, 0.0, 0.0
        for k in range(most):
            if used[m, k] == 0.0:
                continue
            if -inward[m] <= e[m, k] < -0.5:
                dark, darks = dark + level[m, k], darks + 1.0
            elif 0.5 < e[m, k] <= outward[m]:
                bright, brights = bright + level[m, k], brights + 1.0
        prior[2], prior[3] = dark / max(darks, 1.0), bright / max(brights, 1.0)
        value[:] = prior
        for iteration in range(iterations + 1):
            if iteration < SETTLED:
                for k in range(most):
                    distance = e[m, k] - value[0] - value[1] * t[m, k]
                    near[k] = used[m, k] > 0.0 and -inward[m] <= distance <= outward[m]
            normal[:, :] = 0.0
            for a in range(EDGE):
                normal[a, a] = weight[a]
                pull[a] = weight[a] * (prior[a] - value[a])
            squares[m], pixels[m] = 0.0, 0.0
            for k in range(most):
                if not near[k]:
                    continue
                z = (e[m, k] - value[0] - value[1] * t[m, k]) / value[4]
                step = 0.5 * math.erfc(-z * _INVERSE_ROOT_TWO)
                light = 1.0 + value[5] * t[m, k]
                rise = value[3] - value[2]
                density = math.exp(-0.5 * z * z) * _INVERSE_ROOT_TWO_PI * rise * light / value[4]
                plain = value[2] + rise * step
                j[0], j[1] = -density, -density * t[m, k]
                j[2], j[3] = light * (1.0 - step), light * step
                j[4], j[5] = -density * z, plain * t[m, k]
                residual = level[m, k] - light * plain
                squares[m] += residual * residual
                pixels[m] += 1.0
                for a in range(EDGE):
                    pull[a] += j[a] * residual
                    for b in range(a, EDGE):
                        normal[a, b] += j[a] * j[b]
            for a in range(EDGE):
                for b in range(a):
                    normal[a, b] = normal[b, a]
            if iteration == iterations:
                break
            change = np.linalg.solve(normal, pull)
            for a in range(EDGE):
                value[a] += min(max(change[a], -largest_step[a]), largest_step[a])
            value[4] = min(max(value[4], blur_limits[0]), blur_limits[1])
    return values, normals, squares, pixels


@_compiled
def turned(rotation: Array, point: Array) -> tuple[float, float, float]:
    """A point turned by a rotation."""
    r, p = rotation, point
    return (
        r[0, 0] * p[0] + r[0, 1] * p[1] + r[0, 2] * p[2],
        r[1, 0] * p[0] + r[1, 1] * p[1] + r[1, 2] * p[2],
        r[2, 0] * p[0] + r[2, 1] * p[1] + r[2, 2] * p[2],
    )


@_compiled
def pose_equations(
    rotation: Array,
    translation: Array,
    flat: Array,
    pixels: Array,
    whiten: Array,
    focal: Array,
    principal: Array,
) -> Any:
    """Normal equations of a pose for whitened corners.

    Parameters
    ----------
    rotation, translation
        From plate to camera.
    flat
        Corners in the plate frame, (4 n, 3).
    pixels
        Where they are seen, (4 n, 2).
    whiten
        Of each marker's eight coordinates, (n, 8, 8).
    focal, principal
        Of the camera, px.

    Returns
    -------
    tuple
        Normal matrix (6, 6), right side (6,), chi-squared, sum of squared misses in px2; infinite
        chi-squared where a corner is behind the camera.
    """
    normal, pull = np.zeros((6, 6)), np.zeros(6)
    chi_squared, misses = 0.0, 0.0
    raw, white = np.zeros((8, 7)), np.zeros(7)
    for n in range(len(whiten)):
        for corner in range(4):
            i = 4 * n + corner
            r_x, r_y, r_z = turned(rotation, flat[i])
            x, y, z = r_x + translation[0], r_y + translation[1], r_z + translation[2]
            if z <= 0.0:
                return normal, pull, np.inf, np.inf
            for axis in range(2):
                along = x if axis == 0 else y
                by_x = focal[0] / z if axis == 0 else 0.0
                by_y = focal[1] / z if axis == 1 else 0.0
                by_z = -focal[axis] * along / (z * z)
                row = raw[2 * corner + axis]
                row[0] = by_z * r_y - by_y * r_z
                row[1] = by_x * r_z - by_z * r_x
                row[2] = by_y * r_x - by_x * r_y
                row[3], row[4], row[5] = by_x, by_y, by_z
                row[6] = pixels[i, axis] - principal[axis] - focal[axis] * along / z
                misses += row[6] * row[6]
        for a in range(8):
            white[:] = 0.0
            for b in range(a + 1):  # the inverse of a Cholesky factor is lower triangular
                for c in range(7):
                    white[c] += whiten[n, a, b] * raw[b, c]
            chi_squared += white[6] * white[6]
            for c in range(6):
                pull[c] += white[c] * white[6]
                for d in range(6):
                    normal[c, d] += white[c] * white[d]
    return normal, pull, chi_squared, misses
