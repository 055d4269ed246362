"""The camera: between rays, ideal pixels and the pixels of its picture.

Ideal pixels are those of a lens without distortion and with the same camera matrix: in them,
straight lines of a plate are straight. Pixel centres are at integer coordinates.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Intrinsics, RegionOfInterest

Array = NDArray[np.float64]

UNDISTORTION_STEPS = 40
UNDISTORTION_TOLERANCE_PX = 1e-4


@dataclass(frozen=True)
class CameraModel:
    """A pinhole camera with OpenCV's lens distortion, for one size of picture.

    Attributes
    ----------
    matrix
        Camera matrix, px, shape (3, 3).
    distortion
        OpenCV's coefficients, dimensionless, shape (k,).
    width_px, height_px
        Size of the picture.
    """

    matrix: Array
    distortion: Array
    width_px: int
    height_px: int

    @classmethod
    def from_intrinsics(
        cls, intrinsics: Intrinsics, region: RegionOfInterest | None = None
    ) -> "CameraModel":
        """The camera of a rig file; a region of interest shifts the principal point.

        Raises
        ------
        DataError
            The region does not lie on the sensor.
        """
        left, top = (region.x_px, region.y_px) if region else (0, 0)
        width = region.width_px if region else intrinsics.width_px
        height = region.height_px if region else intrinsics.height_px
        if left + width > intrinsics.width_px or top + height > intrinsics.height_px:
            raise DataError(
                f"the region {width} x {height} at ({left}, {top}) leaves the sensor",
                where="camera.region_of_interest",
                allowed=f"within {intrinsics.width_px} x {intrinsics.height_px} px",
            )
        return cls(
            np.array(
                [
                    [intrinsics.fx_px, 0.0, intrinsics.cx_px - left],
                    [0.0, intrinsics.fy_px, intrinsics.cy_px - top],
                    [0.0, 0.0, 1.0],
                ]
            ),
            np.array(intrinsics.distortion, dtype=float),
            width,
            height,
        )

    @property
    def focal_px(self) -> Array:
        """Focal lengths along x and y, px, shape (2,)."""
        return self.matrix[[0, 1], [0, 1]]

    @property
    def principal_point_px(self) -> Array:
        """Shape (2,)."""
        return self.matrix[:2, 2]

    def check_size(self, image: NDArray[np.uint8], where: str) -> None:
        """Refuse a picture, shape (height, width), of another size than the camera's.

        Raises
        ------
        DataError
            The sizes differ.
        """
        height, width = image.shape
        if (height, width) != (self.height_px, self.width_px):
            raise DataError(
                f"frames are {width} x {height} px, the intrinsics are for "
                f"{self.width_px} x {self.height_px} px",
                where=where,
                allowed="intrinsics (and region of interest) of the camera that took the video",
                remedy="use the intrinsics of this camera at this size; scaled or cropped video "
                "needs intrinsics of its own",
            )

    def project(self, points: Array) -> Array:
        """Ideal pixels of points in the camera frame.

        Parameters
        ----------
        points
            m, shape (n, 3).

        Returns
        -------
        Array
            Shape (n, 2).
        """
        rays = points[:, :2] / points[:, 2:]
        projected: Array = rays * self.focal_px + self.principal_point_px
        return projected

    def distort(self, ideal: Array) -> Array:
        """Pixels of the picture for ideal pixels, shape (n, 2)."""
        import cv2

        if not self.distortion.any():
            return ideal
        rays = (ideal - self.principal_point_px) / self.focal_px
        points = np.column_stack([rays, np.ones(len(rays))])
        still = np.zeros(3)
        pixels, _ = cv2.projectPoints(points, still, still, self.matrix, self.distortion)
        distorted: Array = pixels.reshape(-1, 2)
        return distorted

    def undistort(self, pixels: Array) -> Array:
        """Ideal pixels for pixels of the picture, shape (n, 2).

        Raises
        ------
        DataError
            The distortion cannot be inverted there: it folds the picture.
        """
        import cv2

        pixels = np.ascontiguousarray(pixels, dtype=float)
        if not self.distortion.any() or len(pixels) == 0:
            return pixels
        start = cv2.undistortPoints(
            pixels[:, np.newaxis], self.matrix, self.distortion, P=self.matrix
        )
        ideal: Array = start[:, 0]  # good to 1e-3 px or so; the steps below make sure
        for _ in range(UNDISTORTION_STEPS):
            miss = pixels - self.distort(ideal)
            if np.abs(miss).max() < UNDISTORTION_TOLERANCE_PX:
                return ideal
            ideal = ideal + miss
        raise DataError(
            "the lens distortion cannot be inverted where the markers are",
            where="intrinsics",
            allowed="distortion that maps the picture one to one",
            remedy="calibrate again with pictures that reach the edges of the frame",
        )
