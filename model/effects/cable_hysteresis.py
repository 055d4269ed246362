"""Rate-independent hysteresis of the braided cable (Bouc-Wen)."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import smooth_size

ROUNDING_M_PER_S = 1e-4
"""Width over which |Delta L'| is rounded at reversal."""

ROUNDING = 1e-3
"""Width over which |z| is rounded, as a share of the yield elongation."""


def pull(loop_share: Any, fibre: Any, stiffness: Any) -> Any:
    """Add alpha k z."""
    return loop_share * stiffness * fibre


def rates(yield_m: Any, fibre: Any, elongation_rate: Any) -> Any:
    """Give z' = x' - (|x'| z |z| + x' z^2) / (2 x_y^2)."""
    size = smooth_size(fibre, ROUNDING * yield_m)
    speed = smooth_size(elongation_rate, ROUNDING_M_PER_S)
    bent = speed * fibre * size + elongation_rate * fibre * fibre
    return elongation_rate - 0.5 * bent / (yield_m * yield_m)


EFFECT = Effect(
    name="cable_hysteresis",
    title="Bouc-Wen hysteresis of the cable",
    acts=Acts.CABLE,
    equation="T += a k z, z' = x' - (|x'| z |z| + x' z^2)/(2 x_y^2), x = Delta L",
    source="Wen, J. Eng. Mech. Div. ASCE 102 (1976) 249, n = 2",
    signature="weak odd harmonics, a loop with sharp tips, rate-independent; tan delta and "
    "stiffness depend on amplitude",
    parameters=(
        Parameter("loop_share", "1", 0.1, 0.0, 0.5, "a", magnitude=True),
        Parameter("yield_m", "m", 1e-3, 5e-5, 2e-2, "x_y"),
    ),
    states=(State("fibre", "m", "z, what the fibres hold"),),
    pull=pull,
    rates=rates,
    longest_step_s=2e-3,
    cost="|x'| is rounded over 0.1 mm/s; twice the steps",
)
