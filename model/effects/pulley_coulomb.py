"""Dry friction of constant size where the cable runs over its pulley."""

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


def pull(
    coulomb_n: Any,
    presliding_m: Any,
    bristle_loss_s: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
) -> Any:
    """F_c (h(z) - z_0 + t_b z'): the tension at the platform is higher while the cable is drawn."""
    rate = rates(presliding_m, dahl_exponent, elastic_share, bent_at_rest, bristle, axial_velocity)
    now = held(
        bristle + bent_at_rest, axial_velocity, presliding_m, 1.0, dahl_exponent, elastic_share
    )
    return coulomb_n * (now - bent_at_rest + bristle_loss_s * rate)


def rates(
    presliding_m: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
) -> Any:
    """Z follows sgn v within x_s."""
    return bent(
        bristle + bent_at_rest, axial_velocity, presliding_m, 1.0, dahl_exponent, elastic_share
    )


EFFECT = Effect(
    name="pulley_coulomb",
    title="Coulomb friction at the pulley",
    acts=Acts.PULLEY,
    equation="T += F_c (h - z_0 + t_b z'), z' = v D/y, D = min(d, 1 - e)^a/m, m = min(1 - e, 1), "
    "d = 1 - z sgn v, h = w z + (1 - w) sgn v, w = x_s/y, "
    "y = (x_s^4 + (c v t)^4)^(1/4), c t = (3 a - 2) 0.5 ms / m",
    source="Coulomb (1785); sticks as by Canudas de Wit et al., IEEE TAC 40 (1995) 419; Olsson et "
    "al., Eur. J. Control 4 (1998) 176",
    signature="step at velocity reversal; odd harmonics as 1/n; quadrature 4 F_c / pi, whatever "
    "the amplitude and the frequency",
    parameters=(
        Parameter("coulomb_n", "N", 0.3, 0.0, 5.0, "F_c", magnitude=True),
        Parameter("presliding_m", "m", 5e-5, 5e-6, 2e-4, "x_s, the way to a reversal"),
        BRISTLE_LOSS,
        DAHL_EXPONENT,
        ELASTIC_SHARE,
        BENT_AT_REST,
    ),
    states=(State("bristle", "1", "z - z_0, the bent bristle from where it rests"),),
    pull=pull,
    steepest=steepest,
    stiffest=stiffest,
    rates=rates,
    longest_step_s=LONGEST_STEP_S,
    cost="a bristle turns over within 0.5 ms at the least; twice the steps",
)
