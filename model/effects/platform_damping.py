"""Viscous damping of the platform itself: the paper's has none."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def wrench(
    linear_n_s_per_m: Any,
    angular_n_m_s: Any,
    velocity_x: Any,
    velocity_y: Any,
    velocity_z: Any,
    omega_x: Any,
    omega_y: Any,
    omega_z: Any,
) -> Any:
    """-c v and -c_r omega."""
    return (
        -linear_n_s_per_m * velocity_x,
        -linear_n_s_per_m * velocity_y,
        -linear_n_s_per_m * velocity_z,
        -angular_n_m_s * omega_x,
        -angular_n_m_s * omega_y,
        -angular_n_m_s * omega_z,
    )


EFFECT = Effect(
    name="platform_damping",
    title="viscous damping of the platform",
    acts=Acts.PLATFORM,
    equation="F = -c v, M = -c_r omega",
    source="Rayleigh, Theory of Sound (1877), Section 81",
    signature="quadrature in proportion to frequency in the wrench, not in a single cable; "
    "exponential decay",
    parameters=(
        Parameter("linear_n_s_per_m", "N s/m", 1.0, 0.0, 50.0, "c", False, True),
        Parameter("angular_n_m_s", "N m s", 0.02, 0.0, 2.0, "c_r", False, True),
    ),
    wrench=wrench,
)
