"""From the plate in the camera frame to the platform in O-XYZ.

Three poses are in play: the camera's in O-XYZ, the plate's on the platform, and the one that is
measured, the plate's in the camera frame. The platform's pose is that of its centre of mass, with
R = Rz(yaw) Ry(pitch) Rx(roll).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile import schema
from vision.pose import CameraPose

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlatformPose:
    """Pose of the platform in O-XYZ.

    Attributes
    ----------
    values
        x, y, z of the centre of mass, m, and roll, pitch, yaw, rad: shape (6,).
    covariance
        Of `values`, shape (6, 6).
    """

    values: Array
    covariance: Array


@dataclass(frozen=True)
class Mounting:
    """How camera and plate are mounted.

    Attributes
    ----------
    camera_rotation
        From the camera frame to O-XYZ, shape (3, 3).
    camera_position
        In O-XYZ, m, shape (3,).
    plate_rotation
        From the plate frame to the platform frame, shape (3, 3).
    plate_position
        The plate's origin in the platform frame, from the centre of mass, m, shape (3,).
    """

    camera_rotation: Array
    camera_position: Array
    plate_rotation: Array
    plate_position: Array

    def platform(self, seen: CameraPose) -> PlatformPose:
        """Pose of the platform whose plate is seen in a pose, with its covariance."""
        rotation = self.camera_rotation @ seen.rotation @ self.plate_rotation.T
        arm = rotation @ self.plate_position
        position = self.camera_position + self.camera_rotation @ seen.translation - arm
        roll, pitch, yaw = _angles(rotation)
        # A small rotation w, in O-XYZ, turns the arm with it: the centre of mass moves by arm x w.
        jacobian = np.zeros((6, 6))
        jacobian[:3, :3] = _cross_matrix(arm) @ self.camera_rotation
        jacobian[:3, 3:] = self.camera_rotation
        jacobian[3:, :3] = _rates_of_rotation(pitch, yaw) @ self.camera_rotation
        return PlatformPose(
            np.array([*position, roll, pitch, yaw]), jacobian @ seen.covariance @ jacobian.T
        )

    def with_camera_seeing_rest(self, seen: Sequence[CameraPose]) -> "Mounting":
        """The same with the camera where poses at rest (the platform at X = 0) put it.

        Parameters
        ----------
        seen
            The plate in the camera frame, in frames at rest.
        """
        total = np.sum([pose.rotation for pose in seen], axis=0)
        left, _, right = np.linalg.svd(total)
        mean = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        place = np.mean([pose.translation for pose in seen], axis=0)
        rotation = self.plate_rotation @ mean.T
        return replace(
            self,
            camera_rotation=rotation,
            camera_position=self.plate_position - rotation @ place,
        )


def mounting_of(rig: schema.Rig) -> Mounting:
    """The mounting a rig file states; without a camera pose, the camera stands at the origin.

    Raises
    ------
    DataError
        The rig has no plate, or directions that do not make a frame.
    """
    if rig.plate is None:
        raise DataError("the rig has no [plate]", remedy="add the plate's markers and its pose")
    normal = unit(rig.plate.pose.normal, "plate.pose.normal")
    x = unit(np.cross(rig.plate.pose.up, normal), "plate.pose: up and normal")
    camera_rotation, camera_position = np.eye(3), np.zeros(3)
    if rig.camera is not None and rig.camera.pose is not None:
        pose = rig.camera.pose
        camera_position = np.asarray(pose.position_m, dtype=float)
        forward = unit(np.asarray(pose.look_at_m) - camera_position, "camera.pose.look_at_m")
        right = unit(np.cross(forward, pose.up), "camera.pose: up and the view")
        camera_rotation = np.column_stack([right, np.cross(forward, right), forward])
    return Mounting(
        camera_rotation,
        camera_position,
        np.column_stack([x, np.cross(normal, x), normal]),
        np.subtract(rig.plate.pose.position_m, rig.platform.centre_of_mass_m.value),
    )


def unit(vector: Sequence[float] | Array, where: str) -> Array:
    """A direction, of length 1; `where` names what gave it, for the message."""
    values = np.asarray(vector, dtype=float)
    length = float(np.linalg.norm(values))
    if length < 1e-9:
        raise DataError(
            "vanishes or is parallel to what it must be square to",
            where=where,
            allowed="two directions that differ",
        )
    unit: Array = values / length
    return unit


def _angles(rotation: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll), rad."""
    pitch = np.arctan2(-rotation[2, 0], np.hypot(rotation[0, 0], rotation[1, 0]))
    roll = np.arctan2(rotation[2, 1], rotation[2, 2])
    yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    return float(roll), float(pitch), float(yaw)


def _rates_of_rotation(pitch: float, yaw: float) -> Array:
    """What a small rotation about X, Y, Z does to roll, pitch, yaw: the paper's H, inverted."""
    (cos_p, cos_y), (sin_p, sin_y) = np.cos((pitch, yaw)), np.sin((pitch, yaw))
    return np.array(
        [
            [cos_y / cos_p, sin_y / cos_p, 0.0],
            [-sin_y, cos_y, 0.0],
            [cos_y * sin_p / cos_p, sin_y * sin_p / cos_p, 1.0],
        ]
    )


def _cross_matrix(vector: Array) -> Array:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
