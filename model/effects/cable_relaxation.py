"""A spring behind a dashpot beside the cable's own (standard linear solid)."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State, elongated


def pull(branch_share: Any, dashpot: Any, elongation: Any, stiffness: Any) -> Any:
    """k_1 (Delta L - q)."""
    return branch_share * stiffness * (elongation - dashpot)


def rates(relaxation_s: Any, dashpot: Any, elongation: Any) -> Any:
    """Give q' = (Delta L - q) / tau."""
    return (elongation - dashpot) / relaxation_s


EFFECT = Effect(
    name="cable_relaxation",
    title="relaxation of the cable (standard linear solid)",
    acts=Acts.CABLE,
    equation="T += k_1 (Delta L - q), q' = (Delta L - q)/tau",
    source="Zener, Elasticity and Anelasticity of Metals (1948), Section 5",
    signature="loss peak at 1/tau, stiffness that rises with frequency; a step relaxes",
    parameters=(
        Parameter("branch_share", "1", 0.1, 0.0, 0.5, "k_1 / k", magnitude=True),
        Parameter("relaxation_s", "s", 0.05, 5e-3, 100.0, "tau"),
    ),
    states=(State("dashpot", "m", "q, elongation of the dashpot", rests=elongated),),
    pull=pull,
    rates=rates,
)
