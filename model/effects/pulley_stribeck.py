"""Dry friction that falls as sliding sets in."""

from dataclasses import replace
from typing import Any

from model.library.bristle import (
    BENT_AT_REST,
    BRISTLE_LOSS,
    DAHL_EXPONENT,
    ELASTIC_SHARE,
    LONGEST_STEP_S,
    bent,
    held,
    steepest,
    stiffest,
)
from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import gaussian


def rates(
    static_ratio: Any,
    stribeck_m_per_s: Any,
    tail_share: Any,
    presliding_m: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
) -> Any:
    """Z follows g(v) sgn v, g = 1 + (F_s/F_c - 1) ((1 - q) exp(-u^2) + q/(1 + u^2)), u = v/v_st."""
    level = _level(static_ratio, stribeck_m_per_s, tail_share, axial_velocity)
    whole = bristle + static_ratio * bent_at_rest
    return bent(whole, axial_velocity, presliding_m, level, dahl_exponent, elastic_share)


def _level(static_ratio: Any, stribeck_m_per_s: Any, tail_share: Any, axial_velocity: Any) -> Any:
    """g: F_s / F_c where the cable all but stands, 1 where it slips."""
    times = axial_velocity / stribeck_m_per_s
    falls = (1.0 - tail_share) * gaussian(times) + tail_share / (1.0 + times * times)
    return 1.0 + (static_ratio - 1.0) * falls


def pull(
    coulomb_n: Any,
    static_ratio: Any,
    stribeck_m_per_s: Any,
    tail_share: Any,
    presliding_m: Any,
    bristle_loss_s: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
) -> Any:
    """F_c (h(z) - z_0 F_s / F_c + t_b z'), z up to F_s / F_c."""
    rate = rates(
        static_ratio,
        stribeck_m_per_s,
        tail_share,
        presliding_m,
        dahl_exponent,
        elastic_share,
        bent_at_rest,
        bristle,
        axial_velocity,
    )
    level = _level(static_ratio, stribeck_m_per_s, tail_share, axial_velocity)
    left = static_ratio * bent_at_rest
    now = held(bristle + left, axial_velocity, presliding_m, level, dahl_exponent, elastic_share)
    return coulomb_n * (now - left + bristle_loss_s * rate)


EFFECT = Effect(
    name="pulley_stribeck",
    title="Stribeck friction at the pulley",
    acts=Acts.PULLEY,
    equation="T += F_c (h - z_0 F_s/F_c + t_b z'), z' = v D/y, "
    "D = min(d, 1 - e)^a/m, m = min(1 - e, 1), "
    "d = 1 - z sgn v/g, "
    "g = 1 + (F_s/F_c - 1) ((1 - q) exp(-u^2) + q/(1 + u^2)), u = v/v_st, "
    "h = w z + (1 - w) g sgn v, w = x_s/y, "
    "y = (x_s^4 + (c v t)^4)^(1/4), c t = (3 a - 2) 0.5 ms / m",
    source="Canudas de Wit et al., IEEE TAC 40 (1995) 419; Armstrong-Helouvry et al., "
    "Automatica 30 (1994) 1083; the tail: Hess & Soom, J. Tribol. 112 (1990) 147",
    signature="spike at velocity reversal, negative slope after it; higher odd harmonics than "
    "Coulomb's",
    parameters=(
        Parameter("coulomb_n", "N", 0.3, 0.0, 5.0, "F_c", magnitude=True),
        Parameter("static_ratio", "1", 1.4, 1.0, 3.0, "F_s / F_c"),
        Parameter("stribeck_m_per_s", "m/s", 8e-3, 1e-3, 0.05, "v_st"),
        Parameter("tail_share", "1", 0.0, 0.0, 1.0, "q: 0, falls as a gaussian; 1: as 1/(1 + u^2)"),
        Parameter("presliding_m", "m", 5e-5, 5e-6, 2e-4, "x_s, the way to a reversal"),
        BRISTLE_LOSS,
        DAHL_EXPONENT,
        ELASTIC_SHARE,
        replace(
            BENT_AT_REST,
            meaning="z_0: at rest z is F_s / F_c of it; what it holds there is pretension",
        ),
    ),
    states=(State("bristle", "1", "z - z_0 F_s/F_c, the bent bristle from where it rests"),),
    pull=pull,
    steepest=steepest,
    stiffest=stiffest,
    rates=rates,
    longest_step_s=LONGEST_STEP_S,
    cost="a bristle turns over within 0.5 ms at the least; twice the steps",
)
