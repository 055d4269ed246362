"""Transverse vibration of the cables: sine modes of a taut string with fixed or moving ends.

Meirovitch, Fundamentals of Vibrations, section 8.2; the paper's Eq. 17 is the first mode of one
plane. A moving anchor shakes its string and feels its slope: `cable_end_forcing`.
"""

from math import pi

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.vectors import Vector, at, dot, minus, times

Array = NDArray[np.float64]

LOSS_PER_MODE = 0.25
"""Each further mode loses this share of the first one's damping more."""

SECOND_PLANE = 0.6
"""The disturbance of the strings is this much smaller in the horizontal plane."""


@law
def place(plane: int, mode: int) -> int:
    """Where the amplitude of a mode stands among a cable's states; its rate is next to it."""
    return at_.STRING + (plane * at_.MOST_MODES + mode) * 2


@law
def lengthened(cable: Array, own: Array, length: float) -> float:
    """Stretch that a vibrating string adds to a straight one, sum of n^2 pi^2 X_n^2 / (4 L), m."""
    added = 0.0
    for plane in range(int(cable[at_.PLANES])):
        for mode in range(int(cable[at_.MODES])):
            amplitude = own[place(plane, mode)]
            added += (mode + 1) ** 2 * pi * pi * amplitude * amplitude / (4.0 * length)
    return added


@law
def end_reaction(
    cable: Array, own: Array, directions: Array, length: float, tension: float, force: Vector
) -> Vector:
    """The pull of a cable on the platform with its slope at the anchor, N.

    Parameters
    ----------
    cable, own
        Numbers and states of the cable.
    directions
        Two transverse directions and that of the cable at rest, shape (3, 3).
    length, tension
        m and N.
    force
        Without the slope, N.
    """
    for plane in range(int(cable[at_.PLANES])):
        slope = 0.0
        for mode in range(int(cable[at_.MODES])):
            sign = -1.0 if mode % 2 == 0 else 1.0
            slope += sign * (mode + 1) * pi / length * own[place(plane, mode)]
        force = minus(force, times(tension * slope, at(directions[plane], 0)))
    return force


@law
def vibrate(
    cable: Array,
    own: Array,
    change: Array,
    directions: Array,
    length: float,
    speed: float,
    tension: float,
    shaken: Vector,
) -> None:
    """Rates of the modes: X'' = -c X' - (n pi / L)^2 (T / rho - v^2) X - forcing.

    Parameters
    ----------
    cable, own, change
        Numbers, states and rates of the cable.
    directions
        As for `end_reaction`.
    length, speed, tension
        Of the cable; m, m/s and N.
    shaken
        Acceleration of the anchor, m/s2; counts where `SHAKEN` is set.
    """
    square = tension / cable[at_.DENSITY] - speed * speed
    for plane in range(int(cable[at_.PLANES])):
        across = dot(shaken, at(directions[plane], 0)) if cable[at_.SHAKEN] > 0.0 else 0.0
        for mode in range(int(cable[at_.MODES])):
            here = place(plane, mode)
            number = (mode + 1) * pi / length
            loss = cable[at_.STRING_LOSS] * (1.0 + LOSS_PER_MODE * mode)
            change[here] = own[here + 1]
            change[here + 1] = -loss * own[here + 1] - number * number * square * own[here]
            sign = 1.0 if mode % 2 == 0 else -1.0
            change[here + 1] -= sign * 2.0 / ((mode + 1) * pi) * across


@law
def disturb(cable: Array, own: Array, offset_m: float) -> None:
    """X_w0: set the strings off, a mode the less the higher it is."""
    for plane in range(int(cable[at_.PLANES])):
        share = 1.0 if plane == 0 else SECOND_PLANE
        for mode in range(int(cable[at_.MODES])):
            own[place(plane, mode)] += share * offset_m / (mode + 1) ** 2
