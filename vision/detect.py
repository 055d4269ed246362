"""Finding markers in a picture: which ids, and their corners to a fraction of a pixel."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision.dictionary import modules_across, open_dictionary

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

CORNER_WINDOW_MODULES = 0.8
"""Window of OpenCV's corner refinement, as a fraction of a module.

Its default since 4.9, 0.3, is one pixel on a marker of 30 px: worse than no refinement at all
(0.66 px against 0.15 px; notes on vision, C2).
"""

CORNER_PRECISION_PX = 0.3
"""How well the corners found here are known: 0.15 px of noise and as much inward bias."""


@dataclass(frozen=True)
class Markers:
    """Markers found in one picture.

    Attributes
    ----------
    ids
        n of them, each once, ascending.
    corners
        TL, TR, BR, BL of each, px of the picture, shape (n, 4, 2).
    """

    ids: tuple[int, ...]
    corners: Array

    def moved(self, by_px: tuple[int, int]) -> "Markers":
        """The same, so many pixels to the right and down."""
        return Markers(self.ids, self.corners + np.array(by_px, dtype=float))

    def of(self, wanted: tuple[int, ...]) -> "Markers":
        """Those of some ids."""
        chosen = [index for index, marker in enumerate(self.ids) if marker in wanted]
        return Markers(tuple(self.ids[index] for index in chosen), self.corners[chosen])


class MarkerDetector:
    """Finds the markers of one dictionary.

    Parameters
    ----------
    dictionary
        OpenCV's name of it.

    Attributes
    ----------
    modules
        Modules along a marker's side, its black border included.
    """

    def __init__(self, dictionary: str) -> None:
        import cv2

        book = open_dictionary(dictionary)
        parameters: Any = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        parameters.relativeCornerRefinmentWinSize = CORNER_WINDOW_MODULES
        self.modules = modules_across(book)
        self._detector = cv2.aruco.ArucoDetector(book, parameters)

    def detect(self, image: Image) -> Markers:
        """Markers in a picture.

        An id seen twice is left out: which of the two is the plate's cannot be known.

        Parameters
        ----------
        image
            Grey levels, shape (height, width).
        """
        found, ids, _ = self._detector.detectMarkers(image)
        if ids is None or len(ids) == 0:
            return Markers((), np.empty((0, 4, 2)))
        numbers = np.asarray(ids).ravel()
        corners = np.asarray(found, dtype=float).reshape(-1, 4, 2)
        unique, counts = np.unique(numbers, return_counts=True)
        once = unique[counts == 1]
        order = [int(np.flatnonzero(numbers == number)[0]) for number in once]
        return Markers(tuple(int(number) for number in once), corners[order])
