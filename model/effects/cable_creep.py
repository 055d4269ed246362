"""Creep and settling under load: the cable goes on getting longer."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State

DECADE = 10.0
"""The second branch is this much slower."""


def pull(
    creep_share: Any, log_share: Any, early: Any, late: Any, logged: Any, stiffness: Any
) -> Any:
    """-a k c, in units of the elastic elongation: c_l, or that of two branches."""
    branches = 0.5 * (early + late)
    return -creep_share * stiffness * (branches + log_share * (logged - branches))


def rates(
    creep_s: Any, early: Any, late: Any, age: Any, tension: Any, stiffness: Any
) -> tuple[Any, ...]:
    """c_j' = (T / k - c_j) / tau_j; c_l' = T / k / (tau + t)."""
    elastic_m = tension / stiffness
    return (
        (elastic_m - early) / creep_s,
        (elastic_m - late) / (DECADE * creep_s),
        elastic_m / (creep_s + age),
        1.0 + 0.0 * elastic_m,
    )


EFFECT = Effect(
    name="cable_creep",
    title="creep of the cable",
    acts=Acts.CABLE,
    equation="T -= a k [l c_l + (1 - l) (c_1 + c_2)/2], c_l' = T/k/(tau + t), "
    "c_j' = (T/k - c_j)/tau_j, tau_1 = tau, tau_2 = 10 tau",
    source="Findley, Lai & Onaran, Creep and Relaxation (1976): ln(1 + t/tau) under a constant "
    "load, or two Voigt units (Section 5.6)",
    signature="monotone drift of the mean tension, as in log time",
    parameters=(
        Parameter(
            "creep_share", "1", 0.01, 0.0, 0.2, "a, creep over elastic elongation", magnitude=True
        ),
        Parameter("creep_s", "s", 10.0, 0.2, 2000.0, "tau"),
        Parameter("log_share", "1", 1.0, 0.0, 1.0, "l: 1 goes with ln t, 0 settles", False),
    ),
    states=(
        State("early", "m", "c_1, elastic elongation as creep has followed it"),
        State("late", "m", "c_2"),
        State("logged", "m", "c_l"),
        State("age", "s", "t, since the run begins"),
    ),
    pull=pull,
    rates=rates,
)
