"""Normal equations of the photometric alignment, pixel by pixel; compiled by numba.

For each pixel of a marker: where on the print it looks, how much of its point spread falls on
paper there, and the derivatives of that.

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

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision.compiled import compiled
from vision.marker_print import PADDING
from vision.point_spread_kernel import covered
from vision.projection_kernel import inverse, through_lens

Array = NDArray[np.float64]

SHARED = 14
"""Unknowns of pose and light, which all markers share."""

COLUMNS = 17

CORE = 7
"""Those that a flat pixel says nothing of: pose and blur."""


@compiled
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
        back = inverse(homography[m])
        normal_m, pull_m = normal[m], pull[m]
        bent = lens[m, 0, 3] != 0.0 or lens[m, 1, 5] != 0.0 or lens[m, 0, 6] != 0.0
        slope[0, 0] = slope[1, 1] = 1.0
        slope[0, 1] = slope[1, 0] = 0.0
        low, high = -reach[m], modules + reach[m]
        for row in range(window[m, 1], window[m, 3]):
            for column in range(window[m, 0], window[m, 2]):
                x, y = column - middle[m, 0], row - middle[m, 1]
                if bent:
                    ideal_x, ideal_y = through_lens(lens[m], x, y, slope)
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
                flat, cover, c_u, c_v, by_blur = covered(
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
