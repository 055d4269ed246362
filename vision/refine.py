"""From a pose by corners to a pose by pixels, where that is better, for both poses of a plane."""

from dataclasses import replace
from enum import StrEnum

import numpy as np

from vision.camera_model import CameraModel
from vision.corners import Corners
from vision.detect import Image
from vision.marker_print import MarkerPrint
from vision.photometric import USUAL_BLUR_PX, Alignment, align_print
from vision.pose import (
    DECISIVE,
    MISFIT,
    SAME_ROTATION_RAD,
    CameraPose,
    PoseEstimate,
    angle_of,
    reprojection_of,
)

RIVAL_LEAD = 64.0
"""Where corners lead by more than this chi-squared (8 sigma), the rival is not tried on pixels."""

WORST_REPROJECTION_PX = 0.3
"""Corners that miss by more than this are not those of the print as stated: pixels would not do
better (bent paper, another layout)."""

WORSE_BY_PX = 0.1
"""A pose by pixels that moves corners this much further off has slipped by a module."""


class Refinement(StrEnum):
    """What poses are fitted to."""

    CORNERS = "corners"
    PHOTOMETRIC = "photometric"


def refine_on_pixels(
    image: Image,
    printed: MarkerPrint,
    corners: Corners,
    points: np.ndarray,
    estimate: PoseEstimate,
    camera: CameraModel,
) -> PoseEstimate:
    """Align the print with the pixels, from the pose that the corners gave.

    Parameters
    ----------
    image
        Grey levels, shape (height, width).
    printed
        The markers seen.
    corners
        Their corners in the picture.
    points
        Their corners in the plate frame, m, shape (n, 4, 3).
    estimate
        The pose from the corners.
    camera
        The camera.

    Returns
    -------
    PoseEstimate
        The estimate given, where pixels cannot do better.
    """
    if estimate.better.reprojection_px > WORST_REPROJECTION_PX:
        return estimate
    blur = USUAL_BLUR_PX if np.isnan(estimate.blur_px) else estimate.blur_px
    found = []
    for start in _starts(estimate):
        aligned = align_print(image, printed, start.rotation, start.translation, camera, blur)
        if aligned is not None:
            pose = _pose(aligned, points, corners, camera)
            if pose.reprojection_px < estimate.better.reprojection_px + WORSE_BY_PX:
                found.append((aligned, pose))
    if not found:
        return estimate
    found.sort(key=lambda one: one[0].squares / one[0].pixels)
    best, pose = found[0]
    refined = replace(
        estimate,
        pose=pose,
        blur_px=best.blur_px,
        misfit=1.0 if np.isnan(best.misfit) else best.misfit,
        ambiguous=False,
        from_previous=False,
        rival=None,
        lead=float("inf"),
    )
    if len(found) < 2 or angle_of(pose.rotation, found[1][1].rotation) < SAME_ROTATION_RAD:
        return refined
    other, rival = found[1]
    mean = best.squares / best.pixels
    lead = (other.squares / other.pixels - mean) * best.pixels / best.noise**2
    return replace(refined, rival=rival, lead=lead, ambiguous=lead < DECISIVE)


def _starts(estimate: PoseEstimate) -> list[CameraPose]:
    worse = estimate.worse
    if worse is None or estimate.lead > RIVAL_LEAD:
        return [estimate.better]
    return [estimate.better, worse]


def _pose(
    aligned: Alignment, points: np.ndarray, corners: Corners, camera: CameraModel
) -> CameraPose:
    """A pose; where markers are elsewhere than stated, its covariance grows by as much."""
    covariance = aligned.covariance * (aligned.misfit if aligned.misfit > MISFIT else 1.0)
    miss = reprojection_of(aligned.rotation, aligned.translation, points, corners, camera)
    return CameraPose(aligned.rotation, aligned.translation, covariance, miss)
