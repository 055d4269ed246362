"""The moving anchor shakes its cable, and feels it: Eq. 17 is homogeneous, a real cable is not."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State
from model.library.taut_string import FIRST_MODE, PI, level, swept, tone_squared


def transverse(
    forcing_share: Any,
    damping: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    anchor_velocity_x: Any,
    anchor_velocity_y: Any,
    anchor_velocity_z: Any,
) -> Any:
    """-2/pi w', and its share of the loss; w: the anchor's way across the cable, vertical plane."""
    vertical, _ = swept(
        direction_x,
        direction_y,
        direction_z,
        anchor_velocity_x,
        anchor_velocity_y,
        anchor_velocity_z,
    )
    shaken = forcing_share * FIRST_MODE * vertical
    return -shaken, damping * shaken


def pull(
    overtone_share: Any,
    v2: Any,
    v3: Any,
    h1: Any,
    h2: Any,
    h3: Any,
    stiffness: Any,
    length: Any,
) -> Any:
    """Of the other modes, as Eq. 15 has it of the first: k n^2 pi^2 X_n^2 / (4 L)."""
    squares = 4.0 * v2 * v2 + 9.0 * v3 * v3 + h1 * h1 + 4.0 * h2 * h2 + 9.0 * h3 * h3
    return overtone_share * stiffness * PI * PI * squares / (4.0 * length)


def rates(
    forcing_share: Any,
    v2: Any,
    v3: Any,
    h1: Any,
    h2: Any,
    h3: Any,
    v2_rate: Any,
    v3_rate: Any,
    h1_rate: Any,
    h2_rate: Any,
    h3_rate: Any,
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
    vertical, horizontal = swept(
        direction_x,
        direction_y,
        direction_z,
        anchor_velocity_x,
        anchor_velocity_y,
        anchor_velocity_z,
    )
    shaken = forcing_share * FIRST_MODE
    vertical, horizontal = shaken * vertical, shaken * horizontal
    square = tone_squared(tension, axial_velocity, length, line_density)
    v2_speed, v3_speed = v2_rate + vertical / 2.0, v3_rate - vertical / 3.0
    h1_speed, h2_speed = h1_rate - horizontal, h2_rate + horizontal / 2.0
    h3_speed = h3_rate - horizontal / 3.0
    return (
        v2_speed,
        v3_speed,
        h1_speed,
        h2_speed,
        h3_speed,
        -damping * v2_speed - 4.0 * square * v2,
        -damping * v3_speed - 9.0 * square * v3,
        -damping * h1_speed - square * h1,
        -damping * h2_speed - 4.0 * square * h2,
        -damping * h3_speed - 9.0 * square * h3,
    )


def reaction(
    forcing_share: Any,
    reaction_share: Any,
    overtone_share: Any,
    mid_span: Any,
    v2: Any,
    v3: Any,
    h1: Any,
    h2: Any,
    h3: Any,
    tension: Any,
    length: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
) -> Any:
    """T times the slope of the cable at its anchor, in both planes."""
    flat = level(direction_z)
    pulls = forcing_share * reaction_share * tension * PI / length / flat
    vertical = pulls * (mid_span + overtone_share * (3.0 * v3 - 2.0 * v2))
    horizontal = pulls * overtone_share * (h1 - 2.0 * h2 + 3.0 * h3)
    return (
        horizontal * direction_y - vertical * direction_x * direction_z,
        -horizontal * direction_x - vertical * direction_y * direction_z,
        vertical * flat * flat,
    )


EFFECT = Effect(
    name="cable_end_forcing",
    title="the moving anchor shakes the cable",
    acts=Acts.CABLE,
    equation="X_n'' + c X_n' + (n pi/L)^2 (T/rho - v^2) X_n = 2 a (-1)^n w''/(n pi), w: movement "
    "of the anchor across the cable; n = 1 to 3, in both planes; the states X_n' hold "
    "X_n' - 2 a (-1)^n w'/(n pi). T += k sum n^2 pi^2 X_n^2/(4 L); across the cable the anchor is "
    "pulled by a b T sum (-1)^(n + 1) n pi X_n/L; of both sums all but the paper's mode times s",
    source="Irvine, Cable Structures (1981), Section 3; modal projection of a moving end; "
    "Meirovitch, Fundamentals of Vibrations (2001), Section 8.2",
    signature="cable vibration at the drive's own frequency, large near the cable's tone; tension "
    "at twice the frequency; the platform's tones are lower by the mass of the cables",
    parameters=(
        Parameter("forcing_share", "1", 1.0, 0.0, 2.0, "a: 1 for a taut string", magnitude=True),
        Parameter("reaction_share", "1", 1.0, 0.0, 1.0, "b: 1 where the anchor feels the slope"),
        Parameter("overtone_share", "1", 1.0, 0.0, 1.0, "s: 0 where Eq. 17 alone is shaken"),
    ),
    states=(
        *(
            State(name, "m", f"mid-span amplitude, mode {name[1]}, {plane} plane")
            for name, plane in (
                ("v2", "vertical"),
                ("v3", "vertical"),
                ("h1", "horizontal"),
                ("h2", "horizontal"),
                ("h3", "horizontal"),
            )
        ),
        *(State(f"{name}_rate", "m/s", "its rate") for name in ("v2", "v3", "h1", "h2", "h3")),
    ),
    pull=pull,
    rates=rates,
    transverse=transverse,
    across=reaction,
    longest_step_s=3e-3,
    cost="ten states a cable, and the third mode sounds three times higher",
)
