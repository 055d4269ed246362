"""Creep and settling under load: the cable goes on getting longer."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State

DECADE = 10.0
"""The second branch is this much slower."""


def pull(creep_share: Any, early: Any, late: Any, stiffness: Any) -> Any:
    """-k (c_1 + c_2), in units of the elastic elongation."""
    return -0.5 * creep_share * stiffness * (early + late)


def rates(creep_s: Any, early: Any, late: Any, tension: Any, stiffness: Any) -> Any:
    """c_j' = (T / k - c_j) / tau_j."""
    elastic_m = tension / stiffness
    return (elastic_m - early) / creep_s, (elastic_m - late) / (DECADE * creep_s)


EFFECT = Effect(
    name="cable_creep",
    title="creep of the cable",
    acts=Acts.CABLE,
    equation="T -= a k (c_1 + c_2)/2, c_j' = (T/k - c_j)/tau_j, tau_2 = 10 tau_1",
    source="Findley, Lai & Onaran, Creep and Relaxation (1976), Section 5.6 (two Voigt units)",
    signature="monotone drift of the mean tension, as in log time",
    parameters=(
        Parameter(
            "creep_share", "1", 0.01, 0.0, 0.2, "a, creep over elastic elongation", magnitude=True
        ),
        Parameter("creep_s", "s", 10.0, 0.5, 2000.0, "tau_1"),
    ),
    states=(
        State("early", "m", "c_1, elastic elongation as creep has followed it"),
        State("late", "m", "c_2"),
    ),
    pull=pull,
    rates=rates,
)
