"""What a camera is calibrated with: a chessboard or ChArUco board, and its corners in pictures."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from vision.dictionary import open_dictionary

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

LEAST_CORNERS = 8
"""A picture with fewer corners of the board says too little."""


@dataclass(frozen=True)
class BoardView:
    """A board in one picture.

    Attributes
    ----------
    name
        The picture's.
    points
        Corners on the board, m, shape (n, 3).
    pixels
        The same in the picture, px, shape (n, 2).
    """

    name: str
    points: Array
    pixels: Array


@dataclass(frozen=True)
class CalibrationBoard:
    """A chessboard, or a ChArUco board where it has markers.

    Attributes
    ----------
    columns, rows
        Of a chessboard: inner corners. Of a ChArUco board: squares.
    square_m
        Side of a square, m.
    marker_m
        Side of a ChArUco board's markers, m; None for a chessboard.
    dictionary
        Of a ChArUco board.
    """

    columns: int
    rows: int
    square_m: float
    marker_m: float | None = None
    dictionary: str = "DICT_4X4_50"

    def find(self, image: Image, name: str) -> BoardView | None:
        """The board in a picture; None where it is not there, or hardly.

        Parameters
        ----------
        image
            Grey levels, shape (height, width).
        name
            The picture's.
        """
        return self._charuco(image, name) if self.marker_m else self._chessboard(image, name)

    def _chessboard(self, image: Image, name: str) -> BoardView | None:
        import cv2

        size = (self.columns, self.rows)
        found, corners = cv2.findChessboardCornersSB(image, size, flags=cv2.CALIB_CB_ACCURACY)
        if not found:
            return None
        points = np.zeros((self.columns * self.rows, 3))
        points[:, :2] = np.mgrid[: self.columns, : self.rows].T.reshape(-1, 2)
        pixels = np.asarray(corners, dtype=float).reshape(-1, 2)
        return BoardView(name, points * self.square_m, pixels)

    def _charuco(self, image: Image, name: str) -> BoardView | None:
        import cv2

        assert self.marker_m is not None
        book = open_dictionary(self.dictionary, "--dictionary")
        board: Any = cv2.aruco.CharucoBoard(
            (self.columns, self.rows), self.square_m, self.marker_m, book
        )
        corners, ids, _, _ = cv2.aruco.CharucoDetector(board).detectBoard(image)
        if ids is None or len(ids) < LEAST_CORNERS:
            return None
        chosen = np.asarray(ids).ravel()
        points = np.asarray(board.getChessboardCorners(), dtype=float)[chosen]
        pixels = np.asarray(corners, dtype=float).reshape(-1, 2)
        return BoardView(name, points, pixels)


def board_of(
    chessboard: str | None,
    charuco: str | None,
    square_mm: float,
    marker_mm: float | None,
    dictionary: str,
) -> CalibrationBoard:
    """The board that a command line names, such as ``--chessboard 9x6``.

    Raises
    ------
    UsageError
        Not one of the two kinds, or numbers that make no board.
    """
    named = chessboard or charuco
    if named is None or (chessboard and charuco):
        raise UsageError(
            "which board?",
            allowed="--chessboard COLUMNSxROWS (inner corners) or --charuco COLUMNSxROWS (squares)",
        )
    parts = named.lower().split("x")
    numbers = [int(part) for part in parts if part.isdigit()]
    if len(parts) != 2 or len(numbers) != 2 or min(numbers) < 3:
        raise UsageError(f"a board of {named}", allowed="COLUMNSxROWS, each at least 3, as 9x6")
    if charuco and (marker_mm is None or not 0.0 < marker_mm < square_mm):
        raise UsageError(
            f"markers of {marker_mm} mm in squares of {square_mm:g} mm",
            allowed="--marker-mm smaller than --square-mm",
        )
    marker_m = None if chessboard or marker_mm is None else marker_mm / 1e3
    return CalibrationBoard(numbers[0], numbers[1], square_mm / 1e3, marker_m, dictionary)
