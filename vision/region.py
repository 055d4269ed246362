"""Where to look next: the part of the picture that a plate can have moved to since it was seen."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.detect import Image, MarkerDetector, Markers
from vision.plate import Plate
from vision.pose import CameraPose

Array = NDArray[np.float64]

MARGIN_MARKERS = 0.5
MARGIN_PX = 16.0
"""Room round the plate: so many sides of its largest marker and so many pixels, and the way it
moved between the two frames before."""


@dataclass(frozen=True)
class Region:
    """A rectangle of the picture, px; right and bottom are not in it."""

    left: int
    top: int
    right: int
    bottom: int

    def cut(self, image: Image) -> Image:
        """That part of a picture, without a copy."""
        return image[self.top : self.bottom, self.left : self.right]

    def smaller_than_half(self, camera: CameraModel) -> bool:
        """Whether looking only there is worth it."""
        area = (self.right - self.left) * (self.bottom - self.top)
        return 2 * area < camera.width_px * camera.height_px


def region_about(
    plate: Plate, pose: CameraPose, before: CameraPose | None, camera: CameraModel
) -> Region | None:
    """Where a plate will be in the next frame; None where that is no part of the picture.

    Parameters
    ----------
    plate
        The plate.
    pose, before
        Its last pose, and the one a frame earlier if known.
    camera
        The camera.
    """
    now = _outline(plate, pose, camera)
    if now is None:
        return None
    sides = np.linalg.norm(np.roll(now, -1, axis=1) - now, axis=2)
    margin = MARGIN_PX + MARGIN_MARKERS * float(sides.max())
    earlier = _outline(plate, before, camera) if before else None
    if earlier is not None:
        margin += float(np.abs(now - earlier).max())
    flat = now.reshape(-1, 2)
    size = (camera.width_px, camera.height_px)
    left, top = np.clip(np.floor(flat.min(axis=0) - margin), 0, size).astype(int)
    right, bottom = np.clip(np.ceil(flat.max(axis=0) + margin), 0, size).astype(int)
    if right - left < 2 * MARGIN_PX or bottom - top < 2 * MARGIN_PX:
        return None
    return Region(int(left), int(top), int(right), int(bottom))


def detect_in(image: Image, region: Region, detector: MarkerDetector) -> Markers:
    """Markers in a part of a picture, in px of the whole."""
    return detector.detect(region.cut(image)).moved((region.left, region.top))


def _outline(plate: Plate, pose: CameraPose, camera: CameraModel) -> Array | None:
    """Corners of the markers in the picture, shape (n, 4, 2)."""
    seen = plate.corners.reshape(-1, 3) @ pose.rotation.T + pose.translation
    if seen[:, 2].min() <= 0.0:
        return None
    return camera.distort(camera.project(seen)).reshape(-1, 4, 2)
