"""Base points and anchors elsewhere than the rig file says."""

from typing import TYPE_CHECKING, Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(
    machine: "Machine",
    base_x_m: Any,
    base_y_m: Any,
    base_z_m: Any,
    anchor_x_m: Any,
    anchor_y_m: Any,
    anchor_z_m: Any,
) -> "Machine":
    """B + b and x_P + a; the pretension stays what it was at rest."""
    from dataclasses import replace

    base = np.stack([base_x_m, base_y_m, base_z_m], axis=1)
    anchor = np.stack([anchor_x_m, anchor_y_m, anchor_z_m], axis=1)
    return replace(machine, base=machine.base + base, anchor=machine.anchor + anchor)


EFFECT = Effect(
    name="geometry",
    title="geometry of base points and anchors",
    acts=Acts.PARAMETER,
    equation="B + b, x_P + a",
    source="rig file",
    signature="one factor on Delta L, a small even error; predictable from pose",
    parameters=(
        Parameter("base_x_m", "m", 5e-3, -0.1, 0.1, "b along X", True, True),
        Parameter("base_y_m", "m", 0.0, -0.1, 0.1, "b along Y", True, True),
        Parameter("base_z_m", "m", 0.0, -0.1, 0.1, "b along Z", True, True),
        Parameter("anchor_x_m", "m", 0.0, -0.05, 0.05, "a along X", True, True),
        Parameter("anchor_y_m", "m", 0.0, -0.05, 0.05, "a along Y", True, True),
        Parameter("anchor_z_m", "m", 0.0, -0.05, 0.05, "a along Z", True, True),
    ),
    change=change,
)
