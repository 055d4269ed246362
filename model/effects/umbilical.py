"""A hose or a loom that hangs on the platform, at some point of it: a weak spring with a loss."""

from typing import Any

from model.kinematics import add, cross, rotation, scale, subtract, transform, trigonometry
from model.library.effect import Acts, Effect, Parameter


def wrench(
    spring_n_per_m: Any,
    turning_n_m_per_rad: Any,
    loss_s: Any,
    at_x_m: Any,
    at_y_m: Any,
    at_z_m: Any,
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
    """-k_u (u + tau u') at the point, u by how far it is from where it rests; -k_r in turning."""
    omega = (omega_x, omega_y, omega_z)
    point = (at_x_m, at_y_m, at_z_m)
    arm = transform(rotation(trigonometry((roll, pitch, yaw))), point)
    moved = add((x, y, z), subtract(arm, point))
    speed = add((velocity_x, velocity_y, velocity_z), cross(omega, arm))
    force = scale(-spring_n_per_m, add(moved, scale(loss_s, speed)))
    turned = add((roll, pitch, yaw), scale(loss_s, omega))
    moment = add(cross(arm, force), scale(-turning_n_m_per_rad, turned))
    return (force[0], force[1], force[2], moment[0], moment[1], moment[2])


EFFECT = Effect(
    name="umbilical",
    title="umbilical on the platform",
    acts=Acts.PLATFORM,
    equation="F = -k_u (u + tau u'), M = a x F - k_r (attitude + tau omega), u the way of point a",
    source="linear spring with a Kelvin-Voigt loss",
    signature="in phase in the wrench balance, not in the cables' own law",
    parameters=(
        Parameter("spring_n_per_m", "N/m", 10.0, 0.0, 1000.0, "k_u", False, True),
        Parameter("turning_n_m_per_rad", "N m/rad", 0.1, 0.0, 10.0, "k_r", False, True),
        Parameter("loss_s", "s", 5e-3, 0.0, 0.05, "tau", False),
        Parameter("at_x_m", "m", 0.0, -0.3, 0.3, "a_x", False),
        Parameter("at_y_m", "m", 0.0, -0.3, 0.3, "a_y", False),
        Parameter("at_z_m", "m", 0.0, -0.3, 0.3, "a_z", False),
    ),
    wrench=wrench,
)
