"""The simulated camera's lens: rays to pixels, and the ray of every pixel.

Pixel centres are at integer coordinates of the full sensor; a ray is (x, y) at z = 1.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Intrinsics

Array = NDArray[np.float64]

UNDISTORTION_STEPS = 50
"""Fixed-point steps that invert the lens distortion; a lens that needs more is refused."""

UNDISTORTION_TOLERANCE_PX = 1e-5


def to_pixels(intrinsics: Intrinsics, rays: Array) -> Array:
    """Pixels of the full sensor that rays (x, y) with z = 1 fall on, distortion included."""
    import cv2

    matrix = _matrix(intrinsics)
    if not any(intrinsics.distortion):
        undistorted: Array = rays * np.diag(matrix)[:2] + matrix[:2, 2]
        return undistorted
    points = np.column_stack([rays, np.ones(len(rays))])
    still = np.zeros(3)
    pixels: Any = cv2.projectPoints(points, still, still, matrix, np.array(intrinsics.distortion))
    projected: Array = pixels[0].reshape(-1, 2)
    return projected


def pixel_rays(
    intrinsics: Intrinsics, corner: tuple[int, int], width: int, height: int
) -> tuple[Array, ...]:
    """Ray (x, y) of each pixel and its derivatives by column and row: six (height, width).

    Raises
    ------
    DataError
        The distortion cannot be inverted over the picture.
    """
    columns, rows = np.meshgrid(np.arange(width) + corner[0], np.arange(height) + corner[1])
    pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(float)
    rays = (pixels - (intrinsics.cx_px, intrinsics.cy_px)) / (intrinsics.fx_px, intrinsics.fy_px)
    if any(intrinsics.distortion):
        rays = _without_distortion(intrinsics, pixels)
    x, y = rays[:, 0].reshape(height, width), rays[:, 1].reshape(height, width)
    x_by_row, x_by_column = np.gradient(x)
    y_by_row, y_by_column = np.gradient(y)
    return x, y, x_by_column, x_by_row, y_by_column, y_by_row


def _without_distortion(intrinsics: Intrinsics, pixels: Array) -> Array:
    """The rays that fall on pixels: OpenCV's estimate, then fixed-point steps until they do."""
    import cv2

    matrix, focal = _matrix(intrinsics), np.array([intrinsics.fx_px, intrinsics.fy_px])
    start: Any = cv2.undistortPoints(pixels[:, None], matrix, np.array(intrinsics.distortion))
    rays: Array = start[:, 0]
    for _ in range(UNDISTORTION_STEPS):
        miss = pixels - to_pixels(intrinsics, rays)
        if np.abs(miss).max() < UNDISTORTION_TOLERANCE_PX:
            return rays
        rays = rays + miss / focal
    raise DataError(
        f"the lens distortion {intrinsics.distortion} cannot be inverted over the picture",
        where="camera.intrinsics.distortion",
    )


def _matrix(intrinsics: Intrinsics) -> Array:
    return np.array(
        [
            [intrinsics.fx_px, 0.0, intrinsics.cx_px],
            [0.0, intrinsics.fy_px, intrinsics.cy_px],
            [0.0, 0.0, 1.0],
        ]
    )
