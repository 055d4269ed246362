"""Rate-independent hysteresis of the braided cable, by one of two laws or between them.

Strands yield one after the other; or one loop softens from the first, and is about as stiff as at
the beginning whenever it turns back (Bouc and Wen).
"""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import smooth_size

ROUNDING_M_PER_S = 1e-4
"""Width over which |Delta L'| is rounded at reversal."""

TINY_M = 1e-30
"""Keeps 0 / 0 at 0: there is no sign of nothing, and nothing slips then."""

YIELDS = (1 / 6, 3 / 6, 5 / 6, 7 / 6, 9 / 6, 11 / 6)
"""Yield elongations of each sixth of the strands, over their average: evenly between 0 and twice
that. Small motions are felt by the first to yield alone: three thirds would miss them."""


def pull(
    loop_share: Any,
    bouc_wen_share: Any,
    counted_share: Any,
    z_1: Any,
    z_2: Any,
    z_3: Any,
    z_4: Any,
    z_5: Any,
    z_6: Any,
    z_w: Any,
    stiffness: Any,
    elongation: Any,
) -> Any:
    """Add alpha k [(1 - m) (z_1 + ... + z_6) / 6 + m z_w - s x]."""
    strands = (z_1 + z_2 + z_3 + z_4 + z_5 + z_6) / 6.0
    held = strands + bouc_wen_share * (z_w - strands)
    return loop_share * stiffness * (held - counted_share * elongation)


def _held(yield_m: Any, fibre: Any, elongation_rate: Any) -> Any:
    """Give z' = x' - (|x'| sgn z + x') p/(1 + p), p = (z/y)^8: all of x' at first, none at y."""
    speed, size = smooth_size(elongation_rate, ROUNDING_M_PER_S), np.abs(fibre) + TINY_M
    square = fibre * fibre
    fourth = square * square
    level = yield_m * yield_m
    level = level * level
    slips = fourth * fourth / ((fourth * fourth + level * level) * size)
    return elongation_rate - slips * (speed * fibre + size * elongation_rate)


def _softening(yield_m: Any, bend: Any, back: Any, held: Any, elongation_rate: Any) -> Any:
    """Give z' = x' - ((1 - c) |x'| sgn z + c x') q, q = (1 - b) r + b r^2, r = |z|/y."""
    speed, size = smooth_size(elongation_rate, ROUNDING_M_PER_S), np.abs(held)
    slips = (1.0 + bend * (size / yield_m - 1.0)) / yield_m
    on = speed * held
    return elongation_rate - slips * (on + back * (size * elongation_rate - on))


def rates(
    yield_m: Any,
    bend: Any,
    back_share: Any,
    z_1: Any,
    z_2: Any,
    z_3: Any,
    z_4: Any,
    z_5: Any,
    z_6: Any,
    z_w: Any,
    elongation_rate: Any,
) -> tuple[Any, ...]:
    """Of each sixth, by its own yield elongation, and of Bouc and Wen's."""
    return (
        _held(YIELDS[0] * yield_m, z_1, elongation_rate),
        _held(YIELDS[1] * yield_m, z_2, elongation_rate),
        _held(YIELDS[2] * yield_m, z_3, elongation_rate),
        _held(YIELDS[3] * yield_m, z_4, elongation_rate),
        _held(YIELDS[4] * yield_m, z_5, elongation_rate),
        _held(YIELDS[5] * yield_m, z_6, elongation_rate),
        _softening(yield_m, bend, back_share, z_w, elongation_rate),
    )


EFFECT = Effect(
    name="cable_hysteresis",
    title="hysteresis of the cable",
    acts=Acts.CABLE,
    equation="T += a k [(1 - m) (z_1 + ... + z_6)/6 + m z_w - s x], z' = x' - (|x'| sgn z + "
    "x') p/(1 + p), p = (z/y)^8, x = Delta L, y = x_y/6, 3 x_y/6, ..., 11 x_y/6; "
    "z_w' = x' - ((1 - c) |x'| sgn z_w + c x') [(1 - b) r + b r^2], r = |z_w|/x_y",
    source="strands that yield between 0 and 2 x_y: Iwan, J. Appl. Mech. 33 (1966) 893, each by "
    "Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249, n = 8; z_w: the same with n = 1 to 2",
    signature="weak odd harmonics, a loop with sharp tips, rate-independent; tan delta and "
    "stiffness depend on amplitude",
    parameters=(
        Parameter("loop_share", "1", 0.1, 0.0, 0.8, "a", magnitude=True),
        Parameter("yield_m", "m", 1e-3, 2e-4, 2e-2, "x_y, of strands on average"),
        Parameter("bouc_wen_share", "1", 0.0, 0.0, 1.0, "m: 0 strands, 1 Bouc and Wen"),
        Parameter(
            "counted_share",
            "1",
            0.0,
            0.0,
            1.0,
            "s: how much of a is in the stiffness already: 1 before, 0 after fibres slip",
        ),
        Parameter("bend", "1", 0.5, 0.0, 1.0, "b: 0 for n = 1, 1 for n = 2"),
        Parameter(
            "back_share",
            "1",
            0.5,
            0.2,
            0.8,
            "c, gamma/(beta + gamma): 0.5, as stiff as at first as it turns back; more, softer",
        ),
    ),
    states=(
        State("z_1", "m", "what the sixth of the strands holds that yields first"),
        State("z_2", "m", "the next sixth"),
        State("z_3", "m", "the next"),
        State("z_4", "m", "the next"),
        State("z_5", "m", "the next"),
        State("z_6", "m", "the sixth that yields last"),
        State("z_w", "m", "what Bouc and Wen's loop holds"),
    ),
    pull=pull,
    rates=rates,
    longest_step_s=3.1e-3,
    cost="|x'| is rounded over 0.1 mm/s; seven states a cable",
)
