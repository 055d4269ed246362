"""A hose or a loom that hangs on the platform: a weak spring with a loss."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def wrench(
    spring_n_per_m: Any,
    turning_n_m_per_rad: Any,
    loss_s: Any,
    x: Any,
    y: Any,
    z: Any,
    roll: Any,
    pitch: Any,
    yaw: Any,
    velocity_x: Any,
    velocity_y: Any,
    velocity_z: Any,
    omega_x: Any,
    omega_y: Any,
    omega_z: Any,
) -> Any:
    """-k_u (x + tau v) and -k_r (attitude + tau omega)."""
    return (
        -spring_n_per_m * (x + loss_s * velocity_x),
        -spring_n_per_m * (y + loss_s * velocity_y),
        -spring_n_per_m * (z + loss_s * velocity_z),
        -turning_n_m_per_rad * (roll + loss_s * omega_x),
        -turning_n_m_per_rad * (pitch + loss_s * omega_y),
        -turning_n_m_per_rad * (yaw + loss_s * omega_z),
    )


EFFECT = Effect(
    name="umbilical",
    title="umbilical on the platform",
    acts=Acts.PLATFORM,
    equation="F = -k_u (x + tau v), M = -k_r (attitude + tau omega)",
    source="linear spring with a Kelvin-Voigt loss",
    signature="in phase in the wrench balance, not in the cables' own law",
    parameters=(
        Parameter("spring_n_per_m", "N/m", 10.0, 0.0, 500.0, "k_u", False, True),
        Parameter("turning_n_m_per_rad", "N m/rad", 0.1, 0.0, 10.0, "k_r", False, True),
        Parameter("loss_s", "s", 5e-3, 0.0, 0.05, "tau", False),
    ),
    wrench=wrench,
)
