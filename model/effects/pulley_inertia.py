"""The pulley has to be turned: its inertia, dragged along by the cable."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State


def _gain(grip_s: Any, ahead: Any, rim: Any, axial_velocity: Any) -> Any:
    """v_r', m/s2: what the cable's grip, a spring and a critical damper, does to the rim."""
    return (ahead / grip_s + 2.0 * (axial_velocity - rim)) / grip_s


def pull(equivalent_kg: Any, grip_s: Any, ahead: Any, rim: Any, axial_velocity: Any) -> Any:
    """m_p v_r', the force that accelerates the rim."""
    return equivalent_kg * _gain(grip_s, ahead, rim, axial_velocity)


def rates(grip_s: Any, ahead: Any, rim: Any, axial_velocity: Any) -> tuple[Any, Any]:
    """The cable gets ahead of the rim and drags it."""
    return axial_velocity - rim, _gain(grip_s, ahead, rim, axial_velocity)


def steepest(equivalent_kg: Any, grip_s: Any) -> Any:
    """2 m_p / tau, before the rim follows."""
    return 2.0 * equivalent_kg / grip_s


EFFECT = Effect(
    name="pulley_inertia",
    title="inertia of the pulley",
    acts=Acts.PULLEY,
    equation="T += m_p v_r', v_r' = (e/tau + 2 (v - v_r))/tau, e' = v - v_r; m_p = J/r^2",
    source="Newton; a grip, critically damped, replaces the algebraic loop with the platform's "
    "acceleration and lags by 2 (w tau)^3 only",
    signature="in phase with the acceleration, -w^2: like stiffness at one frequency",
    parameters=(
        Parameter("equivalent_kg", "kg", 0.05, 0.0, 0.3, "m_p", magnitude=True),
        Parameter("grip_s", "s", 2e-3, 1e-3, 1e-2, "tau"),
    ),
    states=(
        State("ahead", "m", "e, how far the cable is ahead of the rim"),
        State("rim", "m/s", "v_r, speed of the rim"),
    ),
    pull=pull,
    steepest=steepest,
    rates=rates,
    longest_step_s=2e-3,
    cost="two states a cable; twice the steps",
)
