"""Rate-independent hysteresis of the braided cable: its strands yield one after the other."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import smooth_sign, smooth_size

ROUNDING_M_PER_S = 1e-4
"""Width over which |Delta L'| is rounded at reversal."""

ROUNDING = 1e-3
"""Width over which sgn z is rounded, as a share of the yield elongation."""

EARLY, LATE = 1.0 / 3.0, 5.0 / 3.0
"""Yield elongations of the first and the last third of the strands, over that of the second."""


def pull(loop_share: Any, first: Any, second: Any, third: Any, stiffness: Any) -> Any:
    """Add alpha k (z_1 + z_2 + z_3) / 3."""
    return loop_share * stiffness * (first + second + third) / 3.0


def _held(yield_m: Any, fibre: Any, elongation_rate: Any) -> Any:
    """Give z' = x' - (|x'| sgn z + x') p/(1 + p), p = (z/y)^8: all of x' at first, none at y."""
    speed = smooth_size(elongation_rate, ROUNDING_M_PER_S)
    square = fibre * fibre
    fourth = square * square
    level = yield_m * yield_m
    level = level * level
    slips = fourth * fourth / (fourth * fourth + level * level)
    return elongation_rate - slips * (
        speed * smooth_sign(fibre, ROUNDING * yield_m) + elongation_rate
    )


def rates(
    yield_m: Any, first: Any, second: Any, third: Any, elongation_rate: Any
) -> tuple[Any, Any, Any]:
    """Of each third, by its own yield elongation."""
    return (
        _held(EARLY * yield_m, first, elongation_rate),
        _held(yield_m, second, elongation_rate),
        _held(LATE * yield_m, third, elongation_rate),
    )


EFFECT = Effect(
    name="cable_hysteresis",
    title="hysteresis of the cable",
    acts=Acts.CABLE,
    equation="T += a k (z_1 + z_2 + z_3)/3, z' = x' - (|x'| sgn z + x') p/(1 + p), "
    "p = (z/y)^8, x = Delta L, y = x_y/3, x_y, 5 x_y/3",
    source="strands that yield between 0 and 2 x_y: Iwan, J. Appl. Mech. 33 (1966) 893; each by "
    "Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249, n = 8",
    signature="weak odd harmonics, a loop with sharp tips, rate-independent; tan delta and "
    "stiffness depend on amplitude",
    parameters=(
        Parameter("loop_share", "1", 0.1, 0.0, 0.5, "a", magnitude=True),
        Parameter("yield_m", "m", 1e-3, 2e-4, 2e-2, "x_y, on average"),
    ),
    states=(
        State("first", "m", "z_1, what the strands hold that yield first"),
        State("second", "m", "z_2, those after them"),
        State("third", "m", "z_3, those that yield last"),
    ),
    pull=pull,
    rates=rates,
    longest_step_s=1.6e-3,
    cost="|x'| is rounded over 0.1 mm/s; twice the steps",
)
