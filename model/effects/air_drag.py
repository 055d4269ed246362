"""Drag of the air on the platform, in proportion to the square of its faces' speed.

A platform that pitches holds its heaving back as well: its faces move through the air already.
"""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_size

AIR_KG_PER_M3 = 1.2
"""Density of air at 20 deg C."""

ROUNDING = 1e-3
"""m/s over which the speed is rounded at standstill."""


def wrench(
    drag_area_m2: Any,
    turning_n_m_s2: Any,
    arm_m: Any,
    velocity_x: Any,
    velocity_y: Any,
    velocity_z: Any,
    omega_x: Any,
    omega_y: Any,
    omega_z: Any,
) -> Any:
    """-rho C_d A |V| v / 2 and -c |V| omega / a: the faces' speed, |V|, is of both at once."""
    turned = arm_m * arm_m * (omega_x * omega_x + omega_y * omega_y + omega_z * omega_z)
    moved = velocity_x * velocity_x + velocity_y * velocity_y + velocity_z * velocity_z
    speed = smooth_size(np.sqrt(moved + turned), ROUNDING)
    push = 0.5 * AIR_KG_PER_M3 * drag_area_m2 * speed
    turn = turning_n_m_s2 / arm_m * speed
    return (
        -push * velocity_x,
        -push * velocity_y,
        -push * velocity_z,
        -turn * omega_x,
        -turn * omega_y,
        -turn * omega_z,
    )


EFFECT = Effect(
    name="air_drag",
    title="quadratic drag of the air",
    acts=Acts.PLATFORM,
    equation="F = -rho C_d A |V| v/2, M = -c |V| omega/a, |V|^2 = |v|^2 + a^2 |omega|^2",
    source="Newton; Hoerner, Fluid-Dynamic Drag (1965); of faces at an arm a, to lowest order",
    signature="quadrature as the square of the amplitude, 3rd harmonic; decay as 1/A",
    parameters=(
        Parameter("drag_area_m2", "m2", 0.05, 0.0, 2.0, "C_d A", False, True),
        Parameter("turning_n_m_s2", "N m s2", 1e-3, 0.0, 0.1, "c", False, True),
        Parameter("arm_m", "m", 0.15, 0.03, 1.0, "a, of the faces from the centre", False),
    ),
    wrench=wrench,
)
