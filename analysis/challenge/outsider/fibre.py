"""What the fibres of a cable do beyond a spring: they stiffen, relax, lag, creep and have play."""

from math import exp, log

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.compiled import law

Array = NDArray[np.float64]

CREEP_FROM_S = 2.0
"""Creep goes with ln(1 + t / this); t is the run's own time."""

EDGE = 1.0 / 20.0
"""Share of the half clearance over which its ends are rounded."""

OFF_CENTRE = 0.3
"""Share of the half clearance by which the middle of the play is off the rest tension."""

LOOP_CLOSING = 0.55
LOOP_OPENING = 0.45
"""Bouc-Wen's gamma and beta; their sum is 1, so that z saturates at the yield."""

FIRST_YIELD, NEXT_YIELD = 0.15, 0.425
"""Yields of the sliders, in shares of the whole: 0.15 to 1.85 in five steps."""

BEND = 12
"""Power that rounds the corner of a slider."""

SHALLOWEST_N = 0.3
"""A sagging cable's tension is not sought below this, N."""

NEWTON_STEPS = 12
NEWTON_STOP_N = 1e-12
LONGEST_STEP = 0.7
"""Newton's steps go at most this share of the tension down."""


@law
def softplus(x: float) -> float:
    """ln(1 + e^x), without overflow."""
    found: float = max(x, 0.0) + np.log1p(exp(-abs(x)))
    return found


@law
def rounded_gap(elongation: float, half: float, edge: float) -> float:
    """A dead zone of 2 x `half` with rounded ends: elongation less the clearance, m."""
    above, below = softplus((elongation - half) / edge), softplus((-elongation - half) / edge)
    left: float = edge * (above - below)
    return left


@law
def after_play(cable: Array, elongation: float) -> float:
    """Elongation left to the cable behind a clearance in series: `anchor_play`.

    Closed elastically at both ends, so it costs no energy; a plateau of the tension near rest.
    """
    half = cable[at_.PLAY]
    centre = -OFF_CENTRE * half
    edge = EDGE * half
    left: float = rounded_gap(elongation - centre, half, edge) - rounded_gap(-centre, half, edge)
    return left


@law
def crept(cable: Array, time_s: float) -> float:
    """Lasting elongation, m: `cable_creep`, logarithmic in time (Findley, Creep and Relaxation)."""
    found: float = cable[at_.CREEP] * log(1.0 + time_s / CREEP_FROM_S) if time_s > 0.0 else 0.0
    return found


@law
def stiffened(cable: Array, stiffness: float, elongation: float) -> float:
    """Tension of `cable_stiffening`, dT/dx = k (1 + beta (T - T_0) / T_0), solved for T, N."""
    rest, beta = cable[at_.PRETENSION], cable[at_.STIFFENING]
    tension: float = rest + rest / beta * (exp(beta * stiffness * elongation / rest) - 1.0)
    return tension


@law
def loop_rate(cable: Array, stretch: float, speed: float) -> float:
    """Rate of Bouc and Wen's z (J. Eng. Mech. 102 (1976) 249), limited by the yield, m/s."""
    filled = abs(stretch) / cable[at_.LOOP_YIELD]
    closing = 1.0 if speed * stretch > 0.0 else -1.0
    slope = LOOP_CLOSING + LOOP_OPENING * closing
    rate: float = speed * (1.0 - filled ** cable[at_.LOOP_POWER] * slope)
    return rate


@law
def slider_rate(cable: Array, number: int, stretch: float, speed: float) -> float:
    """Rate of a spring whose slider gives way at its yield (Iwan, J. Appl. Mech. 33 (1966) 893)."""
    limit = cable[at_.SLIDING_YIELD] * (FIRST_YIELD + NEXT_YIELD * number)
    if speed * stretch <= 0.0:
        return speed
    rate: float = speed * (1.0 - min(abs(stretch / limit), 1.0) ** BEND)
    return rate


@law
def hysteretic(
    cable: Array, own: Array, change: Array, stiffness: float, elongation: float, speed: float
) -> float:
    """Tension of a spring, a share of which is hysteretic, N; writes the rates of that share."""
    if cable[at_.LOOP] > 0.0:
        share = cable[at_.LOOP]
        stretch = own[at_.LOOPED]
        change[at_.LOOPED] = loop_rate(cable, stretch, speed)
        held = (1.0 - share) * elongation + share * stretch
        whole: float = cable[at_.PRETENSION] + stiffness * held
        return whole
    share = cable[at_.SLIDING]
    tension: float = cable[at_.PRETENSION] + stiffness * (1.0 - share) * elongation
    for j in range(at_.BRANCHES):
        stretch = own[at_.SLID + j]
        change[at_.SLID + j] = slider_rate(cable, j, stretch, speed)
        tension += stiffness * share / at_.BRANCHES * stretch
    return tension


@law
def relaxing(cable: Array, own: Array, change: Array, speed: float) -> float:
    """Force of the Maxwell branches beside the spring, N; writes their rates.

    k_j q_j with q_j' = v - q_j / tau_j (Findley, section 5.6): `cable_relaxation`, and in a ladder
    of decades `cable_structural`.
    """
    force = 0.0
    for j in range(at_.BRANCHES):
        stiffness = cable[at_.MAXWELL + j]
        if stiffness > 0.0:
            stretch = own[at_.BRANCH + j]
            force += stiffness * stretch
            change[at_.BRANCH + j] = speed - stretch / cable[at_.MAXWELL_TIME + j]
    return force


@law
def sagging(cable: Array, stiffness: float, tension: float, length: float) -> float:
    """Tension of a cable that hangs as an elastic parabola, N: `cable_sag`.

    T = T_straight + k (S(T, L) - S(T_0, L_0)) with S = w^2 L^3 / (24 T^2) (Irvine, Cable
    Structures, chapter 2), by Newton's method.
    """
    weight = cable[at_.WEIGHT] ** 2
    slackness = weight * length**3 / 24.0
    at_rest = weight * cable[at_.REST_LENGTH] ** 3 / 24.0
    taut = tension - stiffness * at_rest / cable[at_.PRETENSION] ** 2
    found = max(tension, SHALLOWEST_N)
    for _ in range(NEWTON_STEPS):
        left = found - taut - stiffness * slackness / (found * found)
        step = min(left / (1.0 + 2.0 * stiffness * slackness / found**3), LONGEST_STEP * found)
        found -= step
        if abs(step) < NEWTON_STOP_N:
            break
    return found
