"""Friction of a pulley: bristles that bend before they slide."""

from math import exp

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.compiled import law

Array = NDArray[np.float64]


@law
def slip_resistance(cable: Array, speed: float, tension: float) -> float:
    """The force at which the bristles slide steadily, N.

    Coulomb's with Stribeck's peak at low speed, and in proportion to the tension that presses the
    cable on the pulley (capstan): F_c + (F_s - F_c) exp(-(v/v_s)^2) + mu theta T.
    """
    peak = cable[at_.STATIC] - cable[at_.COULOMB]
    pressed = cable[at_.CAPSTAN] * max(tension, 0.0)
    force: float = cable[at_.COULOMB] + peak * exp(-((speed / cable[at_.STRIBECK]) ** 2)) + pressed
    return force


@law
def friction(cable: Array, own: Array, change: Array, speed: float, tension: float) -> float:
    """Force of the bristles, N, less what they hold at rest; writes their rate.

    Canudas de Wit et al., IEEE Trans. Automatic Control 40 (1995) 419 (LuGre): z' = v - s_0 |v|
    z / g(v), F = s_0 z + s_1 z'. Soft bristles are `pulley_presliding`, stiff ones the others.

    Parameters
    ----------
    cable
        Numbers of the cable.
    own, change
        Its states and their rates, shape (CABLE_STATES,).
    speed
        At which the cable grows longer over the pulley, m/s.
    tension
        N.
    """
    stiff = cable[at_.BRISTLE]
    resists = slip_resistance(cable, speed, tension)
    rate = speed - stiff * abs(speed) / resists * own[at_.BENT]
    change[at_.BENT] = rate
    force: float = stiff * own[at_.BENT] + cable[at_.BRISTLE_LOSS] * rate
    force -= cable[at_.FRICTION_AT_REST]
    return force
