"""Centre of mass of the platform elsewhere than the rig file says."""

from typing import TYPE_CHECKING, Any

import numpy as np

from model.kinematics import rotation, transform, trigonometry
from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(
    machine: "Machine",
    centre_x_m: Any,
    centre_y_m: Any,
    centre_z_m: Any,
    drive_stays_share: Any,
) -> "Machine":
    """Anchors, base points and the drive seen from the moved centre; lengths at rest stay."""
    from dataclasses import replace

    moved = np.array([centre_x_m[0], centre_y_m[0], centre_z_m[0]])
    return replace(
        machine,
        anchor=machine.anchor - moved,
        base=machine.base - moved,
        drive_arm=machine.drive_arm - drive_stays_share[0] * moved,
    )


def measure(
    look: Any,
    centre_x_m: float,
    centre_y_m: float,
    centre_z_m: float,
    drive_stays_share: float,  # noqa: ARG001  # a look is given every number of its effect
) -> Any:
    """X + d - R d: a camera sees the point that the rig file takes for the centre of mass."""
    moved = np.array([centre_x_m, centre_y_m, centre_z_m])

    def seen(stamp_s: Any) -> Any:
        pose = look(stamp_s)
        turned = transform(rotation(trigonometry(pose[:, 3:].T)), tuple(moved))
        return np.hstack([pose[:, :3] + moved - np.stack(turned, axis=1), pose[:, 3:]])

    return seen


EFFECT = Effect(
    name="centre_of_mass",
    title="centre of mass of the platform",
    acts=Acts.PARAMETER,
    equation="x_P - d, B - d; seen: x + d - R d",
    source="rig file",
    signature="a constant moment of the weight; rotation and translation couple",
    parameters=(
        Parameter("centre_x_m", "m", 2e-3, -0.05, 0.05, "d along X", False, True),
        Parameter("centre_y_m", "m", 0.0, -0.05, 0.05, "d along Y", False, True),
        Parameter("centre_z_m", "m", 0.0, -0.05, 0.05, "d along Z", False, True),
        Parameter(
            "drive_stays_share",
            "1",
            0.0,
            0.0,
            1.0,
            "a wrench drive acts at the true centre; 1: where the rig file has it",
            False,
        ),
    ),
    change=change,
    measure=measure,
)
