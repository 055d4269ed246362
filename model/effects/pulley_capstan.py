"""Friction in proportion to the tension: the cable is wrapped round a pulley that sticks."""

from typing import Any

from model.library.bristle import (
    BENT_AT_REST,
    BRISTLE_LOSS,
    DAHL_EXPONENT,
    ELASTIC_SHARE,
    LONGEST_STEP_S,
    bent,
    held,
    lost_over,
)
from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import smooth_positive

TAUT = 0.01
"""Over so much of the pretension it is rounded that a cable which hangs presses on nothing."""


def _level(loaded_share: Any, before_pulley: Any, pretension: Any) -> Any:
    """Where a bristle slips, over where it does at rest: one that no load makes stiffer, later."""
    return 1.0 + (1.0 - loaded_share) * (smooth_positive(before_pulley / pretension, TAUT) - 1.0)


def pull(
    friction: Any,
    wrap_rad: Any,
    growth_share: Any,
    presliding_m: Any,
    loaded_share: Any,
    bristle_loss_s: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
    before_pulley: Any,
    pretension: Any,
) -> Any:
    """T G(mu theta (h(z) + t_b z')/g), less what it holds at rest."""
    level = _level(loaded_share, before_pulley, pretension)
    turned = held(
        bristle + bent_at_rest, axial_velocity, presliding_m, level, dahl_exponent, elastic_share
    )
    rate = bent(
        bristle + bent_at_rest, axial_velocity, presliding_m, level, dahl_exponent, elastic_share
    )
    grip = friction * wrap_rad
    now = _more(grip * (turned + bristle_loss_s * rate) / level, growth_share)
    return before_pulley * now - pretension * _more(grip * bent_at_rest, growth_share)


def _more(a: Any, share: Any) -> Any:
    """G(a) by the series of exp(a), 2e-6 off at 0.3."""
    return a * (1.0 + share * a / 2.0 * (1.0 + a / 3.0 * (1.0 + a / 4.0 * (1.0 + a / 5.0))))


def rates(
    presliding_m: Any,
    loaded_share: Any,
    dahl_exponent: Any,
    elastic_share: Any,
    bent_at_rest: Any,
    bristle: Any,
    axial_velocity: Any,
    before_pulley: Any,
    pretension: Any,
) -> Any:
    """Z follows g sgn v within x_s."""
    level = _level(loaded_share, before_pulley, pretension)
    return bent(
        bristle + bent_at_rest, axial_velocity, presliding_m, level, dahl_exponent, elastic_share
    )


def steepest(
    friction: Any, wrap_rad: Any, presliding_m: Any, bristle_loss_s: Any, pretension: Any
) -> Any:
    """Give mu theta T (t_b + 0.41 t) / x_s, of a bristle that begins to slip, with room for T."""
    return 2.0 * pretension * friction * wrap_rad * lost_over(presliding_m, bristle_loss_s)


def stiffest(friction: Any, wrap_rad: Any, presliding_m: Any, pretension: Any) -> Any:
    """Give mu theta T / x_s, with the same room."""
    return 2.0 * pretension * friction * wrap_rad / presliding_m


EFFECT = Effect(
    name="pulley_capstan",
    title="capstan friction at the pulley",
    acts=Acts.PULLEY,
    equation="T += T G(mu theta (h + t_b z')/g) - T_0 G(mu theta z_0), "
    "G(a) = a + s (exp(a) - 1 - a), "
    "z' = v D/y, D = min(d, 1 - e)^a/m, m = min(1 - e, 1), "
    "d = 1 - z sgn v/g, g = l + (1 - l) T/T_0, "
    "h = w z + (1 - w) g sgn v, w = x_s/y, "
    "y = (x_s^4 + (c v t)^4)^(1/4), c t = (3 a - 2) 0.5 ms / m",
    source="Euler-Eytelwein; Johnson, Contact Mechanics (1985), Section 8.2",
    signature="step at reversal that grows with T: even harmonics, 2nd 0.85 mu theta k A; scales "
    "with the pretension",
    parameters=(
        Parameter("friction", "1", 0.03, 0.0, 0.5, "mu", magnitude=True),
        Parameter("wrap_rad", "rad", 1.5708, 0.1, 6.2832, "theta, angle of contact"),
        Parameter("presliding_m", "m", 5e-5, 5e-6, 2e-4, "x_s, the way to a reversal"),
        Parameter(
            "growth_share",
            "1",
            1.0,
            0.0,
            1.0,
            "s: 1, the tension grows along the wrap (Euler-Eytelwein); 0, friction is mu theta T",
        ),
        Parameter("loaded_share", "1", 1.0, 0.0, 1.0, "l: 1, load makes a bristle stiffer; 0: not"),
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
