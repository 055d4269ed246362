"""Transverse modes beyond the first, in both planes, shaken by the moving anchor."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State
from model.library.taut_string import FIRST_MODE, PI, swept, tone_squared


def pull(
    coupling: Any,
    v2: Any,
    v3: Any,
    v4: Any,
    h1: Any,
    h2: Any,
    h3: Any,
    h4: Any,
    stiffness: Any,
    length: Any,
) -> Any:
    """Add k sum of n^2 pi^2 X_n^2 / (4 L), Eq. 15 for each mode."""
    vertical = 4.0 * v2 * v2 + 9.0 * v3 * v3 + 16.0 * v4 * v4
    horizontal = h1 * h1 + 4.0 * h2 * h2 + 9.0 * h3 * h3 + 16.0 * h4 * h4
    return coupling * stiffness * PI * PI * (vertical + horizontal) / (4.0 * length)


def rates(
    v2: Any,
    v3: Any,
    v4: Any,
    h1: Any,
    h2: Any,
    h3: Any,
    h4: Any,
    v2_rate: Any,
    v3_rate: Any,
    v4_rate: Any,
    h1_rate: Any,
    h2_rate: Any,
    h3_rate: Any,
    h4_rate: Any,
    tension: Any,
    axial_velocity: Any,
    length: Any,
    line_density: Any,
    damping: Any,
    line_loss_share: Any,
    loss_growth: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    anchor_velocity_x: Any,
    anchor_velocity_y: Any,
    anchor_velocity_z: Any,
) -> Any:
    """Eq. 17 with n pi for pi; the rates are those of the cable, not of what its line sweeps."""
    vertical, horizontal = swept(
        direction_x,
        direction_y,
        direction_z,
        anchor_velocity_x,
        anchor_velocity_y,
        anchor_velocity_z,
    )
    vertical, horizontal = FIRST_MODE * vertical, FIRST_MODE * horizontal
    square = tone_squared(tension, axial_velocity, length, line_density)
    v2_speed, v3_speed = v2_rate + vertical / 2.0, v3_rate - vertical / 3.0
    v4_speed, h1_speed = v4_rate + vertical / 4.0, h1_rate - horizontal
    h2_speed, h3_speed = h2_rate + horizontal / 2.0, h3_rate - horizontal / 3.0
    h4_speed = h4_rate + horizontal / 4.0
    # Air slows the cable itself; what its fibres lose is lost beside the line.
    vertical, horizontal = line_loss_share * vertical, line_loss_share * horizontal
    more = loss_growth * damping
    second, third, fourth = damping + more, damping + 2.0 * more, damping + 3.0 * more
    return (
        v2_speed,
        v3_speed,
        v4_speed,
        h1_speed,
        h2_speed,
        h3_speed,
        h4_speed,
        -second * (v2_rate + vertical / 2.0) - 4.0 * square * v2,
        -third * (v3_rate - vertical / 3.0) - 9.0 * square * v3,
        -fourth * (v4_rate + vertical / 4.0) - 16.0 * square * v4,
        -damping * (h1_rate - horizontal) - square * h1,
        -second * (h2_rate + horizontal / 2.0) - 4.0 * square * h2,
        -third * (h3_rate - horizontal / 3.0) - 9.0 * square * h3,
        -fourth * (h4_rate + horizontal / 4.0) - 16.0 * square * h4,
    )


MODES = tuple((f"v{n}", n, "vertical") for n in (2, 3, 4)) + tuple(
    (f"h{n}", n, "horizontal") for n in (1, 2, 3, 4)
)

EFFECT = Effect(
    name="cable_modes",
    title="transverse modes beyond the first, in both planes",
    acts=Acts.CABLE,
    equation="X_n'' + c_n X_n' + (n pi/L)^2 (T/rho - v^2) X_n = 2 (-1)^n w''/(n pi); n = 2 to 4 in "
    "the vertical plane, 1 to 4 across it; T += a k sum n^2 pi^2 X_n^2/(4 L); "
    "c_n = c (1 + g (n - 1)), and a share 1 - q of it is lost of the cable's own rate",
    source="Eqs. 5 to 17 of Peng et al. (2023) with n sines; Irvine, Cable Structures (1981). A "
    "platform let go rings at three to four times a cable's first tone",
    signature="lines at the modes' tones and beside them, in the tensions only",
    parameters=(
        Parameter("coupling", "1", 1.0, 0.0, 2.5, "a: 1 for Eq. 15", magnitude=True),
        Parameter("line_loss_share", "1", 1.0, 0.0, 1.0, "q: 1 for Eq. 17, 0 for air alone"),
        Parameter("loss_growth", "1", 0.0, 0.0, 3.0, "g: 1 where loss goes with a mode's number"),
    ),
    states=(
        *(State(name, "m", f"mid-span amplitude, mode {n}, {plane} plane")
          for name, n, plane in MODES),
        *(State(f"{name}_rate", "m/s", "its rate") for name, _, _ in MODES),
    ),
    pull=pull,
    rates=rates,
    longest_step_s=2e-3,
    cost="the fourth mode sounds four times higher; twice the steps",
)  # fmt: skip
