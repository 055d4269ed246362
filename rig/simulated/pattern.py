"""What is printed on the marker plate, seen through a blur: squares convolved with a Gaussian.

Plate coordinates: u to the right, v up, in the plane of the print, m.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Marker, Plate

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""Left, bottom, right and top, m."""

NEGLIGIBLE_CORRELATION = 0.005
"""Below this the slant of the spread changes no pixel by more than 1e-3 of the contrast."""

NEGLIGIBLE_CORRELATION = 0.005
"""Below this the slant of the spread changes no pixel by more than 1e-3 of the contrast."""


@dataclass(frozen=True)
class Ink:
    """One marker.

    Attributes
    ----------
    left_m, top_m
        Its top-left corner.
    module_m
        Side of one module.
    black
        1 where a module is black, rows from the top, framed by zeros; shape (n + 2, n + 2).
    """

    left_m: float
    top_m: float
    module_m: float
    black: Array

    @property
    def box(self) -> Box:
        """The marker's outline."""
        side = (self.black.shape[0] - 2) * self.module_m
        return self.left_m, self.top_m - side, self.left_m + side, self.top_m


def ink_of(marker: Marker, dictionary: str) -> Ink:
    """The print of a marker of one of OpenCV's dictionaries.

    Raises
    ------
    DataError
        There is no such dictionary or no such marker in it.
    """
    import cv2

    number = getattr(cv2.aruco, dictionary, None) if dictionary.startswith("DICT_") else None
    if number is None:
        raise DataError(f"no marker dictionary {dictionary!r}", where="plate.dictionary")
    book = cv2.aruco.getPredefinedDictionary(number)
    if marker.id >= len(book.bytesList):
        raise DataError(
            f"{dictionary} has no marker {marker.id}",
            where="plate",
            allowed=f"ids 0 to {len(book.bytesList) - 1}",
        )
    modules = int(book.markerSize) + 2
    black = (cv2.aruco.generateImageMarker(book, marker.id, modules, borderBits=1) == 0) * 1.0
    u, v = marker.centre_m
    half = marker.size_m / 2.0
    return Ink(u - half, v + half, marker.size_m / modules, np.pad(black, 1))


def paper_box(plate: Plate) -> Box:
    """Left, bottom, right and top of the white paper round the markers, m."""
    boxes = np.array(
        [
            (u - size / 2, v - size / 2, u + size / 2, v + size / 2)
            for (u, v), size in ((marker.centre_m, marker.size_m) for marker in plate.markers())
        ]
    )
    left, bottom = boxes[:, :2].min(axis=0) - plate.margin_m
    right, top = boxes[:, 2:].max(axis=0) + plate.margin_m
    return float(left), float(bottom), float(right), float(top)


def _normal_cdf(z: Array) -> Array:
    from scipy.special import ndtr

    result: Array = ndtr(z)
    return result


def _normal_density(z: Array) -> Array:
    result: Array = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
    return result


def band_cover(place: Array, low: float, high: float, blur: Array) -> Array:
    """How much of the point spread at each place lies between two edges."""
    return _normal_cdf((place - low) / blur) - _normal_cdf((place - high) / blur)


def ink_cover(
    ink: Ink, u: Array, v: Array, blur_u: Array, blur_v: Array, correlation: Array
) -> Array:
    """How much of the point spread at each pixel falls on the marker's black modules.

    A round spread in the picture is a slanted one on a plate seen obliquely; its correlation
    enters to first order (Mehler's series), which changes corners and leaves edges alone. The
    module under the pixel and its eight neighbours count: exact to 2e-4 of the contrast where a
    module is at least 3.5 standard deviations of the blur wide; smaller ones cannot be decoded.
    """
    modules, width = ink.black.shape[0] - 2, ink.black.shape[1]
    column, across = _shares((u - ink.left_m) / ink.module_m, blur_u / ink.module_m, modules)
    row, down = _shares((ink.top_m - v) / ink.module_m, blur_v / ink.module_m, modules)
    flat = ink.black.ravel()
    under = row * width + column
    slanted = float(np.abs(correlation).max()) > NEGLIGIBLE_CORRELATION
    cover = np.zeros(u.shape)
    for step_down, (share_v, slope_v) in zip((-1, 0, 1), down, strict=True):
        line, slope_line = np.zeros(u.shape), np.zeros(u.shape)
        for step_right, (share_u, slope_u) in zip((-1, 0, 1), across, strict=True):
            black = flat.take(under + (step_down * width + step_right))
            line += share_u * black
            if slanted:
                slope_line += slope_u * black
        cover += share_v * line
        if slanted:
            cover -= correlation * slope_v * slope_line  # rows run down, v runs up
    return cover


_Share = tuple[Array, Array]


def _shares(
    place: Array, blur: Array, modules: int
) -> tuple[NDArray[np.int64], tuple[_Share, _Share, _Share]]:
    """The module under each pixel, counted from 1, and what falls on it and on its neighbours.

    For the module before, it and the one after: the spread's mass there, and the difference of its
    density between the two ends. Pixels outside the marker are counted to its first or last
    module, from which they are far.
    """
    cell = np.clip(np.floor(place), 0.0, modules - 1.0)
    offset = place - cell
    to_start, to_end = -offset / blur, (1.0 - offset) / blur
    before, until = _normal_cdf(to_start), _normal_cdf(to_end)
    at_start, at_end = _normal_density(to_start), _normal_density(to_end)
    return cell.astype(np.int64) + 1, (
        (before, at_start),
        (until - before, at_end - at_start),
        (1.0 - until, -at_end),
    )
