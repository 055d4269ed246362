"""Friction of a cable on its pulley: LuGre bristles, constant, Stribeck or in proportion to load.

Canudas de Wit, Olsson, Astrom & Lischinsky, IEEE Trans. Autom. Control 40 (1995) 419.
"""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.compiled import law

Array = NDArray[np.float64]

BRISTLE_LOSS_S = 1e-3
"""sigma_1 / sigma_0: how long a bristle takes to come to rest, s."""


@law
def friction(p: Array, s: Array, speed: float, tension: float, step_s: float) -> float:
    """Force of both kinds of bristles, N; positive where the cable lengthens.

    Parameters
    ----------
    p, s
        Numbers and states of the cable.
    speed
        At which the path lengthens, m/s.
    tension
        Behind the pulley, N.
    step_s
        Step, s.
    """
    force = 0.0
    if p[at.COULOMB] > 0.0:
        force += _bristles(p, s, speed, step_s)
    if p[at.CAPSTAN] > 0.0:
        force += _wrapped(p, s, speed, tension, step_s)
    return force


@law
def _bristles(p: Array, s: Array, speed: float, step_s: float) -> float:
    """Z' = v - sigma_0 |v| z / g(v), F = sigma_0 z + sigma_1 z', g Stribeck's curve."""
    stiff = p[at.COULOMB] / p[at.BRISTLE]
    ratio = speed / p[at.STRIBECK]
    level = p[at.COULOMB] + (p[at.STATIC] - p[at.COULOMB]) * np.exp(-ratio * ratio)
    bent = s[at.BENT]
    # Exact for a constant speed, so that no step is too long.
    left = np.exp(-stiff * np.abs(speed) * step_s / level)
    goal = np.sign(speed) * level / stiff
    new = goal + (bent - goal) * left
    s[at.BENT] = new
    force: float = stiff * (new + BRISTLE_LOSS_S * (new - bent) / step_s)
    return force


@law
def _wrapped(p: Array, s: Array, speed: float, tension: float, step_s: float) -> float:
    """T (exp(mu theta z) - 1): Euler and Eytelwein, mobilised by bristles, |z| <= 1."""
    bent = s[at.BENT_CAPSTAN]
    left = np.exp(-np.abs(speed) * step_s / p[at.CAPSTAN_BRISTLE])
    goal = np.sign(speed)
    new = goal + (bent - goal) * left
    s[at.BENT_CAPSTAN] = new
    force: float = tension * (np.exp(p[at.CAPSTAN] * new) - 1.0)
    return force
