"""The light of each pixel of the printed plate, compiled: see `rig.simulated.pattern`.

It runs without Python's lock: the amplifiers of a rig that is being recorded answer meanwhile.
"""

from math import erfc, exp, pi, sqrt
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FLAT = 6.0
"""A blurred edge is flat beyond this many standard deviations (1e-9 of its height)."""

NEGLIGIBLE_CORRELATION = 0.005
"""Below this the slant of the spread changes no pixel by more than 1e-3 of the contrast."""


class Print(NamedTuple):
    """What is printed.

    Attributes
    ----------
    paper
        Left, bottom, right and top of the white paper, m, shape (4,).
    place
        Left, top and module of each marker, m, shape (n, 3).
    black
        1 where a module is black, rows from the top, framed by zeros, shape (n, k + 2, k + 2).
    """

    paper: Array
    place: Array
    black: Array


class Levels(NamedTuple):
    """Brightness as fractions of full scale, blur in px, and the slope of the light over u."""

    white: float
    black: float
    background: float
    blur_px: float
    shading: float


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _below(z: float) -> float:
    """The part of a normal distribution below z."""
    if z > FLAT:
        return 1.0
    return 0.5 * erfc(-z / sqrt(2.0)) if z > -FLAT else 0.0


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _density(z: float) -> float:
    return exp(-0.5 * z * z) / sqrt(2.0 * pi) if abs(z) < FLAT else 0.0


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _shares(place: float, blur: float, modules: int, shares: Array, slopes: Array) -> int:
    """The module under a pixel, counted from 1, and what falls on it and on its neighbours.

    For the module before, it and the one after: the spread's mass there, and the difference of its
    density between the two ends. Pixels outside the marker are counted to its first or last
    module.
    """
    cell = min(max(np.floor(place), 0.0), modules - 1.0)
    to_start, to_end = (cell - place) / blur, (cell + 1.0 - place) / blur
    before, until = _below(to_start), _below(to_end)
    at_start, at_end = _density(to_start), _density(to_end)
    shares[0], shares[1], shares[2] = before, until - before, 1.0 - until
    slopes[0], slopes[1], slopes[2] = at_start, at_end - at_start, -at_end
    return int(cell) + 1


@numba.njit(cache=True, nogil=True, error_model="numpy")
def show(image: Array, rays: Array, to_plate: Array, printed: Print, levels: Levels) -> None:
    """Add the light of the plate to a picture of what is behind it.

    A round spread in the picture is a slanted one on a plate seen obliquely; its correlation
    enters to first order (Mehler's series), which changes corners and leaves edges alone. The
    module under the pixel and its eight neighbours count: exact to 2e-4 of the contrast where a
    module is at least 3.5 standard deviations of the blur wide; smaller ones cannot be decoded.

    Parameters
    ----------
    image
        Fractions of full scale, shape (h, w).
    rays
        x and y of each pixel's ray, and what each changes by column and by row: x, y, x by column,
        x by row, y by column, y by row; shape (6, h, w).
    to_plate
        Ray (x, y, 1) to (u w, v w, w), shape (3, 3).
    printed, levels
        What it looks like.
    """
    m, paper = to_plate, printed.paper
    modules = printed.black.shape[1] - 2
    across, down = np.empty(3), np.empty(3)
    slope_u, slope_v = np.empty(3), np.empty(3)
    middle, width = 0.5 * (paper[0] + paper[2]), paper[2] - paper[0]
    for i in range(image.shape[0]):
        for j in range(image.shape[1]):
            x, y = rays[0, i, j], rays[1, i, j]
            nearness = m[2, 0] * x + m[2, 1] * y + m[2, 2]
            if nearness <= 0.0:
                continue
            inverse = 1.0 / nearness
            u = (m[0, 0] * x + m[0, 1] * y + m[0, 2]) * inverse
            v = (m[1, 0] * x + m[1, 1] * y + m[1, 2]) * inverse
            u_by_x, u_by_y = (m[0, 0] - u * m[2, 0]) * inverse, (m[0, 1] - u * m[2, 1]) * inverse
            v_by_x, v_by_y = (m[1, 0] - v * m[2, 0]) * inverse, (m[1, 1] - v * m[2, 1]) * inverse
            u_column = u_by_x * rays[2, i, j] + u_by_y * rays[4, i, j]
            u_row = u_by_x * rays[3, i, j] + u_by_y * rays[5, i, j]
            v_column = v_by_x * rays[2, i, j] + v_by_y * rays[4, i, j]
            v_row = v_by_x * rays[3, i, j] + v_by_y * rays[5, i, j]
            steep_u, steep_v = sqrt(u_column**2 + u_row**2), sqrt(v_column**2 + v_row**2)
            blur_u, blur_v = levels.blur_px * steep_u, levels.blur_px * steep_v
            reach_u, reach_v = FLAT * blur_u, FLAT * blur_v
            if not (paper[0] - reach_u < u < paper[2] + reach_u):
                continue
            if not (paper[1] - reach_v < v < paper[3] + reach_v):
                continue
            on_paper = _below((u - paper[0]) / blur_u) - _below((u - paper[2]) / blur_u)
            on_paper *= _below((v - paper[1]) / blur_v) - _below((v - paper[3]) / blur_v)
            plate = levels.white * on_paper
            correlation = (u_column * v_column + u_row * v_row) / (steep_u * steep_v)
            slanted = abs(correlation) > NEGLIGIBLE_CORRELATION
            for k in range(len(printed.place)):
                left, top, module = printed.place[k]
                side = modules * module
                if not (left - reach_u < u < left + side + reach_u):
                    continue
                if not (top - side - reach_v < v < top + reach_v):
                    continue
                column = _shares((u - left) / module, blur_u / module, modules, across, slope_u)
                row = _shares((top - v) / module, blur_v / module, modules, down, slope_v)
                cover = 0.0
                for a in range(3):
                    line, slope_line = 0.0, 0.0
                    for b in range(3):
                        black = printed.black[k, row + a - 1, column + b - 1]
                        line += across[b] * black
                        slope_line += slope_u[b] * black
                    cover += down[a] * line
                    if slanted:
                        cover -= correlation * slope_v[a] * slope_line  # rows run down, v runs up
                plate -= (levels.white - levels.black) * cover
            plate *= 1.0 + levels.shading * (u - middle) / width
            image[i, j] += plate - levels.background * on_paper
