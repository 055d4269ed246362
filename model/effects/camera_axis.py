"""The camera's axes are not those of O-XYZ."""

from typing import Any

import numpy as np

from model.kinematics import angles_of, rotation, trigonometry
from model.library.effect import Acts, Effect, Parameter


def measure(look: Any, axis_roll_deg: Any, axis_pitch_deg: Any, axis_yaw_deg: Any) -> Any:
    """C R C^T and C x, C the camera's rotation."""
    turned = (axis_roll_deg, axis_pitch_deg, axis_yaw_deg)
    if not any(turned):
        return look
    roll, pitch, yaw = np.radians(turned)
    camera = np.array(rotation(trigonometry((roll, pitch, yaw))))

    def seen(stamp_s: Any) -> Any:
        pose = look(stamp_s)
        platform = np.array(rotation(trigonometry(pose[:, 3:].T)))
        attitude = np.tensordot(np.tensordot(camera, platform, 1), camera, (1, 1))
        angles = angles_of(np.moveaxis(attitude, 2, 1))
        return np.hstack([pose[:, :3] @ camera.T, np.stack(angles, axis=1)])

    return seen


EFFECT = Effect(
    name="camera_axis",
    title="axis of the camera",
    acts=Acts.CAMERA,
    equation="R_m = C R C^T, x_m = C x",
    source="notes/left-out-physics.md, Section 2",
    signature="roll and yaw in proportion to pitch; pose only",
    parameters=(
        Parameter("axis_roll_deg", "deg", 0.0, -10.0, 10.0, "about X", False, True),
        Parameter("axis_pitch_deg", "deg", 0.0, -10.0, 10.0, "about Y", False, True),
        Parameter("axis_yaw_deg", "deg", 1.0, -10.0, 10.0, "about Z", False, True),
    ),
    measure=measure,
    order=3,
)
