"""Drag of the air on the platform, in proportion to the square of its speed."""

from typing import Any

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
    """-rho C_d A |v| v / 2, axis by axis, and -c |omega| omega."""
    push = 0.5 * AIR_KG_PER_M3 * drag_area_m2
    return (
        -push * smooth_size(velocity_x, ROUNDING) * velocity_x,
        -push * smooth_size(velocity_y, ROUNDING) * velocity_y,
        -push * smooth_size(velocity_z, ROUNDING) * velocity_z,
        -turning_n_m_s2 * smooth_size(omega_x, ROUNDING) * omega_x,
        -turning_n_m_s2 * smooth_size(omega_y, ROUNDING) * omega_y,
        -turning_n_m_s2 * smooth_size(omega_z, ROUNDING) * omega_z,
    )


EFFECT = Effect(
    name="air_drag",
    title="quadratic drag of the air",
    acts=Acts.PLATFORM,
    equation="F = -rho C_d A |v| v/2, M = -c |omega| omega, axis by axis",
    source="Newton; Hoerner, Fluid-Dynamic Drag (1965)",
    signature="quadrature as the square of the amplitude, 3rd harmonic; decay as 1/A",
    parameters=(
        Parameter("drag_area_m2", "m2", 0.05, 0.0, 1.0, "C_d A", False, True),
        Parameter("turning_n_m_s2", "N m s2", 1e-3, 0.0, 0.1, "c", False, True),
    ),
    wrench=wrench,
)
