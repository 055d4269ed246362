"""Loss that does not depend on frequency (structural damping), by five Maxwell branches."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State, elongated
from model.library.let_go import LET_GO

HIGHEST_HZ, RATIO = 125.0, 5.0
"""The branches relax at 0.2, 1, 5, 25 and 125 Hz: the platform's tones are among them."""

LOG_RATIO = float(np.log(RATIO))

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
    branches = SPACING * _log_ratio(branch_ratio) * (5.0 * elongation - q1 - q2 - q3 - q4 - q5)
    return loss_factor * stiffness * (branches + A_DECADE * decades_below * elongation)


def _log_ratio(ratio: Any) -> Any:
    """Give ln R = ln 5 + 2 artanh[(R - 5)/(R + 5)], to 3e-7 from 2.5 to 12: no C library."""
    part = (ratio - RATIO) / (ratio + RATIO)
    square = part * part
    series = 1.0 / 13.0
    for power in (11.0, 9.0, 7.0, 5.0, 3.0, 1.0):
        series = 1.0 / power + square * series
    return LOG_RATIO + 2.0 * part * series


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
    slower, fastest = 1.0 / branch_ratio, TURN * highest_hz
    fourth = slower * fastest
    third = slower * fourth
    second = slower * third
    return (
        slower * second * (elongation - q1),
        second * (elongation - q2),
        third * (elongation - q3),
        fourth * (elongation - q4),
        fastest * (elongation - q5),
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
        Parameter("decades_below", "1", 0.0, -4.0, 2.0, "D, of loss below the branches"),
        Parameter("branch_ratio", "1", RATIO, 2.5, 12.0, "R, of a branch to the next slower one"),
        Parameter("highest_hz", "Hz", HIGHEST_HZ, 5.0, 125.0, "f_h, of the quickest branch"),
        LET_GO,
    ),
    states=tuple(
        State(f"q{j}", "m", f"elongation of dashpot {j}", rests=elongated) for j in range(1, 6)
    ),
    pull=pull,
    rates=rates,
    longest_step_s=3.1e-3,
    cost="a branch at 125 Hz; five states a cable",
)
