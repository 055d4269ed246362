"""The pulley has to be turned: its inertia, and its bearing, dragged along by the cable."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State
from model.library.let_go import LET_GO


def _tone(equivalent_kg: Any, grip_s: Any, front_share: Any, stiffness: Any) -> Any:
    """Tone of the rim, 1/s: on the grip, and on the springs before and behind it."""
    give = front_share * (1.0 - front_share) * equivalent_kg / stiffness
    grip = grip_s * grip_s
    return 1.0 / np.sqrt(np.sqrt(grip * grip + give * give))


def _grip(
    equivalent_kg: Any,
    grip_s: Any,
    front_share: Any,
    damping_ratio: Any,
    turned: Any,
    rim: Any,
    elongation: Any,
    elongation_rate: Any,
    stiffness: Any,
) -> Any:
    """The pull of the cable on the rim over its mass, m/s2: a spring, and the grip's damper."""
    tone, goes = _tone(equivalent_kg, grip_s, front_share, stiffness), 1.0 - front_share
    ahead = goes * elongation - turned
    gripped = grip_s * grip_s * tone * tone
    gripped = gripped * gripped
    damper = 2.0 * damping_ratio * tone * gripped * gripped
    return tone * tone * ahead + damper * (goes * elongation_rate - rim)


def pull(
    equivalent_kg: Any,
    grip_s: Any,
    front_share: Any,
    damping_ratio: Any,
    turned: Any,
    rim: Any,
    elongation: Any,
    elongation_rate: Any,
    stiffness: Any,
) -> Any:
    """(1 - f) m_p g, of the force that accelerates the rim and turns its bearing."""
    grip = _grip(
        equivalent_kg,
        grip_s,
        front_share,
        damping_ratio,
        turned,
        rim,
        elongation,
        elongation_rate,
        stiffness,
    )
    return (1.0 - front_share) * equivalent_kg * grip


def rates(
    equivalent_kg: Any,
    grip_s: Any,
    front_share: Any,
    bearing_per_s: Any,
    damping_ratio: Any,
    turned: Any,
    rim: Any,
    elongation: Any,
    elongation_rate: Any,
    stiffness: Any,
) -> tuple[Any, Any]:
    """The cable gets ahead of the rim and drags it; its bearing holds it back."""
    grip = _grip(
        equivalent_kg,
        grip_s,
        front_share,
        damping_ratio,
        turned,
        rim,
        elongation,
        elongation_rate,
        stiffness,
    )
    return rim, grip - bearing_per_s * rim


def rests(elongation: Any, front_share: Any) -> Any:
    """The rim has gone with its part of the elongation."""
    return (1.0 - front_share) * elongation


def goes(elongation_rate: Any, front_share: Any) -> Any:
    """And with its part of the rate."""
    return (1.0 - front_share) * elongation_rate


def steepest(equivalent_kg: Any, grip_s: Any, damping_ratio: Any) -> Any:
    """2 z m_p / tau at most, before the rim follows."""
    return 2.0 * damping_ratio * equivalent_kg / grip_s


EFFECT = Effect(
    name="pulley_inertia",
    title="inertia of the pulley",
    acts=Acts.PULLEY,
    equation="T += (1-f) m_p g, v_r' = g - b v_r, g = w^2 e + 2 z w (w tau)^8 e', "
    "e = (1-f)(L - L_0) - x_r, 1/w^4 = tau^4 + (f (1-f) m_p/k)^2; m_p = J/r^2",
    source="Newton; a share f of the cable's give is before the pulley, the rest behind it. Where "
    "none is, the grip on the rim, critically damped for z = 1, replaces the algebraic loop with "
    "the platform's acceleration and lags by 2 z (w tau)^3 only",
    signature="in phase with the acceleration, -w^2: like stiffness at one frequency",
    parameters=(
        Parameter("equivalent_kg", "kg", 0.05, 0.0, 1.0, "m_p", magnitude=True),
        Parameter("grip_s", "s", 2e-3, 1e-3, 1e-2, "tau"),
        Parameter("front_share", "1", 0.0, 0.0, 0.6, "f, of the give, before the pulley"),
        Parameter("bearing_per_s", "1/s", 0.0, 0.0, 200.0, "b: drag of the bearing over m_p"),
        Parameter("damping_ratio", "1", 1.0, 0.02, 1.0, "z, of the grip"),
        LET_GO,
    ),
    states=(
        State("turned", "m", "x_r, way of the rim", rests=rests),
        State("rim", "m/s", "v_r, its speed", goes=goes),
    ),
    pull=pull,
    steepest=steepest,
    rates=rates,
    longest_step_s=2e-3,
    cost="two states a cable; twice the steps",
)
