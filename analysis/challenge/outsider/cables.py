"""One cable: from where its ends are to its tension and its pull on the platform."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.fibre import (
    after_play,
    crept,
    hysteretic,
    relaxing,
    sagging,
    stiffened,
)
from analysis.challenge.outsider.friction import friction
from analysis.challenge.outsider.strings import lengthened

Array = NDArray[np.float64]


@law
def elongation(cable: Array, own: Array, time_s: float, length: float) -> float:
    """Elastic elongation of the cable, m, with what vibration adds and what play and creep take."""
    found: float = length - cable[at_.REST_LENGTH]
    if cable[at_.PLAY] > 0.0:
        found = after_play(cable, found)
    found += lengthened(cable, own, length)
    if cable[at_.CREEP] > 0.0:
        found -= crept(cable, time_s)
    if cable[at_.FRONT] > 0.0:
        found -= own[at_.RIM]
    return found


@law
def spring(
    cable: Array, own: Array, change: Array, stretched: float, length: float, speed: float
) -> float:
    """Tension by the elastic and hysteretic laws alone, T_0 + k dL unless one is there, N."""
    stiffness = cable[at_.FRONT] if cable[at_.FRONT] > 0.0 else cable[at_.STIFFNESS]
    tension: float
    if cable[at_.STIFFENING] != 0.0:
        tension = stiffened(cable, stiffness, stretched)
    elif cable[at_.LOOP] > 0.0 or cable[at_.SLIDING] > 0.0:
        tension = hysteretic(cable, own, change, stiffness, stretched, speed)
    else:
        tension = cable[at_.PRETENSION] + stiffness * stretched
    if cable[at_.WEIGHT] > 0.0:
        tension = sagging(cable, stiffness, tension, length)
    return tension


@law
def tension(
    cable: Array, own: Array, change: Array, time_s: float, length: float, speed: float
) -> float:
    """Tension between platform and pulley, where the cell sits, N; writes the cable's rates.

    Parameters
    ----------
    cable
        Numbers of the cable, shape (CABLE_NUMBERS,).
    own, change
        Its states and their rates, shape (CABLE_STATES,).
    time_s
        Of the run, s.
    length, speed
        Of the cable and its growth, m and m/s.
    """
    stretched = elongation(cable, own, time_s, length)
    found: float = spring(cable, own, change, stretched, length, speed)
    found += cable[at_.VISCOUS] * speed + relaxing(cable, own, change, speed)
    with_rim = cable[at_.FRONT] > 0.0
    held = 0.0
    if cable[at_.BRISTLE] > 0.0:
        slipping = own[at_.RIM + 1] if with_rim else speed
        held = friction(cable, own, change, slipping, found)
    if with_rim:
        turn_rim(cable, own, change, found, held)
    else:
        found += held
    if cable[at_.UNILATERAL] > 0.0 and found < 0.0:
        found = 0.0
    return found


@law
def turn_rim(cable: Array, own: Array, change: Array, before: float, held: float) -> None:
    """A pulley with inertia between two springs in series: m s'' = T - T_behind - F.

    Parameters
    ----------
    cable, own, change
        Numbers, states and rates of the cable.
    before, held
        Tension before the pulley, and friction on it, N.
    """
    behind = cable[at_.PRETENSION] + cable[at_.BACK] * own[at_.RIM]
    change[at_.RIM] = own[at_.RIM + 1]
    change[at_.RIM + 1] = (before - behind - held) / cable[at_.RIM_MASS]
