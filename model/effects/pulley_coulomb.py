"""Dry friction of constant size where the cable runs over its pulley."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_sign


def pull(coulomb_n: Any, switch_m_per_s: Any, axial_velocity: Any) -> Any:
    """F_c sgn(v): the tension at the platform is higher while the cable is drawn out."""
    return coulomb_n * smooth_sign(axial_velocity, switch_m_per_s)


def steepest(coulomb_n: Any, switch_m_per_s: Any) -> Any:
    """F_c / v_s, at reversal."""
    return coulomb_n / switch_m_per_s


EFFECT = Effect(
    name="pulley_coulomb",
    title="Coulomb friction at the pulley",
    acts=Acts.PULLEY,
    equation="T += F_c v / sqrt(v^2 + v_s^2)",
    source="Coulomb (1785); Olsson et al., Eur. J. Control 4 (1998) 176, Section 2",
    signature="step at velocity reversal; odd harmonics as 1/n; quadrature 4 F_c / pi, whatever "
    "the amplitude and the frequency",
    parameters=(
        Parameter("coulomb_n", "N", 0.3, 0.0, 5.0, "F_c", magnitude=True),
        Parameter("switch_m_per_s", "m/s", 2e-3, 1e-4, 0.05, "v_s, width of the reversal"),
    ),
    pull=pull,
    steepest=steepest,
    longest_step_s=1e-3,
    cost="creeps below v_s instead of sticking; four times the steps",
)
