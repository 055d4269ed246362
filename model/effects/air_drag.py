"""Drag of the air on the platform, in proportion to the square of its speed."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_size

AIR_KG_PER_M3 = 1.2
"""Density of air at 20 deg C."""

ROUNDING = 1e-3
"""m/s and rad/s over which the speed is rounded at standstill."""


def wrench(
    drag_area_m2: Any,
    turning_n_m_s2: Any,
    velocity_x: Any,
    velocity_y: Any,
    velocity_z: Any,
    omega_x: Any,
    omega_y: Any,
    omega_z: Any,
) -> Any:
    """-rho C_d A |v| v / 2 and -c |omega| omega: what moves fast one way is held every way."""
    speed = np.sqrt(velocity_x * velocity_x + velocity_y * velocity_y + velocity_z * velocity_z)
    spin = np.sqrt(omega_x * omega_x + omega_y * omega_y + omega_z * omega_z)
    push = 0.5 * AIR_KG_PER_M3 * drag_area_m2 * smooth_size(speed, ROUNDING)
    turn = turning_n_m_s2 * smooth_size(spin, ROUNDING)
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
    equation="F = -rho C_d A |v| v/2, M = -c |omega| omega",
    source="Newton; Hoerner, Fluid-Dynamic Drag (1965)",
    signature="quadrature as the square of the amplitude, 3rd harmonic; decay as 1/A",
    parameters=(
        Parameter("drag_area_m2", "m2", 0.05, 0.0, 1.0, "C_d A", False, True),
        Parameter("turning_n_m_s2", "N m s2", 1e-3, 0.0, 0.1, "c", False, True),
    ),
    wrench=wrench,
)
