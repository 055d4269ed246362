"""How well a plate can be seen, before it is printed: the Cramer-Rao bound of its pose.

The bound is that of the photometric model (pose, blur, light) at a given noise; on rendered
pictures the tracker reaches it. It knows nothing of misprint and calibration errors.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.marker_print import print_of
from vision.mounting import Mounting
from vision.photometric import pose_covariance, windows_of
from vision.plate import Plate
from vision.pose import CameraPose

Array = NDArray[np.float64]

NOISE_LEVELS = 2.0
BLUR_PX = 0.7
CONTRAST_LEVELS = 150.0
"""What is assumed of a picture: usual of an industrial camera in a lit room."""

FACE_ON_DEG = 15.0
"""A plate seen within this of its normal tilts unseen."""

SMALL_MODULE_PX = 4.0
GOOD_PITCH_DEG = 0.02

VIEWS = (
    ("along the pitch axis", (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)),
    ("30 deg off the pitch axis", (0.0, 1.0, 0.0), (0.5, 0.866, 0.0)),
    ("tilted 45 deg about the pitch axis", (0.707, 0.0, 0.707), (1.0, 0.0, 0.0)),
    ("face-on, across the pitch axis", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
)
"""Name, plate normal, and direction from the plate to the camera, in O-XYZ."""


@dataclass(frozen=True)
class ViewBound:
    """What a view can give.

    Attributes
    ----------
    view
        In words.
    sigma_deg
        Of roll, pitch and yaw of one frame.
    module_px
        Side of the smallest module in the picture, the narrow way.
    off_normal_deg
        Between the plate's normal and the line of sight.
    warnings
        What is wrong with it.
    """

    view: str
    sigma_deg: tuple[float, float, float]
    module_px: float
    off_normal_deg: float
    warnings: tuple[str, ...]


def bound_of_pose(plate: Plate, pose: CameraPose, camera: CameraModel) -> Array | None:
    """Least covariance of a pose, (6, 6); None where the plate is not wholly and well in view."""
    from vision.normal_equations_kernel import SHARED, accumulate
    from vision.projection_kernel import placed

    printed = print_of(plate)
    windows = windows_of(printed, pose.rotation, pose.translation, camera)
    if windows is None:
        return None
    light = np.array([BLUR_PX, 50.0, 0.0, 0.0, CONTRAST_LEVELS, 0.0, 0.0, 0.0])
    normals, _, _, _ = accumulate(
        np.zeros((camera.height_px, camera.width_px), np.uint8),
        windows.lens,
        windows.middle,
        windows.window,
        printed.paper,
        windows.reach,
        placed(printed.frame, pose.rotation, pose.translation),
        pose.translation,
        camera.focal_px,
        camera.principal_point_px,
        windows.size_m,
        light,
        windows.origin,
        windows.scale,
        1e9,
        SHARED,
    )
    return pose_covariance(normals.sum(axis=0), NOISE_LEVELS**2)


def bound_of_view(name: str, plate: Plate, mounting: Mounting, camera: CameraModel) -> ViewBound:
    """What a mounted plate and camera can give, the platform at X = 0.

    Parameters
    ----------
    name
        The view, in words.
    plate, mounting, camera
        The set-up.
    """
    rotation = mounting.camera_rotation.T @ mounting.plate_rotation
    place = mounting.camera_rotation.T @ (mounting.plate_position - mounting.camera_position)
    pose = CameraPose(np.ascontiguousarray(rotation), place, np.zeros((6, 6)), 0.0)
    covariance = bound_of_pose(plate, pose, camera)
    sight = -place / np.linalg.norm(place)
    off = float(np.rad2deg(np.arccos(np.clip(rotation[:, 2] @ sight, -1.0, 1.0))))
    module_px = _module_px(plate, pose, camera)
    if covariance is None:
        why = f"a module is {module_px:.1f} px, or the plate leaves the picture: not to be tracked"
        return ViewBound(name, (np.nan, np.nan, np.nan), module_px, off, (why,))
    seen = CameraPose(pose.rotation, place, covariance, 0.0)
    sigma = np.rad2deg(np.sqrt(np.diag(mounting.platform(seen).covariance)[3:]))
    warnings = []
    normal = mounting.plate_rotation[:, 2]
    if off < FACE_ON_DEG and abs(normal[1]) < 0.5:
        warnings.append(
            "face-on across the pitch axis: pitch is some 40 times worse than it could be, and two "
            "mirrored poses look alike; put the plate on the platform's side or tilt it by 45 deg"
        )
    elif sigma[1] > GOOD_PITCH_DEG:
        warnings.append("pitch is poor: take more or larger markers, or come closer")
    if module_px < SMALL_MODULE_PX:
        warnings.append(
            f"modules of {module_px:.1f} px: markers get lost below {SMALL_MODULE_PX:g} px; take "
            "larger markers, a closer camera or a longer lens"
        )
    roll, pitch, yaw = (float(value) for value in sigma)
    return ViewBound(name, (roll, pitch, yaw), module_px, off, tuple(warnings))


def standard_views(plate: Plate, camera: CameraModel, distance_m: float) -> list[ViewBound]:
    """What a plate gives in the views there are, so many metres away."""
    return [
        bound_of_view(name, plate, _mounted(normal, towards, distance_m), camera)
        for name, normal, towards in VIEWS
    ]


def _mounted(
    normal: tuple[float, float, float], towards: tuple[float, float, float], distance_m: float
) -> Mounting:
    z = np.array(normal) / np.linalg.norm(normal)
    up = np.array([0.0, 0.0, 1.0])
    x = np.cross(up, z)
    x /= np.linalg.norm(x)
    way = np.array(towards) / np.linalg.norm(towards)
    right = np.cross(-way, up)
    right /= np.linalg.norm(right)
    return Mounting(
        np.column_stack([right, np.cross(-way, right), -way]),
        distance_m * way,
        np.column_stack([x, np.cross(z, x), z]),
        np.zeros(3),
    )


def _module_px(plate: Plate, pose: CameraPose, camera: CameraModel) -> float:
    seen = plate.corners.reshape(-1, 3) @ pose.rotation.T + pose.translation
    if seen[:, 2].min() <= 0.0:
        return 0.0
    corners = camera.project(seen).reshape(-1, 4, 2)
    diagonals = corners[:, 2:] - corners[:, :2]
    area = np.abs(np.linalg.det(diagonals)) / 2.0
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    return float((area / sides).min() / print_of(plate).modules)
