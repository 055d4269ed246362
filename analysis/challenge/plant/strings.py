"""Transverse vibration of a cable: Eqs. 15 and 17 of the paper, further modes, a moving end."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.compiled import law

Array = NDArray[np.float64]

PI_SQUARED = np.pi * np.pi

VERTICAL = (2, 3, 4)
HORIZONTAL = (1, 2, 3, 4)
"""Further modes in the two planes; the first vertical one is the paper's own."""


@law
def extension(p: Array, s: Array, chord: float) -> float:
    """Length that all modes take up, n^2 pi^2 X_n^2 / (4 L) each, m (Eq. 15)."""
    whole = s[at.STRING] * s[at.STRING]
    if p[at.MODES] > 0.0:
        for j in range(at.OVERTONES):
            number = j + 2 if j < len(VERTICAL) else j + 1 - len(VERTICAL)
            whole += p[at.MODES] * (number * s[at.MODE + j]) ** 2
    taken_up: float = PI_SQUARED * whole / (4.0 * chord)
    return taken_up


@law
def vibrate(
    p: Array,
    s: Array,
    tension: float,
    speed: float,
    chord: float,
    sway: float,
    side: float,
    kick: float,
    step_s: float,
) -> None:
    """Move every mode by one step.

    Parameters
    ----------
    p, s
        Numbers and states of the cable.
    tension
        N.
    speed
        Of the path, m/s.
    chord
        m.
    sway, side
        Speeds of the anchor across the cable, in its vertical plane and out of it, m/s.
    kick
        Share of the step that has passed for the rates: half where the state has just jumped.
    step_s
        Step, s.
    """
    wave = tension / p[at.DENSITY] - speed * speed
    square = PI_SQUARED / (chord * chord) * wave
    shaken = 0.0
    if p[at.SHAKEN] > 0.0 and s[at.STARTED] > 0.0:
        # A straight line from the fixed end to the moving one is 2/pi of a sine's first mode.
        shaken = 2.0 / np.pi * p[at.SHAKEN] * (sway - s[at.OLD_SWAY])
    rate = s[at.STRING + 1]
    rate += kick * step_s * (-p[at.STRING_LOSS] * rate - square * s[at.STRING]) - shaken
    s[at.STRING + 1] = rate
    s[at.STRING] += step_s * rate
    if p[at.MODES] > 0.0:
        _overtones(p, s, square, sway, side, step_s)
    s[at.OLD_SWAY] = sway


@law
def _overtones(p: Array, s: Array, square: float, sway: float, side: float, step_s: float) -> None:
    """A taut string with a moving end, mode by mode; the shape is X_n sin(n pi y / L)."""
    for j in range(at.OVERTONES):
        vertical = j < len(VERTICAL)
        number = j + 2 if vertical else j + 1 - len(VERTICAL)
        end = sway if vertical else side
        sign = 1.0 if number % 2 == 0 else -1.0
        rate = s[at.MODE + at.OVERTONES + j]
        rate -= step_s * (p[at.STRING_LOSS] * rate + number * number * square * s[at.MODE + j])
        s[at.MODE + at.OVERTONES + j] = rate
        # The states' rates are those of the cable itself, not of the line that moves with the end.
        s[at.MODE + j] += step_s * (rate + sign * 2.0 / (np.pi * number) * end)
