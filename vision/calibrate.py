"""Camera calibration with a plain verdict: good enough to measure with, or which pictures to take.

A small reprojection error alone proves little: a few frontal pictures fit almost any focal length.
So the verdict asks four things more: do the corners reach all of the picture, is the board tilted
both ways, how well are focal length and principal point known, and do they stay where they are when
a third of the pictures is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from vision.calibration_board import BoardView

Array = NDArray[np.float64]

LEAST_PICTURES = 8
WORST_REPROJECTION_PX = 0.5
WORST_FOCAL_SIGMA = 0.003
"""Of the focal length; 1 % wrong costs 0.01 to 0.05 deg of constant error in pitch."""

WORST_PRINCIPAL_SIGMA_PX = 4.0
WORST_FOCAL_CHANGE = 0.01
WORST_LEFT_OUT = 1.6
"""Reprojection error of pictures left out, over that of those used."""

LEAST_TILT_DEG = 15.0
FOLDS = 3
MOST_VIEWS = 40
SEPARATE = 0.04
"""Frames of a video count as another picture when corners moved by this much of its width."""

CELLS = 3
_CELL_NAMES = (
    ("top left", "top middle", "top right"),
    ("middle left", "middle", "middle right"),
    ("bottom left", "bottom middle", "bottom right"),
)


@dataclass(frozen=True)
class Calibration:
    """Intrinsics and how far they can be trusted.

    Attributes
    ----------
    matrix, distortion
        As `vision.CameraModel`; five coefficients.
    width_px, height_px
        Size of the pictures.
    pictures
        How many were used.
    reprojection_px
        Root mean square over all corners.
    focal_sigma_px, principal_sigma_px
        Standard deviations, x and y.
    left_out_px
        Reprojection error of pictures that were left out of the fit.
    focal_change
        Greatest relative change of the focal length when a third of the pictures is left out.
    covered
        Share of the nine parts of the picture that corners reached.
    worst
        Name of the picture that fits worst, and its error in px.
    faults
        Why it is not good enough; empty where it is.
    missing
        Which pictures to take.
    """

    matrix: Array
    distortion: Array
    width_px: int
    height_px: int
    pictures: int
    reprojection_px: float
    focal_sigma_px: tuple[float, float]
    principal_sigma_px: tuple[float, float]
    left_out_px: float
    focal_change: float
    covered: float
    worst: tuple[str, float]
    faults: tuple[str, ...]
    missing: tuple[str, ...]

    @property
    def good(self) -> bool:
        """Whether to measure with it."""
        return not self.faults


@dataclass(frozen=True)
class _Fit:
    reprojection_px: float
    matrix: Array
    distortion: Array
    sigmas: Array
    errors: Array
    tilts: Array  # (n, 2): of the board about the picture's vertical and horizontal, deg


def calibrate(views: Sequence[BoardView], size: tuple[int, int]) -> Calibration:
    """Fit the intrinsics and judge them.

    Parameters
    ----------
    views
        The board in several pictures.
    size
        Width and height of all of them, px.

    Raises
    ------
    DataError
        Fewer than three pictures show the board, or no camera explains them.
    """
    if len(views) < FOLDS:
        raise DataError(
            f"the board is in {len(views)} pictures",
            allowed=f"at least {LEAST_PICTURES} pictures of it, each from elsewhere",
            remedy="check the board's size (inner corners of a chessboard, squares of a ChArUco "
            "board), focus, and that it is wholly in the picture",
        )
    fit = _fit(views, size)
    left_out, change = _left_out(views, size, fit)
    cells = _cells(views, size)
    worst = int(fit.errors.argmax())
    sigmas = fit.sigmas
    faults, missing = _judge(fit, len(views), left_out, change, cells)
    return Calibration(
        fit.matrix,
        fit.distortion,
        *size,
        len(views),
        fit.reprojection_px,
        (float(sigmas[0]), float(sigmas[1])),
        (float(sigmas[2]), float(sigmas[3])),
        left_out,
        change,
        float(cells.mean()),
        (views[worst].name, float(fit.errors[worst])),
        tuple(faults),
        tuple(missing),
    )


def _fit(views: Sequence[BoardView], size: tuple[int, int]) -> _Fit:
    import cv2

    points = [view.points.astype(np.float32) for view in views]
    pixels = [view.pixels.astype(np.float32)[:, None] for view in views]
    start: Any = None
    try:
        result: Any = cv2.calibrateCameraExtended(points, pixels, size, start, start)
    except cv2.error:
        raise DataError(
            "no camera explains the pictures",
            allowed="pictures of one flat board, tilted, by one camera at one focus",
        ) from None
    rms, matrix, distortion, rotations, _, sigmas, _, errors = result
    normals = np.array([np.asarray(cv2.Rodrigues(turn)[0])[:, 2] for turn in rotations])
    normals *= np.sign(normals[:, 2:])
    tilts = np.rad2deg(np.arctan2(normals[:, :2], normals[:, 2:]))
    return _Fit(
        float(rms),
        np.asarray(matrix, dtype=float),
        np.asarray(distortion, dtype=float).ravel()[:5],
        np.asarray(sigmas, dtype=float).ravel(),
        np.asarray(errors, dtype=float).ravel(),
        tilts,
    )


def _left_out(views: Sequence[BoardView], size: tuple[int, int], fit: _Fit) -> tuple[float, float]:
    """Reprojection error of pictures left out, px, and the greatest change of the focal length."""
    import cv2

    total, corners, change = 0.0, 0, 0.0
    for fold in range(FOLDS):
        kept = [view for n, view in enumerate(views) if n % FOLDS != fold]
        out = [view for n, view in enumerate(views) if n % FOLDS == fold]
        other = _fit(kept, size)
        focal, before = other.matrix[[0, 1], [0, 1]], fit.matrix[[0, 1], [0, 1]]
        change = max(change, float(np.abs(focal / before - 1.0).max()))
        for view in out:
            _, turn, place = cv2.solvePnP(view.points, view.pixels, other.matrix, other.distortion)
            seen, _ = cv2.projectPoints(view.points, turn, place, other.matrix, other.distortion)
            total += float(((seen.reshape(-1, 2) - view.pixels) ** 2).sum())
            corners += len(view.points)
    return float(np.sqrt(total / corners)), change


def _cells(views: Sequence[BoardView], size: tuple[int, int]) -> NDArray[np.bool_]:
    """Which of the nine parts of the picture corners reached."""
    pixels = np.concatenate([view.pixels for view in views])
    place = np.clip((CELLS * pixels / size).astype(int), 0, CELLS - 1)
    reached = np.zeros((CELLS, CELLS), dtype=bool)
    reached[place[:, 1], place[:, 0]] = True
    return reached


def _judge(
    fit: _Fit, pictures: int, left_out: float, change: float, cells: NDArray[np.bool_]
) -> tuple[list[str], list[str]]:
    faults, missing = [], []
    if pictures < LEAST_PICTURES:
        faults.append(f"only {pictures} pictures show the board (at least {LEAST_PICTURES})")
        missing.append(f"{LEAST_PICTURES - pictures} more, each from another side and distance")
    if fit.reprojection_px > WORST_REPROJECTION_PX:
        faults.append(
            f"corners miss by {fit.reprojection_px:.2f} px (at most {WORST_REPROJECTION_PX:g}): "
            "blur, a bent board, or autofocus"
        )
    empty = [
        _CELL_NAMES[row][column]
        for row in range(CELLS)
        for column in range(CELLS)
        if not cells[row, column]
    ]
    if empty:
        faults.append("no corner was ever in " + ", ".join(empty))
        missing.append("the board in the " + ", in the ".join(empty) + " of the picture")
    for axis, name in ((0, "vertical"), (1, "horizontal")):
        if np.abs(fit.tilts[:, axis]).max() < LEAST_TILT_DEG:
            faults.append(f"the board was never tilted about its {name}")
            missing.append(f"the board turned 20 to 45 deg about its {name}, both ways")
    focal = float((fit.sigmas[:2] / fit.matrix[[0, 1], [0, 1]]).max())
    if focal > WORST_FOCAL_SIGMA:
        faults.append(f"the focal length is known to {focal:.2%} (at most {WORST_FOCAL_SIGMA:.1%})")
        missing.append("the board tilted by 30 to 45 deg, close enough to fill half the picture")
    if float(fit.sigmas[2:4].max()) > WORST_PRINCIPAL_SIGMA_PX:
        faults.append(f"the principal point is known to {fit.sigmas[2:4].max():.1f} px")
        missing.append("the board upside down and on its side, tilted")
    if change > WORST_FOCAL_CHANGE:
        faults.append(f"leaving a third of the pictures out moves the focal length by {change:.1%}")
    if left_out > WORST_LEFT_OUT * fit.reprojection_px + 0.05:
        faults.append(
            f"pictures left out miss by {left_out:.2f} px, those used by {fit.reprojection_px:.2f}"
        )
        missing.append("more pictures, spread over angles and distances")
    return faults, missing


def different_views(views: Sequence[BoardView], width_px: int) -> list[BoardView]:
    """Of the frames of a video, those that are another picture, at most forty."""
    kept: list[BoardView] = []
    for view in views:
        if not kept or _moved(view, kept[-1]) > SEPARATE * width_px:
            kept.append(view)
    chosen = np.linspace(0, len(kept) - 1, min(MOST_VIEWS, len(kept))).astype(int)
    return [kept[index] for index in chosen]


def _moved(view: BoardView, other: BoardView) -> float:
    if view.pixels.shape != other.pixels.shape:
        return float("inf")
    return float(np.linalg.norm(view.pixels - other.pixels, axis=1).mean())


def write_intrinsics(found: Calibration, path: Path) -> None:
    """Write OpenCV's YAML or XML, as `vision track --intrinsics` reads it.

    Raises
    ------
    DataError
        The file cannot be written.
    """
    import cv2

    storage: Any = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    if not storage.isOpened():
        raise DataError("cannot be written", where=str(path), allowed="a name ending in .yml")
    storage.write("image_width", found.width_px)
    storage.write("image_height", found.height_px)
    storage.write("camera_matrix", found.matrix)
    storage.write("distortion_coefficients", found.distortion.reshape(1, -1))
    storage.write("avg_reprojection_error", found.reprojection_px)
    storage.release()
