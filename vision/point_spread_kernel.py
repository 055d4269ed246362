"""How much of a pixel's point spread falls on paper, and its derivatives; compiled by numba.

The point spread is a round Gaussian in the picture; on the print it is a slanted one, and its mass
on a module is taken with Mehler's series to second order in the correlation. The four modules by
four nearest to a pixel count, so a module may be as narrow as 2.5 standard deviations of the blur.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vision.compiled import compiled
from vision.marker_print import PADDING

Array = NDArray[np.float64]

FLAT = 4.5
"""Standard deviations from the nearest border of a module past which a pixel is flat."""

_INVERSE_ROOT_TWO = 1.0 / math.sqrt(2.0)
_INVERSE_ROOT_TWO_PI = 1.0 / math.sqrt(2.0 * math.pi)


@compiled
def covered(
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


@compiled
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
