"""What is printed on the marker plate.

Plate coordinates: u to the right, v up, in the plane of the print, m.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Marker, Plate
from rig.simulated.pattern_kernel import Print

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""Left, bottom, right and top, m."""


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


def print_of(plate: Plate) -> Print:
    """What is printed on a plate, as its light is computed from it.

    Raises
    ------
    DataError
        A marker is none of the dictionary, or there is no such dictionary.
    """
    inks = [ink_of(marker, plate.dictionary) for marker in plate.markers()]
    place = np.array([(one.left_m, one.top_m, one.module_m) for one in inks])
    return Print(np.array(paper_box(plate)), place, np.stack([one.black for one in inks]))
