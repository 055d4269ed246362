"""Friction that bends before it slips, the cable elastic on both sides of the pulley."""

from typing import Any

from model.library.bristle import (
    BENT_AT_REST,
    BRISTLE_LOSS,
    DAHL_EXPONENT,
    ELASTIC_SHARE,
    bent,
    gives,
    steepest,
    stiffest,
)
from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import smooth_sign

ROUNDING_M_PER_S = 1e-4
"""Width over which sgn v is rounded."""


def rates(
    coulomb_n: Any,
    presliding_m: Any,
    far_share: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
    stiffness: Any,
) -> Any:
    """Give z' = s' D / x_s, with s' the share of v that reaches the slider."""
    z = bristle + bent_at_rest
    toward = 1.0 - z * smooth_sign(axial_velocity, ROUNDING_M_PER_S)
    toward = gives(toward, dahl_exponent, elastic_share)
    held = coulomb_n * far_share * (1.0 - far_share) * toward / (presliding_m * stiffness)
    slip = far_share * axial_velocity / (1.0 + held)
    return bent(z, slip, presliding_m, 1.0, dahl_exponent, elastic_share)


def behind(
    coulomb_n: Any,
    presliding_m: Any,
    far_share: Any,
    bristle_loss_s: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
    stiffness: Any,
) -> Any:
    """F_c (z - z_0 + t_b z'): the whole of it stands between the two sides of the pulley."""
    rate = rates(
        coulomb_n,
        presliding_m,
        far_share,
        dahl_exponent,
        elastic_share,
        bent_at_rest,
        bristle,
        axial_velocity,
        stiffness,
    )
    return coulomb_n * (bristle + bristle_loss_s * rate)


def pull(
    coulomb_n: Any,
    presliding_m: Any,
    far_share: Any,
    bristle_loss_s: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
    stiffness: Any,
) -> Any:
    """That times k_span / (k_span + k_far): all of it where all the give is beyond the pulley."""
    return far_share * behind(
        coulomb_n,
        presliding_m,
        far_share,
        bristle_loss_s,
        dahl_exponent,
        elastic_share,
        bent_at_rest,
        bristle,
        axial_velocity,
        stiffness,
    )


EFFECT = Effect(
    name="pulley_presliding",
    title="presliding friction at the pulley, cable elastic on both sides",
    acts=Acts.PULLEY,
    equation="T += r F_c (z - z_0 + t_b z'), z' = s' D/y, "
    "D = min(d, 1 - e)^a/m, m = min(1 - e, 1), d = 1 - z sgn v, s' = r v / "
    "(1 + F_c r (1-r) D/(k x_s)); r = k/k_far, 1/k = 1/k_span + 1/k_far, "
    "y = (x_s^4 + (c s' t)^4)^(1/4), c t = (3 a - 2) 0.5 ms / m",
    source="Dahl, Aerospace Corp. TOR-0158 (1968); Canudas de Wit et al., IEEE TAC 40 (1995) 419",
    signature="rounded reversal; a loop at small amplitude; below x_s it looks like stiffness",
    parameters=(
        Parameter("coulomb_n", "N", 0.3, 0.0, 5.0, "F_c", magnitude=True),
        Parameter("presliding_m", "m", 6e-4, 2e-4, 5e-3, "x_s"),
        Parameter("far_share", "1", 1.0, 0.05, 1.0, "r: the give beyond the pulley, of all"),
        BRISTLE_LOSS,
        DAHL_EXPONENT,
        ELASTIC_SHARE,
        BENT_AT_REST,
    ),
    states=(State("bristle", "1", "z - z_0, the bent bristle from where it rests"),),
    pull=pull,
    behind=behind,
    rates=rates,
    steepest=steepest,
    stiffest=stiffest,
    longest_step_s=2e-3,
    cost="a bristle that is short and loses much needs steps to suit",
)
