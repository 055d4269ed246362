"""The cable leaves a pulley of finite radius, not a point."""

from typing import TYPE_CHECKING, Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(machine: "Machine", radius_m: Any, left_at_rest: Any) -> "Machine":
    """Where the cables leave their pulleys at rest, if the rig file does not say that already.

    The pulley swivels about the vertical through the base point, where the cable comes up; it goes
    over the top, and leaves on the tangent, r (1 + sin beta) farther in and r cos beta higher.
    """
    from dataclasses import replace

    line = machine.base - machine.anchor
    up = line[:, 2] / np.linalg.norm(line, axis=1)
    level = np.hypot(line[:, 0], line[:, 1])
    radius = radius_m * (1.0 - left_at_rest)
    inwards = radius * (1.0 + up) / level
    offset = np.stack(
        [-inwards * line[:, 0], -inwards * line[:, 1], radius * np.sqrt(1.0 - up * up)], axis=1
    )
    return replace(machine, base=machine.base + offset)


def pull(
    radius_m: Any, left_at_rest: Any, stiffness: Any, direction_z: Any, rest_direction_z: Any
) -> Any:
    """Add k r [(beta - beta_0) - (cos beta - cos beta_0)], beta the elevation of the cable."""
    up, up_0 = direction_z, rest_direction_z
    level, level_0 = np.sqrt(1.0 - up * up), np.sqrt(1.0 - up_0 * up_0)
    sine = up * level_0 - level * up_0
    square = sine * sine
    turned = sine * (1.0 + square / 6.0 * (1.0 + 0.45 * square))
    return stiffness * radius_m * left_at_rest * (turned - (level - level_0))


EFFECT = Effect(
    name="pulley_geometry",
    title="geometry of the pulley",
    acts=Acts.CABLE,
    equation="B + r [(1 + sin beta_0) e + cos beta_0 Z], e: towards the platform; or, where B is "
    "where the cable leaves at rest, T += k r [(beta - beta_0) - (cos beta - cos beta_0)]",
    source="Pott, Cable-Driven Parallel Robots (2018), Section 7.1, to first order in r/L; the "
    "cable comes from below the pulley, which swivels about Z; beta: elevation of u_i",
    signature="gain and an even error, smooth in pose, rate-free, without a loop; tensions at rest "
    "that do not balance the weight",
    parameters=(
        Parameter("radius_m", "m", 0.03, 0.0, 0.15, "r", magnitude=True),
        Parameter("left_at_rest", "1", 0.0, 0.0, 1.0, "1: B is where the cable leaves at rest"),
    ),
    change=change,
    pull=pull,
)
