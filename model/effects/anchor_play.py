"""Clearance where the cable is hooked to the platform, held by friction until it is overcome."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import TINY, positive, smooth_sign

ROUNDING_M_PER_S = 1e-4
"""Width over which the direction of motion changes."""


def pull(play_m: Any, hook: Any, stiffness: Any) -> Any:
    """-k y, y the way the hook has slid."""
    return -stiffness * hook * (play_m / (play_m + TINY))


def rates(
    play_m: Any, hold_n: Any, hook: Any, elongation: Any, elongation_rate: Any, stiffness: Any
) -> Any:
    """Give y' = x' where k (x - y) overcomes the hold and the hook is not at its stop."""
    way = smooth_sign(elongation_rate, ROUNDING_M_PER_S)
    pressed = positive(way * stiffness * (elongation - hook) / hold_n)
    free = pressed * pressed
    free = free * free
    slides = free * free / (1.0 + free * free)
    reached = positive(way * hook / (play_m + TINY))
    square = reached * reached
    return elongation_rate * slides * positive(1.0 - square * square)


EFFECT = Effect(
    name="anchor_play",
    title="play of the hook at the anchor",
    acts=Acts.CABLE,
    equation="T -= k y, |y| <= d: y' = x' p^8/(1 + p^8) (1 - (y/d)^4), p = k(x - y) sgn(x')/F_h",
    source="friction-held clearance; Nordin & Gutman, Automatica 38 (2002) 1633",
    signature="a plateau of the tension after reversal, once the force exceeds the hold; none "
    "below an amplitude",
    parameters=(
        Parameter("play_m", "m", 2e-4, 0.0, 2e-3, "d", magnitude=True),
        Parameter("hold_n", "N", 0.5, 0.05, 10.0, "F_h"),
    ),
    states=(State("hook", "m", "y, the way the hook has slid"),),
    pull=pull,
    rates=rates,
    longest_step_s=1e-3,
    cost="the stop is met as (y/d)^4, the hold as p^8; four times the steps",
)
