"""Inertia of the platform other than the rig file says."""

from typing import TYPE_CHECKING, Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(machine: "Machine", roll_share: Any, pitch_share: Any, yaw_share: Any) -> "Machine":
    """S I S with S = diag(sqrt(1 + e)): stays a tensor, and symmetric."""
    from dataclasses import replace

    shares = np.array([roll_share[0], pitch_share[0], yaw_share[0]])
    scale = np.sqrt(1.0 + shares)
    return replace(machine, inertia=machine.inertia * scale[:, None] * scale[None, :])


EFFECT = Effect(
    name="inertia",
    title="inertia of the platform",
    acts=Acts.PARAMETER,
    equation="I_ab sqrt((1 + e_a)(1 + e_b))",
    source="rig file",
    signature="in the wrench balance only, -w^2 in rotation; like stiffness at one frequency",
    parameters=(
        Parameter("roll_share", "1", 0.0, -0.5, 2.0, "e about X", False, True),
        Parameter("pitch_share", "1", 0.1, -0.5, 2.0, "e about Y", False, True),
        Parameter("yaw_share", "1", 0.0, -0.5, 2.0, "e about Z", False, True),
    ),
    change=change,
)
