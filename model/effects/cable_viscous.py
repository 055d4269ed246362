"""Damping of the cable along itself (Kelvin-Voigt), a spring in series with the dashpot or none."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State, elongated
from model.library.let_go import LET_GO

SHORTEST_S = 8e-4
"""A spring that answers sooner is this one, less of it: the same to first order, and a step can
follow it."""

NONE_PER_S = 1e12
"""A spring that answers sooner than one over this is none: the dashpot's state stays behind."""


def pull(
    viscous_n_s_per_m: Any, series_s: Any, dashpot: Any, elongation: Any, elongation_rate: Any
) -> Any:
    """Add c (w (Delta L - q)/tau_e + (1 - w) Delta L'), tau_e w = tau."""
    per_s = 1.0 / _larger(series_s, SHORTEST_S)
    through = (elongation - dashpot) * per_s
    return viscous_n_s_per_m * (elongation_rate + series_s * per_s * (through - elongation_rate))


def rates(series_s: Any, dashpot: Any, elongation: Any) -> Any:
    """Give q' = (Delta L - q)/tau_e, where there is a spring."""
    there = 1.0 - _larger(1.0 - NONE_PER_S * series_s, 0.0)
    return there * (elongation - dashpot) * (1.0 / _larger(series_s, SHORTEST_S))


def _larger(one: Any, other: Any) -> Any:
    """The larger of two."""
    return 0.5 * (one + other + abs(one - other))


def steepest(viscous_n_s_per_m: Any) -> Any:
    """It is c."""
    return viscous_n_s_per_m


def longest_step_s(series_s: Any) -> Any:
    """Two and a half times as long as a spring takes; where there is none, any."""
    return np.where(np.asarray(series_s) > 0.0, 2.5 * _larger(series_s, SHORTEST_S), np.inf)


EFFECT = Effect(
    name="cable_viscous",
    title="Kelvin-Voigt damping of the cable",
    acts=Acts.CABLE,
    equation="T += c Delta L'; with a spring c / tau in series: T += (c / tau)(Delta L - q), "
    "q' = (Delta L - q)/tau",
    source="Kelvin-Voigt, Maxwell; Findley, Lai & Onaran, Creep and Relaxation (1976), "
    "Sections 5.2 and 5.3",
    signature="quadrature in proportion to the frequency, no harmonics; a late camera looks the "
    "same but dissipates nothing",
    parameters=(
        Parameter("viscous_n_s_per_m", "N s/m", 4.0, 0.0, 60.0, "c", magnitude=True),
        Parameter("series_s", "s", 0.0, 0.0, 0.01, "tau, of the spring in series; 0: rigid"),
        LET_GO,
    ),
    states=(State("dashpot", "m", "q, elongation of the dashpot", rests=elongated),),
    pull=pull,
    rates=rates,
    steepest=steepest,
    longest_step_s=longest_step_s,
    cost="as long as without it; with a spring in series, 2.5 times as long as that takes",
)
