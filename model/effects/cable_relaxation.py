"""A spring behind a dashpot beside the cable's own (standard linear solid), or two of them."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State, elongated
from model.library.let_go import LET_GO


def pull(branch_share: Any, quick: Any, slow: Any, elongation: Any, stiffness: Any) -> Any:
    """k_1/2 (Delta L - q_1) + k_1/2 (Delta L - q_2)."""
    return branch_share * stiffness * (elongation - 0.5 * (quick + slow))


def rates(relaxation_s: Any, branch_ratio: Any, quick: Any, slow: Any, elongation: Any) -> Any:
    """q_j' = (Delta L - q_j) / tau_j."""
    apart = np.sqrt(branch_ratio)
    return (
        (elongation - quick) * apart / relaxation_s,
        (elongation - slow) / (apart * relaxation_s),
    )


EFFECT = Effect(
    name="cable_relaxation",
    title="relaxation of the cable (standard linear solid)",
    acts=Acts.CABLE,
    equation="T += k_1 (Delta L - (q_1 + q_2)/2), q_j' = (Delta L - q_j)/tau_j, "
    "tau_1 = tau / sqrt R, tau_2 = tau sqrt R",
    source="Zener, Elasticity and Anelasticity of Metals (1948), Section 5; two branches: Bland, "
    "Linear Viscoelasticity (1960)",
    signature="loss peak at 1/tau, stiffness that rises with frequency; a step relaxes",
    parameters=(
        Parameter("branch_share", "1", 0.1, 0.0, 0.5, "k_1 / k", magnitude=True),
        Parameter("relaxation_s", "s", 0.05, 5e-3, 100.0, "tau"),
        Parameter("branch_ratio", "1", 1.0, 1.0, 30.0, "R, of the slower time to the quicker one"),
        LET_GO,
    ),
    states=(
        State("quick", "m", "q_1, elongation of the quicker dashpot", rests=elongated),
        State("slow", "m", "q_2, elongation of the slower dashpot", rests=elongated),
    ),
    pull=pull,
    rates=rates,
)
