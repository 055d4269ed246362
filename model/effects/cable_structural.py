"""Loss that does not depend on frequency (structural damping), by five Maxwell branches."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State, elongated

HIGHEST_HZ, RATIO = 125.0, 5.0
"""The branches relax at 0.2, 1, 5, 25 and 125 Hz: the platform's tones are among them."""

ENDS = 1.03
"""Makes up for the branches that an endless row would have below 0.2 and above 125 Hz."""

SPACING = ENDS * 2.0 / float(np.pi)
"""Stiffness of each branch for a unit loss, over ln R: the sum of w tau / (1 + w^2 tau^2) is
pi / (2 ln R)."""

A_DECADE = 2.0 * float(np.log(10.0)) / float(np.pi)
"""Stiffness that the loss of a decade of frequencies adds above it, for a unit loss (Kramers and
Kronig's relation)."""

TURN = 2.0 * float(np.pi)


def pull(
    loss_factor: Any,
    decades_below: Any,
    branch_ratio: Any,
    q1: Any,
    q2: Any,
    q3: Any,
    q4: Any,
    q5: Any,
    elongation: Any,
    stiffness: Any,
) -> Any:
    """Sum of k_1 (Delta L - q_j), and what loss below the branches adds to the stiffness."""
    branches = SPACING * np.log(branch_ratio) * (5.0 * elongation - q1 - q2 - q3 - q4 - q5)
    return loss_factor * stiffness * (branches + A_DECADE * decades_below * elongation)


def rates(
    branch_ratio: Any,
    highest_hz: Any,
    q1: Any,
    q2: Any,
    q3: Any,
    q4: Any,
    q5: Any,
    elongation: Any,
) -> Any:
    """q_j' = (Delta L - q_j) / tau_j."""
    turn, slower = TURN * highest_hz, 1.0 / branch_ratio
    return (
        turn * slower**4 * (elongation - q1),
        turn * slower**3 * (elongation - q2),
        turn * slower**2 * (elongation - q3),
        turn * slower * (elongation - q4),
        turn * (elongation - q5),
    )


EFFECT = Effect(
    name="cable_structural",
    title="structural damping of the cable",
    acts=Acts.CABLE,
    equation="T += k eta (H[Delta L] + (2/pi) ln(10) D Delta L); H by five Maxwell branches at "
    "f_h, f_h / R to f_h / R^4",
    source="Crandall, J. Sound Vib. 11 (1970) 3 (a causal law); branches: Bland, Linear "
    "Viscoelasticity (1960)",
    signature="quadrature constant over frequency (within 8 % from 0.5 to 40 Hz) and in "
    "proportion to amplitude; like Kelvin-Voigt at one frequency",
    parameters=(
        Parameter("loss_factor", "1", 0.03, 0.0, 0.2, "eta", magnitude=True),
        Parameter("decades_below", "1", 0.0, -2.0, 2.0, "D, of loss below the branches"),
        Parameter("branch_ratio", "1", RATIO, 2.5, 12.0, "R, of a branch to the next slower one"),
        Parameter("highest_hz", "Hz", HIGHEST_HZ, 5.0, 125.0, "f_h, of the quickest branch"),
    ),
    states=tuple(
        State(f"q{j}", "m", f"elongation of dashpot {j}", rests=elongated) for j in range(1, 6)
    ),
    pull=pull,
    rates=rates,
    longest_step_s=3.1e-3,
    cost="a branch at 125 Hz; five states a cable",
)
