"""The corners of a ChArUco board's squares: saddle points, found where its markers put them.

A saddle point is a corner from four sides at once, so blur does not move it, and `cornerSubPix`
finds it to a few hundredths of a pixel. Markers say which is which; the pose comes from the
saddles.
"""

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.corners import Corners
from vision.detect import Image
from vision.plate import Plate
from vision.pose import CameraPose

Array = NDArray[np.float64]

SADDLE_PRECISION_PX = 0.05
WINDOW_OF_QUIET = 0.55
"""Half the search window, as a fraction of the white between a marker and its square's rim."""

WINDOW_PX = (2, 7)
MOST_SHIFT_PX = 4.0
LEAST_SADDLES = 4
NEIGHBOURS = 2
"""Markers beside a saddle that must be seen: with one alone it may be hidden."""


def saddles_seen(
    image: Image, plate: Plate, ids: tuple[int, ...], pose: CameraPose, camera: CameraModel
) -> tuple[Array, Corners] | None:
    """Saddle points in the plate frame, in fours, (n, 4, 3), and where they are seen.

    Parameters
    ----------
    image
        Grey levels, shape (height, width).
    plate
        A ChArUco board.
    ids
        Its markers that were seen.
    pose
        From these.
    camera
        The camera.

    Returns
    -------
    tuple or None
        None where the plate is no ChArUco board, or fewer than four saddles are seen. Where their
        number is no multiple of four some stand twice, with double the variance.
    """
    import cv2

    if plate.saddles is None:
        return None
    points = _beside(plate, ids)
    seen = points @ pose.rotation.T + pose.translation
    if len(points) < LEAST_SADDLES or seen[:, 2].min() <= 0.0:
        return None
    expected = camera.distort(camera.project(seen))
    window = plate.quiet_m * float(camera.focal_px.mean()) / float(np.median(seen[:, 2]))
    half = int(np.clip(round(WINDOW_OF_QUIET * window), *WINDOW_PX))
    size = np.array([camera.width_px, camera.height_px])
    inside = ((expected > half + 1) & (expected < size - half - 2)).all(axis=1)
    points, expected = points[inside], expected[inside]
    if len(points) < LEAST_SADDLES:
        return None
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 1e-3)
    start = np.ascontiguousarray(expected.reshape(-1, 1, 2), dtype=np.float32)
    found = cv2.cornerSubPix(image, start, (half, half), (-1, -1), stop)
    pixels = np.asarray(found, dtype=float).reshape(-1, 2)
    good = np.linalg.norm(pixels - expected, axis=1) < MOST_SHIFT_PX
    if good.sum() < LEAST_SADDLES:
        return None
    return _in_fours(points[good], camera.undistort(pixels[good]))


def _beside(plate: Plate, ids: tuple[int, ...]) -> Array:
    """Saddles with two of the markers seen beside them."""
    assert plate.saddles is not None
    corners = plate.corners_of(ids)
    apart = np.linalg.norm(plate.saddles[:, None, None] - corners[None], axis=3).min(axis=2)
    near = (apart < 1.5 * np.sqrt(2.0) * plate.quiet_m).sum(axis=1)
    chosen: Array = plate.saddles[near >= NEIGHBOURS]
    return chosen


def _in_fours(points: Array, pixels: Array) -> tuple[Array, Corners]:
    count = len(points)
    groups = -(-count // 4)
    index = np.arange(4 * groups) % count
    twice = np.bincount(index, minlength=count)[index]
    variance = np.repeat(SADDLE_PRECISION_PX**2 * twice, 2).reshape(groups, 8)
    covariance = variance[:, :, None] * np.eye(8)
    corners = Corners(
        tuple(range(groups)),
        pixels[index].reshape(groups, 4, 2),
        covariance,
        np.ones(groups, dtype=bool),
    )
    return points[index].reshape(groups, 4, 3), corners
