"""The marker plate as `vision` sees it: which markers, and where their corners are.

Plate frame: x to the right, y up, z out of the print, origin at the plate's own; m.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile import schema
from vision.dictionary import marker_count, open_dictionary

Array = NDArray[np.float64]

SQUARE = np.array([[-0.5, 0.5, 0.0], [0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, -0.5, 0.0]])
"""Corners of a marker of side 1 about its centre, in OpenCV's order: TL, TR, BR, BL."""


@dataclass(frozen=True)
class Plate:
    """Markers whose places relative to each other are known.

    Attributes
    ----------
    dictionary
        OpenCV's name of the dictionary, such as ``"DICT_4X4_50"``.
    ids
        Marker ids, n of them, each once.
    corners
        Corners in the plate frame in OpenCV's order (TL, TR, BR, BL), m, shape (n, 4, 3).
    quiet_m
        White round each marker, where something else than a marker ends it (the black squares of
        a ChArUco board); infinite where nothing does.
    saddles
        Inner corners of a ChArUco board's squares, m, shape (k, 3); None for other plates.

    Raises
    ------
    DataError
        The dictionary is unknown, or an id is none of its markers.
    """

    dictionary: str
    ids: tuple[int, ...]
    corners: Array
    quiet_m: float = float("inf")
    saddles: Array | None = None

    def __post_init__(self) -> None:
        check_ids(self.dictionary, self.ids, "plate")

    @classmethod
    def from_rig(cls, plate: schema.Plate) -> "Plate":
        """The plate of a rig file, in its own frame."""
        markers = plate.markers()
        return cls(
            plate.dictionary,
            tuple(marker.id for marker in markers),
            np.array(
                [SQUARE * marker.size_m + (*marker.centre_m, 0.0) for marker in markers],
                dtype=float,
            ),
        )

    @classmethod
    def charuco(
        cls, dictionary: str, columns: int, rows: int, square_m: float, marker_m: float
    ) -> "Plate":
        """The markers of a ChArUco board of so many squares, about its middle."""
        import cv2

        book = open_dictionary(dictionary, "charuco.dictionary")
        board = cv2.aruco.CharucoBoard((columns, rows), square_m, marker_m, book)
        corners = np.asarray(board.getObjPoints(), dtype=float).reshape(-1, 4, 3)
        middle = np.array([columns, rows, 0.0]) * square_m / 2.0
        upright: Array = (corners - middle) * [1.0, -1.0, 1.0]
        ids = tuple(int(marker) for marker in np.asarray(board.getIds()).ravel())
        inner = np.asarray(board.getChessboardCorners(), dtype=float)
        saddles: Array = (inner - middle) * [1.0, -1.0, 1.0]
        return cls(dictionary, ids, upright, (square_m - marker_m) / 2.0, saddles)

    @classmethod
    def single(cls, dictionary: str, marker: int, size_m: float) -> "Plate":
        """A plate of one marker, with its origin at the marker's centre."""
        return cls(dictionary, (marker,), SQUARE[np.newaxis] * size_m)

    def corners_of(self, ids: Sequence[int]) -> Array:
        """Corners of some of its markers, m, shape (len(ids), 4, 3)."""
        return self.corners[[self.ids.index(marker) for marker in ids]]


@dataclass(frozen=True)
class Singles:
    """Independent markers: sizes are known, places relative to each other are not.

    Attributes
    ----------
    dictionary
        OpenCV's name of the dictionary.
    size_m
        Side of a marker that `sizes_m` does not name.
    ids
        Markers to track; None tracks every marker of the dictionary.
    sizes_m
        Markers of another size.
    """

    dictionary: str
    size_m: float
    ids: tuple[int, ...] | None = None
    sizes_m: tuple[tuple[int, float], ...] = ()

    def __post_init__(self) -> None:
        named = tuple(marker for marker, _ in self.sizes_m)
        check_ids(self.dictionary, (self.ids or ()) + named, "singles")

    def wants(self, marker: int) -> bool:
        """Whether a marker is to be tracked."""
        return self.ids is None or marker in self.ids

    def plate_of(self, marker: int) -> Plate:
        """One of its markers, as a plate of its own."""
        return Plate.single(self.dictionary, marker, dict(self.sizes_m).get(marker, self.size_m))


def check_ids(dictionary: str, ids: Sequence[int], where: str) -> None:
    """Refuse a dictionary that is unknown or ids that are not in it."""
    count = marker_count(open_dictionary(dictionary, f"{where}.dictionary"))
    beyond = [marker for marker in ids if not 0 <= marker < count]
    if beyond:
        raise DataError(
            f"{dictionary} has no marker {', '.join(map(str, beyond))}",
            where=where,
            allowed=f"ids 0 to {count - 1}",
            remedy="correct the ids or the dictionary",
        )
