"""What is printed: the modules of each marker of a plate, and where they lie in the plate frame.

A marker's own coordinates count modules from its top-left corner: u to the right, v down.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.dictionary import modules_across, open_dictionary
from vision.plate import Plate

Array = NDArray[np.float64]

PADDING = 3
"""Modules of paper kept round each marker's own, so that no neighbour is looked up outside."""


@dataclass(frozen=True)
class MarkerPrint:
    """The print of some markers of one plate.

    Attributes
    ----------
    paper
        1 where a module is paper and 0 where it is ink, padded with paper, shape
        (n, k + 2 PADDING, k + 2 PADDING).
    frame
        Columns: one module to the right, one module down, and the top-left corner, in the plate
        frame, m: shape (n, 3, 3).
    clear_m
        Paper round each marker that is free of the others, m, shape (n,); infinite for one marker.
    """

    paper: Array
    frame: Array
    clear_m: Array

    @property
    def modules(self) -> int:
        """Modules along a side."""
        return int(self.paper.shape[1]) - 2 * PADDING

    def of(self, chosen: Sequence[int]) -> "MarkerPrint":
        """Some of the markers, by index."""
        index = list(chosen)
        return MarkerPrint(self.paper[index], self.frame[index], self.clear_m[index])


def print_of(plate: Plate) -> MarkerPrint:
    """The print of all markers of a plate, in the order of its ids."""
    book = open_dictionary(plate.dictionary)
    modules = modules_across(book)
    paper = np.ones((len(plate.ids), modules + 2 * PADDING, modules + 2 * PADDING))
    inside = slice(PADDING, PADDING + modules)
    for index, marker in enumerate(plate.ids):
        picture = np.asarray(book.generateImageMarker(marker, modules, borderBits=1))
        paper[index, inside, inside] = picture > 127
    top_left, top_right, bottom_left = (plate.corners[:, corner] for corner in (0, 1, 3))
    frame = np.stack(
        [(top_right - top_left) / modules, (bottom_left - top_left) / modules, top_left], axis=2
    )
    return MarkerPrint(paper, frame, np.minimum(_clearances(plate.corners), plate.quiet_m))


def _clearances(corners: Array) -> Array:
    """Least distance of each marker from the others, by the spheres and boxes they fill."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    apart = np.maximum(low[:, None] - high[None], low[None] - high[:, None])
    distance = np.linalg.norm(np.maximum(apart, 0.0), axis=2)
    np.fill_diagonal(distance, np.inf)
    nearest: Array = distance.min(axis=1)
    return nearest
