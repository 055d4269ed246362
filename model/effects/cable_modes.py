"""Transverse modes beyond the first, in both planes, shaken by the moving anchor."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State

PI_SQUARED = float(np.pi) ** 2
FIRST_MODE = 2.0 / float(np.pi)


def pull(coupling: Any, v2: Any, v3: Any, h1: Any, h2: Any, stiffness: Any, length: Any) -> Any:
    """Add k sum of n^2 pi^2 X_n^2 / (4 L), Eq. 15 for each mode."""
    squares = 4.0 * v2 * v2 + 9.0 * v3 * v3 + h1 * h1 + 4.0 * h2 * h2
    return coupling * stiffness * PI_SQUARED * squares / (4.0 * length)


def rates(
    v2: Any,
    v3: Any,
    h1: Any,
    h2: Any,
    v2_rate: Any,
    v3_rate: Any,
    h1_rate: Any,
    h2_rate: Any,
    tension: Any,
    axial_velocity: Any,
    length: Any,
    line_density: Any,
    damping: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    anchor_velocity_x: Any,
    anchor_velocity_y: Any,
    anchor_velocity_z: Any,
) -> Any:
    """Eq. 17 with n pi for pi; the rates are those of the cable, its loss is of its line's."""
    along = (
        direction_x * anchor_velocity_x
        + direction_y * anchor_velocity_y
        + direction_z * anchor_velocity_z
    )
    level = np.sqrt(1.0 - direction_z * direction_z + 1e-12)
    vertical = FIRST_MODE * (anchor_velocity_z - along * direction_z) / level
    sideways = (direction_y * anchor_velocity_x - direction_x * anchor_velocity_y) / level
    horizontal = FIRST_MODE * sideways
    wave = tension / line_density - axial_velocity * axial_velocity
    square = PI_SQUARED / (length * length) * wave
    v2_speed, v3_speed = v2_rate + vertical / 2.0, v3_rate - vertical / 3.0
    h1_speed, h2_speed = h1_rate - horizontal, h2_rate + horizontal / 2.0
    return (
        v2_speed,
        v3_speed,
        h1_speed,
        h2_speed,
        -damping * v2_speed - 4.0 * square * v2,
        -damping * v3_speed - 9.0 * square * v3,
        -damping * h1_speed - square * h1,
        -damping * h2_speed - 4.0 * square * h2,
    )


EFFECT = Effect(
    name="cable_modes",
    title="transverse modes beyond the first, in both planes",
    acts=Acts.CABLE,
    equation="X_n'' + c X_n' + (n pi/L)^2 (T/rho - v^2) X_n = 2 (-1)^n w''/(n pi); n = 2, 3 in "
    "the vertical plane, 1, 2 across it; T += a k sum n^2 pi^2 X_n^2/(4 L)",
    source="Eqs. 5 to 17 of Peng et al. (2023) with n sines; Irvine, Cable Structures (1981)",
    signature="lines at the modes' tones and beside them, in the tensions only",
    parameters=(Parameter("coupling", "1", 1.0, 0.0, 2.0, "a: 1 for Eq. 15", magnitude=True),),
    states=(
        *(
            State(name, "m", f"mid-span amplitude, mode {name[1]}, {plane} plane")
            for name, plane in (
                ("v2", "vertical"),
                ("v3", "vertical"),
                ("h1", "horizontal"),
                ("h2", "horizontal"),
            )
        ),
        *(State(f"{name}_rate", "m/s", "its rate") for name in ("v2", "v3", "h1", "h2")),
    ),
    pull=pull,
    rates=rates,
    longest_step_s=2e-3,
    cost="the third mode sounds three times higher; twice the steps",
)
