"""Pose of a plate in the camera frame from its corners, with its covariance and its rival.

A plane seen by a camera has two poses that explain its corners almost equally well, mirrored about
the line of sight (Collins and Bartoli, "Infinitesimal plane-based pose estimation", 2014). Both are
computed, both refined by Levenberg-Marquardt with the covariance of the corners as weight, and what
the corners say of one against the other is kept.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.corners import Corners

Array = NDArray[np.float64]

ITERATIONS = 20
PRIOR_FREEDOMS = 8.0
"""Weight, in residuals, of the corners' stated covariance against the scatter of this frame's."""

MISFIT = 4.0
"""Chi-squared per degree of freedom past which corners miss by more than their noise."""

DECISIVE = 16.0
"""Chi-squared by which the better pose must lead: 4 sigma, odds of 3000 to 1."""

SAME_ROTATION_RAD = 1e-4
"""Two refined poses closer than this are one: there is no rival."""


@dataclass(frozen=True)
class CameraPose:
    """Pose of a plate in the camera frame.

    Attributes
    ----------
    rotation
        From plate to camera, shape (3, 3).
    translation
        The plate's origin in the camera frame, m, shape (3,).
    covariance
        Of a small rotation about the camera's axes, rad, and of the translation, m: shape (6, 6).
    reprojection_px
        Root mean square distance between corners and their projections, px.
    """

    rotation: Array
    translation: Array
    covariance: Array
    reprojection_px: float


@dataclass(frozen=True)
class PoseEstimate:
    """The pose chosen, and what is known of the other.

    Attributes
    ----------
    pose
        The pose.
    ratio
        Reprojection error of the second-best pose over that of the best, each corner weighed by
        its precision: at least 1; NaN where there is no second.
    ambiguous
        The corners do not decide between the two.
    from_previous
        Frames before (or, of a whole video, those before and after) did, against the smaller error.
    rival
        The pose not chosen; None where there is none.
    lead
        Chi-squared by which the better of the two leads; infinite where there is one.
    misfit
        Chi-squared of the corners per degree of freedom: over 4, plate or lens are not as stated.
    blur_px
        Standard deviation of the point spread where the pixels were fitted, else NaN.
    """

    pose: CameraPose
    ratio: float
    ambiguous: bool
    from_previous: bool
    rival: CameraPose | None = None
    lead: float = float("inf")
    misfit: float = 1.0
    blur_px: float = float("nan")

    @property
    def better(self) -> CameraPose:
        """Of the two poses, that of the smaller error."""
        return self.rival if self.from_previous and self.rival else self.pose

    @property
    def worse(self) -> CameraPose | None:
        """Of the two poses, that of the larger error."""
        return self.pose if self.from_previous else self.rival


@dataclass(frozen=True)
class _Fit:
    rotation: Array
    translation: Array
    normal: Array  # (6, 6), inverse of the covariance if the corners' is right
    chi_squared: float
    reprojection_px: float


def estimate_pose(
    points: Array, corners: Corners, camera: CameraModel, previous: CameraPose | None = None
) -> PoseEstimate | None:
    """Pose of a plate from the corners of its markers.

    Parameters
    ----------
    points
        The corners in the plate frame, m, shape (n, 4, 3).
    corners
        Where they are seen.
    camera
        The camera.
    previous
        The pose in the frame before: decides where the corners do not.

    Returns
    -------
    PoseEstimate or None
        None where the corners are those of no plate in front of the camera.
    """
    fits = _fits(points, corners, camera)
    if not fits:
        return None
    freedoms = corners.pixels.size - 6
    misfit = fits[0].chi_squared / freedoms
    if fits[0].chi_squared > MISFIT * freedoms:
        # Bent paper, a misprint, a lens not as stated: such misses are not shared between corners
        # as noise is, so each corner is given its own, of the size that is seen.
        miss = fits[0].reprojection_px ** 2 / 2.0 * corners.pixels.size / freedoms
        corners = replace(corners, covariance=corners.covariance + miss * np.eye(8))
        fits = _fits(points, corners, camera) or fits
    best, rivals = fits[0], fits[1:]
    rivals = [fit for fit in rivals if angle_of(fit.rotation, best.rotation) > SAME_ROTATION_RAD]
    # The scatter of few corners is a poor measure of their noise, so the stated one counts too.
    scale = (PRIOR_FREEDOMS + best.chi_squared) / (PRIOR_FREEDOMS + freedoms)
    if not rivals:
        return PoseEstimate(_pose(best, scale), float("nan"), False, False, misfit=misfit)
    rival = rivals[0]
    ratio = float(np.sqrt(rival.chi_squared / max(best.chi_squared, 1e-12)))
    lead = float((rival.chi_squared - best.chi_squared) / scale)
    ambiguous = lead < DECISIVE
    chosen, other = best, rival
    if ambiguous and previous is not None:
        by_turn = sorted((best, rival), key=lambda fit: angle_of(fit.rotation, previous.rotation))
        chosen, other = by_turn
    return PoseEstimate(
        _pose(chosen, scale),
        ratio,
        ambiguous,
        chosen is rival,
        _pose(other, scale),
        lead,
        misfit,
    )


def _fits(points: Array, corners: Corners, camera: CameraModel) -> list[_Fit]:
    """The poses that fit, refined, best first."""
    whiten = np.linalg.inv(np.linalg.cholesky(corners.covariance))
    fits = (
        _refine(rotation, translation, points, corners, whiten, camera)
        for rotation, translation in _starts(points, corners, camera)
    )
    return sorted((fit for fit in fits if fit is not None), key=lambda fit: fit.chi_squared)


def _pose(fit: _Fit, scale: float) -> CameraPose:
    covariance = np.asarray(scale * np.linalg.inv(fit.normal), dtype=np.float64)
    return CameraPose(fit.rotation, fit.translation, covariance, fit.reprojection_px)


def _starts(points: Array, corners: Corners, camera: CameraModel) -> list[tuple[Array, Array]]:
    """IPPE's two poses; for markers in several planes, SQPNP's one."""
    import cv2

    flat = points.reshape(-1, 3)
    spread = np.linalg.svd(flat - flat.mean(axis=0), compute_uv=False)
    planar = spread[2] < 1e-6 * spread[0]
    method = cv2.SOLVEPNP_IPPE if planar else cv2.SOLVEPNP_SQPNP
    try:
        _, rotations, translations, _ = cv2.solvePnPGeneric(
            flat, corners.pixels.reshape(-1, 2), camera.matrix, None, flags=method
        )
    except cv2.error:
        return []
    return [
        (np.asarray(cv2.Rodrigues(rotation)[0], dtype=float), np.asarray(translation).ravel())
        for rotation, translation in zip(rotations, translations, strict=True)
    ]


def _refine(
    rotation: Array,
    translation: Array,
    points: Array,
    corners: Corners,
    whiten: Array,
    camera: CameraModel,
) -> _Fit | None:
    """Levenberg-Marquardt on the whitened residuals."""
    from vision.edge_kernel import pose_equations

    flat = np.ascontiguousarray(points.reshape(-1, 3))
    fixed = (
        flat,
        np.ascontiguousarray(corners.pixels.reshape(-1, 2)),
        whiten,
        camera.focal_px,
        camera.principal_point_px,
    )
    rotation, translation = np.ascontiguousarray(rotation), np.ascontiguousarray(translation)
    normal, pull, chi_squared, misses = pose_equations(rotation, translation, *fixed)
    if not np.isfinite(chi_squared):
        return None
    damping = 1e-4
    for _ in range(ITERATIONS):
        damped = normal + damping * np.diag(np.diag(normal))
        step = np.asarray(np.linalg.solve(damped, pull), dtype=np.float64)
        moved = np.ascontiguousarray(_rotation_of(step[:3]) @ rotation), translation + step[3:]
        tried = pose_equations(*moved, *fixed)
        if not tried[2] <= chi_squared:
            damping *= 10.0
            if damping > 1e6:
                break
            continue
        gain = chi_squared - tried[2]
        (rotation, translation), (normal, pull, chi_squared, misses) = moved, tried
        damping = max(damping / 10.0, 1e-9)
        if gain < 1e-9:
            break
    return _Fit(rotation, translation, normal, chi_squared, float(np.sqrt(misses / len(flat))))


def _rotation_of(vector: Array) -> Array:
    import cv2

    rotation: Array = cv2.Rodrigues(np.asarray(vector, dtype=float).reshape(3, 1))[0]
    return rotation


def angle_of(a: Array, b: Array) -> float:
    """Angle of the rotation between two rotations, rad; exact for small ones too."""
    return float(2.0 * np.arcsin(min(1.0, float(np.linalg.norm(a - b)) / np.sqrt(8.0))))


def reprojection_of(
    rotation: Array, translation: Array, points: Array, corners: Corners, camera: CameraModel
) -> float:
    """Root mean square distance between corners and their projections at a pose, px."""
    flat = points.reshape(-1, 3)
    miss = corners.pixels.reshape(-1, 2) - camera.project(flat @ rotation.T + translation)
    return float(np.sqrt((miss**2).sum() / len(flat)))
