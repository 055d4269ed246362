"""The pixel loops of the photometric alignment, compiled by numba.

For each pixel of a marker: where on the print it looks, how much of its point spread falls on
paper there, and the derivatives of that. The point spread is a round Gaussian in the picture; on
the print it is a slanted one, and its mass on a module is taken with Mehler's series to second
order in the correlation. The four modules by four nearest to a pixel count, so a module may be as
narrow as 2.5 standard deviations of the blur.

Unknowns of the picture, in this order (`COLUMNS` of them):

========  ==========================================================================
0 to 5    small rotation of the plate about the camera's axes, rad; translation, m
6         blur, px
7 to 9    level of the ink, and its gradients along x and y
10 to 12  paper less ink, and its gradients along x and y
13        bow q of the transfer c -> c + q c (1 - c): gamma, or ink that spreads
14 to 16  of each marker: shift right and down on the print, m; turn clockwise, rad
========  ==========================================================================
"""

import math
from typing import Any

import numba as nb
import numpy as np
from numpy.typing import NDArray

from vision.marker_print import PADDING

Array = NDArray[np.float64]

SHARED = 14
COLUMNS = 17
CORE = 7
FLAT = 4.5
"""Standard deviations from the nearest border of a module past which a pixel is flat."""

_INVERSE_ROOT_TWO = 1.0 / math.sqrt(2.0)
_INVERSE_ROOT_TWO_PI = 1.0 / math.sqrt(2.0 * math.pi)


def _compiled(function: Any) -> Any:
    # NaN must stay NaN: only re-ordering of sums and products is allowed.
    allowed = {"contract", "reassoc", "nsz", "arcp", "afn"}
    return nb.njit(cache=True, error_model="numpy", fastmath=allowed)(function)


@_compiled
def _inverse(m: Array) -> Array:
    out = np.empty((3, 3))
    out[0, 0] = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    out[0, 1] = m[0, 2] * m[2, 1] - m[0, 1] * m[2, 2]
    out[0, 2] = m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]
    out[1, 0] = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    out[1, 1] = m[0, 0] * m[2, 2] - m[0, 2] * m[2, 0]
    out[1, 2] = m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]
    out[2, 0] = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    out[2, 1] = m[0, 1] * m[2, 0] - m[0, 0] * m[2, 1]
    out[2, 2] = m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
    determinant = m[0, 0] * out[0, 0] + m[0, 1] * out[1, 0] + m[0, 2] * out[2, 0]
    for i in range(3):
        for j in range(3):
            out[i, j] /= determinant
    return out


@_compiled
def _shares(
    place: float, blur: float, share: Array, by_place: Array, by_blur: Array, edges: Array
) -> int:
    """Mass of the point spread on four modules, its derivatives, and terms of the borders.

    Returns the first of the four modules. `edges` takes, of the three borders between them, the
    density and the density times its argument.
    """
    nearest = math.floor(place + 0.5)
    below, by_z_below, z_below = 0.0, 0.0, 0.0
    for k in range(4):
        if k < 3:
            z = (nearest - 1 + k - place) / blur
            if z < -5.0:
                until, density = 0.0, 0.0
            elif z > 5.0:
                until, density = 1.0, 0.0
            else:
                until = 0.5 * math.erfc(-z * _INVERSE_ROOT_TWO)
                density = math.exp(-0.5 * z * z) * _INVERSE_ROOT_TWO_PI
            edges[0, k], edges[1, k] = density, density * z
        else:
            until, density, z = 1.0, 0.0, 0.0
        share[k] = until - below
        by_place[k] = (by_z_below - density) / blur
        by_blur[k] = (by_z_below * z_below - density * z) / blur
        below, by_z_below, z_below = until, density, z
    return nearest - 2


@_compiled
def _seek_levels(
    image: Any,
    lens: Array,
    middle: Array,
    window: Any,
    paper: Array,
    homography: Array,
    focal: Array,
    principal: Array,
) -> Array:
    """Sum and number of the pixels well inside ink modules, then inside paper ones."""
    found = np.zeros(4)
    modules = paper.shape[1] - 2 * PADDING
    for m in range(len(paper)):
        back = _inverse(homography[m])
        for row in range(window[m, 1], window[m, 3]):
            for column in range(window[m, 0], window[m, 2]):
                x, y = column - middle[m, 0], row - middle[m, 1]
                ideal_x = _cubic(lens[m, 0], x, y)
                ideal_y = _cubic(lens[m, 1], x, y)
                ray_x = (ideal_x - principal[0]) / focal[0]
                ray_y = (ideal_y - principal[1]) / focal[1]
                w = back[2, 0] * ray_x + back[2, 1] * ray_y + back[2, 2]
                u = (back[0, 0] * ray_x + back[0, 1] * ray_y + back[0, 2]) / w
                v = (back[1, 0] * ray_x + back[1, 1] * ray_y + back[1, 2]) / w
                if u < 0.0 or v < 0.0 or u >= modules or v >= modules:
                    continue
                in_u, in_v = u - math.floor(u), v - math.floor(v)
                if min(in_u, in_v) > 0.3 and max(in_u, in_v) < 0.7:
                    of = 2 * int(paper[m, int(v) + PADDING, int(u) + PADDING])
                    found[of] += image[row, column]
                    found[of + 1] += 1.0
    return found


@_compiled
def _cubic(c: Array, x: float, y: float) -> float:
    value: float = (
        c[0]
        + x * (c[1] + x * (c[3] + x * c[6]) + y * (c[4] + x * c[7] + y * c[8]))
        + y * (c[2] + y * (c[5] + y * c[9]))
    )
    return value


@_compiled
def accumulate(  # noqa: PLR0912, PLR0915  one loop over pixels, kept whole
    image: Any,
    lens: Array,
    middle: Array,
    window: Any,
    paper: Array,
    reach: Array,
    homography: Array,
    translation: Array,
    focal: Array,
    principal: Array,
    size_m: Array,
    light: Array,
    origin: Array,
    scale: float,
    robust: float,
    columns: int,
) -> Any:
    """Normal equations of all pixels of some markers.

    Parameters
    ----------
    image
        Grey levels.
    lens, middle
        Cubics about each marker (n, 2, 10), and where they are about (n, 2).
    window
        Left, top, right, bottom of the pixels to visit, (n, 4), integers.
    paper
        The prints, padded.
    reach
        Modules beyond each marker that are known to be paper, (n,).
    homography
        Print to camera frame, (n, 3, 3): columns as `MarkerPrint.frame`, rotated and moved.
    translation
        The plate's origin in the camera frame, m.
    focal, principal
        Of the camera, px.
    size_m
        Side of one module of each marker, m, (n,).
    light
        Blur, three of ink, three of contrast, and bow: (8,).
    origin, scale
        Middle and half the size of the plate in the picture, px: the gradients' coordinates.
    robust
        Residuals beyond this many grey levels pull no harder.
    columns
        14, or 17 with the markers' own three.

    Returns
    -------
    tuple
        Per marker: normal matrices (n, columns, columns), right sides (n, columns), weighted
        squares (n,), pixels (n,).
    """
    count = len(paper)
    modules = paper.shape[1] - 2 * PADDING
    normal = np.zeros((count, columns, columns))
    pull = np.zeros((count, columns))
    squares, pixels = np.zeros(count), np.zeros(count)
    j = np.zeros(columns)
    work = np.zeros((10, 4))
    slope = np.zeros((2, 2))
    for m in range(count):
        back = _inverse(homography[m])
        normal_m, pull_m = normal[m], pull[m]
        bent = lens[m, 0, 3] != 0.0 or lens[m, 1, 5] != 0.0 or lens[m, 0, 6] != 0.0
        slope[0, 0] = slope[1, 1] = 1.0
        slope[0, 1] = slope[1, 0] = 0.0
        low, high = -reach[m], modules + reach[m]
        for row in range(window[m, 1], window[m, 3]):
            for column in range(window[m, 0], window[m, 2]):
                x, y = column - middle[m, 0], row - middle[m, 1]
                if bent:
                    ideal_x, ideal_y = _through_lens(lens[m], x, y, slope)
                else:
                    ideal_x, ideal_y = lens[m, 0, 0] + x, lens[m, 1, 0] + y
                ray_x = (ideal_x - principal[0]) / focal[0]
                ray_y = (ideal_y - principal[1]) / focal[1]
                w = back[2, 0] * ray_x + back[2, 1] * ray_y + back[2, 2]
                u = (back[0, 0] * ray_x + back[0, 1] * ray_y + back[0, 2]) / w
                v = (back[1, 0] * ray_x + back[1, 1] * ray_y + back[1, 2]) / w
                if w <= 0.0 or min(u, v) < low or max(u, v) > high:
                    continue
                u_x = (back[0, 0] - u * back[2, 0]) / (w * focal[0])
                u_y = (back[0, 1] - u * back[2, 1]) / (w * focal[1])
                v_x = (back[1, 0] - v * back[2, 0]) / (w * focal[0])
                v_y = (back[1, 1] - v * back[2, 1]) / (w * focal[1])
                flat, cover, c_u, c_v, by_blur = _cover(
                    paper[m],
                    u,
                    v,
                    u_x * slope[0, 0] + u_y * slope[1, 0],
                    u_x * slope[0, 1] + u_y * slope[1, 1],
                    v_x * slope[0, 0] + v_y * slope[1, 0],
                    v_x * slope[0, 1] + v_y * slope[1, 1],
                    light[0],
                    work,
                )
                across, down = (column - origin[0]) / scale, (row - origin[1]) / scale
                contrast = light[4] + light[5] * across + light[6] * down
                seen = cover + light[7] * cover * (1.0 - cover)
                residual = (
                    image[row, column]
                    - contrast * seen
                    - (light[1] + light[2] * across + light[3] * down)
                )
                weight = 1.0 if abs(residual) <= robust else robust / abs(residual)
                if flat:
                    start = CORE
                    j[SHARED:] = 0.0
                else:
                    start = 0
                    gain = contrast * (1.0 + light[7] * (1.0 - 2.0 * cover))
                    p_x = gain * (c_u * u_x + c_v * v_x) * focal[0] * w
                    p_y = gain * (c_u * u_y + c_v * v_y) * focal[1] * w
                    p_z = -(p_x * ray_x + p_y * ray_y)
                    r_x = ray_x / w - translation[0]
                    r_y = ray_y / w - translation[1]
                    r_z = 1.0 / w - translation[2]
                    j[0] = r_z * p_y - r_y * p_z
                    j[1] = r_x * p_z - r_z * p_x
                    j[2] = r_y * p_x - r_x * p_y
                    j[3], j[4], j[5] = -p_x, -p_y, -p_z
                    j[6] = gain * by_blur
                    if columns > SHARED:
                        centre = 0.5 * modules
                        j[14] = -gain * c_u / size_m[m]
                        j[15] = -gain * c_v / size_m[m]
                        j[16] = gain * (c_u * (v - centre) - c_v * (u - centre))
                j[7], j[8], j[9] = 1.0, across, down
                j[10], j[11], j[12] = seen, seen * across, seen * down
                j[13] = contrast * cover * (1.0 - cover)
                squares[m] += weight * residual * residual
                pixels[m] += 1.0
                for a in range(start, columns):
                    weighted = weight * j[a]
                    pull_m[a] += weighted * residual
                    line = normal_m[a]
                    for b in range(a, columns):
                        line[b] += weighted * j[b]
        for a in range(columns):
            for b in range(a):
                normal[m, a, b] = normal[m, b, a]
    return normal, pull, squares, pixels


@_compiled
def _through_lens(lens: Array, x: float, y: float, slope: Array) -> tuple[float, float]:
    """Ideal pixel at an offset from the middle of a cubic; its derivatives go to `slope`."""
    for axis in range(2):
        c = lens[axis]
        slope[axis, 0] = c[1] + x * (2 * c[3] + 3 * c[6] * x) + y * (c[4] + 2 * c[7] * x + c[8] * y)
        slope[axis, 1] = c[2] + y * (2 * c[5] + 3 * c[9] * y) + x * (c[4] + 2 * c[8] * y + c[7] * x)
    return _cubic(lens[0], x, y), _cubic(lens[1], x, y)


@_compiled
def _cover(
    paper: Array,
    u: float,
    v: float,
    u_x: float,
    u_y: float,
    v_x: float,
    v_y: float,
    blur: float,
    work: Array,
) -> tuple[bool, float, float, float, float]:
    """Paper under the point spread at a place of a print.

    Parameters
    ----------
    paper
        The print, padded.
    u, v
        The place, modules.
    u_x, u_y, v_x, v_y
        Its derivatives by the picture's columns and rows.
    blur
        Standard deviation of the point spread, px.
    work
        Overwritten, (10, 4).

    Returns
    -------
    tuple
        Whether it is flat there, the cover, and its derivatives by u, by v and by blur.
    """
    steep_u = math.sqrt(u_x * u_x + u_y * u_y)
    steep_v = math.sqrt(v_x * v_x + v_y * v_y)
    spread_u, spread_v = blur * steep_u, blur * steep_v
    if (
        abs(u - math.floor(u + 0.5)) > FLAT * spread_u
        and abs(v - math.floor(v + 0.5)) > FLAT * spread_v
    ):
        level: float = paper[math.floor(v) + PADDING, math.floor(u) + PADDING]
        return True, level, 0.0, 0.0, 0.0
    share_u, by_u, blur_by_u = work[0], work[1], work[2]
    share_v, by_v, blur_by_v = work[3], work[4], work[5]
    edges_u, edges_v = work[6:8], work[8:10]
    first_u = _shares(u, spread_u, share_u, by_u, blur_by_u, edges_u) + PADDING
    first_v = _shares(v, spread_v, share_v, by_v, blur_by_v, edges_v) + PADDING
    cover, c_u, c_v, by_blur = 0.0, 0.0, 0.0, 0.0
    for k in range(4):
        line, line_u, line_b = 0.0, 0.0, 0.0
        for i in range(4):
            white = paper[first_v + k, first_u + i]
            line += share_u[i] * white
            line_u += by_u[i] * white
            line_b += blur_by_u[i] * white
        cover += share_v[k] * line
        c_u += share_v[k] * line_u
        c_v += by_v[k] * line
        by_blur += steep_u * share_v[k] * line_b + steep_v * blur_by_v[k] * line
    correlation = (u_x * v_x + u_y * v_y) / (steep_u * steep_v)
    if abs(correlation) > 1e-3:
        slant, slant2 = 0.0, 0.0
        for k in range(3):
            for i in range(3):
                corner = (
                    paper[first_v + k, first_u + i]
                    - paper[first_v + k, first_u + i + 1]
                    - paper[first_v + k + 1, first_u + i]
                    + paper[first_v + k + 1, first_u + i + 1]
                )
                slant += corner * edges_v[0, k] * edges_u[0, i]
                slant2 += corner * edges_v[1, k] * edges_u[1, i]
        cover += correlation * (slant + 0.5 * correlation * slant2)
    return False, cover, c_u, c_v, by_blur


@_compiled
def _turn(vector: Array) -> Array:
    """Rotation by a small vector (Rodrigues)."""
    angle = math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    k = np.zeros((3, 3))
    k[0, 1], k[0, 2], k[1, 2] = -vector[2], vector[1], -vector[0]
    k[1, 0], k[2, 0], k[2, 1] = vector[2], -vector[1], vector[0]
    first, second = 1.0, 0.5
    if angle > 1e-8:
        first, second = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle**2
    out = np.eye(3)
    for i in range(3):
        for c in range(3):
            square = 0.0
            for n in range(3):
                square += k[i, n] * k[n, c]
            out[i, c] += first * k[i, c] + second * square
    return out


@_compiled
def placed(frame: Array, rotation: Array, translation: Array) -> Array:
    """Prints in the camera frame: `MarkerPrint.frame` rotated and moved."""
    out = np.empty_like(frame)
    for m in range(len(frame)):
        for i in range(3):
            for j in range(3):
                total = 0.0
                for k in range(3):
                    total += rotation[i, k] * frame[m, k, j]
                out[m, i, j] = total
            out[m, i, 2] += translation[i]
    return out


@_compiled
def align(
    image: Any,
    lens: Array,
    middle: Array,
    window: Any,
    paper: Array,
    reach: Array,
    frame: Array,
    size_m: Array,
    rotation: Array,
    translation: Array,
    focal: Array,
    principal: Array,
    light: Array,
    origin: Array,
    scale: float,
    blur_limits: Any,
    most_steps: int,
) -> Any:
    """Levenberg-Marquardt on pose and light; arguments as `accumulate`.

    Returns
    -------
    tuple
        Rotation, translation, light, normal matrix (14, 14), weighted squares, pixels, whether it
        settled.
    """
    homography = placed(frame, rotation, translation)
    levels = _seek_levels(image, lens, middle, window, paper, homography, focal, principal)
    light = light.copy()
    if levels[1] > 0.0 and levels[3] > 0.0:
        light[1] = levels[0] / levels[1]
        light[4] = max(levels[2] / levels[3] - light[1], 1.0)
    light[2] = light[3] = light[5] = light[6] = light[7] = 0.0
    robust, damping, settled = 1e9, 1e-6, False
    prior = np.zeros(SHARED)
    normals, pulls, parts, counts = accumulate(
        image,
        lens,
        middle,
        window,
        paper,
        reach,
        homography,
        translation,
        focal,
        principal,
        size_m,
        light,
        origin,
        scale,
        robust,
        SHARED,
    )
    squares, pixels = parts.sum(), counts.sum()
    for step in range(most_steps):
        noise = squares / max(pixels - SHARED, 1.0)
        prior[7:13] = noise / (2.0 * light[4]) ** 2
        prior[13] = noise / 0.09
        prior[6] = noise / 0.25
        normal = normals.sum(axis=0)
        pull = pulls.sum(axis=0)
        for a in range(SHARED):
            normal[a, a] = normal[a, a] * (1.0 + damping) + prior[a]
        pull[13] -= prior[13] * light[7]
        change = np.linalg.solve(normal, pull)
        # A step beyond half a module leaves the range in which the derivatives mean anything.
        change[6] = min(max(change[6], -0.3), 0.3)
        new_rotation = _turn(change[:3]) @ rotation
        new_translation = translation + change[3:6]
        new_light = light + change[6:14]
        new_light[0] = min(max(new_light[0], blur_limits[0]), blur_limits[1])
        new_light[7] = min(max(new_light[7], -0.8), 0.8)
        if not np.isfinite(change).all() or new_translation[2] <= 0.0 or new_light[4] <= 0.0:
            break
        homography = placed(frame, new_rotation, new_translation)
        limit = 5.0 * math.sqrt(noise) if step > 0 else 1e9
        tried = accumulate(
            image,
            lens,
            middle,
            window,
            paper,
            reach,
            homography,
            new_translation,
            focal,
            principal,
            size_m,
            new_light,
            origin,
            scale,
            limit,
            SHARED,
        )
        tried_squares, tried_pixels = tried[2].sum(), tried[3].sum()
        # Pixels come and go at the rim: compare means.
        mean, tried_mean = squares / max(pixels, 1.0), tried_squares / max(tried_pixels, 1.0)
        if tried_pixels < 50.0 or tried_mean > mean * (1.0 + 1e-3):
            damping = max(damping, 1e-4) * 30.0
            if damping > 1e3:
                break
            continue
        rotation, translation, light = new_rotation, new_translation, new_light
        normals, pulls, squares, pixels = tried[0], tried[1], tried_squares, tried_pixels
        damping = max(damping / 30.0, 1e-6)
        gain = 0.0
        for a in range(SHARED):
            gain += change[a] * pull[a]
        if gain < 1e-3 * noise and step > 0 and limit < 1e8:
            settled = True
            break
    return rotation, translation, light, normals.sum(axis=0), squares, pixels, settled
