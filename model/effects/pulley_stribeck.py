"""Dry friction that falls as sliding sets in."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_sign


def pull(
    coulomb_n: Any,
    static_ratio: Any,
    stribeck_m_per_s: Any,
    switch_m_per_s: Any,
    axial_velocity: Any,
) -> Any:
    """F_c + (F_s - F_c) / (1 + (v / v_st)^2), against the motion."""
    ratio = axial_velocity / stribeck_m_per_s
    size = coulomb_n * (1.0 + (static_ratio - 1.0) / (1.0 + ratio * ratio))
    return size * smooth_sign(axial_velocity, switch_m_per_s)


def steepest(coulomb_n: Any, static_ratio: Any, switch_m_per_s: Any) -> Any:
    """F_s / v_s, at reversal."""
    return coulomb_n * static_ratio / switch_m_per_s


EFFECT = Effect(
    name="pulley_stribeck",
    title="Stribeck friction at the pulley",
    acts=Acts.PULLEY,
    equation="T += F_c (1 + (F_s/F_c - 1) / (1 + (v/v_st)^2)) v / sqrt(v^2 + v_s^2)",
    source="Hess & Soom, J. Tribology 112 (1990) 147; Armstrong-Helouvry et al., "
    "Automatica 30 (1994) 1083",
    signature="spike at velocity reversal, negative slope after it; higher odd harmonics than "
    "Coulomb's",
    parameters=(
        Parameter("coulomb_n", "N", 0.3, 0.0, 5.0, "F_c", magnitude=True),
        Parameter("static_ratio", "1", 1.4, 1.0, 3.0, "F_s / F_c"),
        Parameter("stribeck_m_per_s", "m/s", 8e-3, 1e-3, 0.05, "v_st"),
        Parameter("switch_m_per_s", "m/s", 2e-3, 1e-4, 0.05, "v_s, width of the reversal"),
    ),
    pull=pull,
    steepest=steepest,
    longest_step_s=1e-3,
    cost="creeps below v_s instead of sticking; four times the steps",
)
