"""The pulley has to be turned: its inertia, and its bearing, dragged along by the cable."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter, State, elongated


def _grip(
    grip_s: Any,
    turned: Any,
    rim: Any,
    length: Any,
    rest_length: Any,
    axial_velocity: Any,
) -> Any:
    """The pull of the cable on the rim over its mass, m/s2: a spring and a damper."""
    ahead = length - rest_length - turned
    return (ahead / grip_s + 2.0 * (axial_velocity - rim)) / grip_s


def pull(
    equivalent_kg: Any,
    grip_s: Any,
    turned: Any,
    rim: Any,
    length: Any,
    rest_length: Any,
    axial_velocity: Any,
) -> Any:
    """m_p g, the force that accelerates the rim and turns its bearing."""
    return equivalent_kg * _grip(grip_s, turned, rim, length, rest_length, axial_velocity)


def rates(
    grip_s: Any,
    bearing_per_s: Any,
    turned: Any,
    rim: Any,
    length: Any,
    rest_length: Any,
    axial_velocity: Any,
) -> tuple[Any, Any]:
    """The cable gets ahead of the rim and drags it; its bearing holds it back."""
    grip = _grip(grip_s, turned, rim, length, rest_length, axial_velocity)
    return rim, grip - bearing_per_s * rim


def steepest(equivalent_kg: Any, grip_s: Any) -> Any:
    """2 m_p / tau, before the rim follows."""
    return 2.0 * equivalent_kg / grip_s


EFFECT = Effect(
    name="pulley_inertia",
    title="inertia of the pulley",
    acts=Acts.PULLEY,
    equation="T += m_p g, v_r' = g - b v_r, g = (e/tau + 2 (v - v_r))/tau, e = L - L_0 - x_r; "
    "m_p = J/r^2",
    source="Newton; a grip, critically damped, replaces the algebraic loop with the platform's "
    "acceleration and lags by 2 (w tau)^3 only",
    signature="in phase with the acceleration, -w^2: like stiffness at one frequency",
    parameters=(
        Parameter("equivalent_kg", "kg", 0.05, 0.0, 1.0, "m_p", magnitude=True),
        Parameter("grip_s", "s", 2e-3, 1e-3, 1e-2, "tau"),
        Parameter("bearing_per_s", "1/s", 0.0, 0.0, 200.0, "b: drag of the bearing over m_p"),
    ),
    states=(
        State("turned", "m", "x_r, way of the rim", rests=elongated),
        State("rim", "m/s", "v_r, its speed"),
    ),
    pull=pull,
    steepest=steepest,
    rates=rates,
    longest_step_s=2e-3,
    cost="two states a cable; twice the steps",
)
