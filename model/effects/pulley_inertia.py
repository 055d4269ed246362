"""The pulley has to be turned: its inertia, carried along by the cable."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State


def pull(equivalent_kg: Any, coupling_s: Any, rim: Any, axial_velocity: Any) -> Any:
    """m_p v_rim', the force that accelerates the rim."""
    return equivalent_kg * (axial_velocity - rim) / coupling_s


def rates(coupling_s: Any, rim: Any, axial_velocity: Any) -> Any:
    """The rim follows the cable within tau."""
    return (axial_velocity - rim) / coupling_s


def steepest(equivalent_kg: Any, coupling_s: Any) -> Any:
    """m_p / tau, before the rim follows."""
    return equivalent_kg / coupling_s


EFFECT = Effect(
    name="pulley_inertia",
    title="inertia of the pulley",
    acts=Acts.PULLEY,
    equation="T += m_p v_r', v_r' = (v - v_r)/tau; m_p = J/r^2",
    source="Newton; the coupling tau replaces the algebraic loop with the platform's acceleration",
    signature="in phase with the acceleration, -w^2: like stiffness at one frequency",
    parameters=(
        Parameter("equivalent_kg", "kg", 0.05, 0.0, 0.3, "m_p", magnitude=True),
        Parameter("coupling_s", "s", 3e-3, 2e-3, 2e-2, "tau"),
    ),
    states=(State("rim", "m/s", "v_r, speed of the rim"),),
    pull=pull,
    steepest=steepest,
    rates=rates,
    longest_step_s=2e-3,
    cost="a loss of w tau beside the inertia; twice the steps",
)
