"""What a cable's material does along itself: elastic, unilateral, lossy, creeping, hooked."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.compiled import law

Array = NDArray[np.float64]

STOP = 2000.0
"""Stiffness of the hook's stops, steel, over that of the cable, Kevlar."""

HOOK_TIME_S = 1.5e-3
"""How long the hook takes to slide home, s."""

RIM_HZ = 90.0
"""Tone of the pulley's rim on the cable that creeps over it, Hz."""

RIM_LOSS = 0.5

LADDER_FIRST_HZ = 0.05
LADDER_RATIO = 3.2
"""The rungs of the structural ladder: 0.05 Hz to 170 Hz."""


@law
def pull(
    p: Array,
    s: Array,
    stretch: float,
    speed: float,
    chord: float,
    level: float,
    time_s: float,
    step_s: float,
) -> float:
    """Tension behind the pulley, N.

    Parameters
    ----------
    p, s
        Numbers and states of the cable.
    stretch
        Elongation over rest with what vibration adds, m.
    speed
        Its rate, m/s.
    chord
        Length of the straight line, m.
    level
        Cosine of its elevation.
    time_s, step_s
        Time and step, s.
    """
    moved = stretch - s[at.OLD] if s[at.STARTED] > 0.0 else 0.0
    s[at.OLD] = stretch
    stretch -= p[at.SLACK] + s[at.CREPT]
    if p[at.PLAY] > 0.0:
        stretch -= _hook(p, s, stretch, step_s)
    if p[at.SAG] > 0.0:
        tension: float = _hanging(p, stretch, chord, level)
    else:
        tension = p[at.PRETENSION] + p[at.STIFFNESS] * stretch
    if p[at.CUBIC] > 0.0:
        reach = stretch / p[at.CUBIC_REACH]
        tension += p[at.CUBIC] * stretch**3 / (1.0 + reach * reach)
    if p[at.CREEP] > 0.0:
        rate = p[at.CREEP] * tension / p[at.STIFFNESS] / (p[at.CREEP_TIME] + time_s)
        s[at.CREPT] += rate * step_s
    tension += _lossy(p, s, moved, step_s)
    if p[at.RIM] <= 0.0 or s[at.STARTED] <= 0.0:
        # Also while the platform finds its rest: the wheel then stands where the cable is.
        s[at.WHEEL], s[at.WHEEL + 1] = stretch, speed
    if p[at.RIM] > 0.0:
        tension += _rim(p, s, stretch, speed, step_s)
    return max(tension, 0.0)


@law
def _lossy(p: Array, s: Array, moved: float, step_s: float) -> float:
    """Maxwell branches (dashpot, relaxation, ladder) and Jenkins sliders (Iwan 1966)."""
    stiff = p[at.STIFFNESS]
    force = 0.0
    if p[at.VISCOUS] > 0.0:
        tau = p[at.VISCOUS_TIME]
        s[at.DASHPOT] = _branch(s[at.DASHPOT], p[at.VISCOUS] / tau, tau, moved, step_s)
        force += s[at.DASHPOT]
    for j in range(2):
        if p[at.RELAX + j] > 0.0:
            tau = p[at.RELAX_TIME + j]
            new = _branch(s[at.MAXWELL + j], p[at.RELAX + j] * stiff, tau, moved, step_s)
            s[at.MAXWELL + j] = new
            force += new
    if p[at.LOSS_FACTOR] > 0.0:
        # A dense ladder of equal rungs loses (pi / 2) / ln(ratio) of one rung a radian.
        rung = p[at.LOSS_FACTOR] * stiff * np.log(LADDER_RATIO) * 2.0 / np.pi
        hertz = LADDER_FIRST_HZ
        for j in range(at.RUNGS):
            tau = 1.0 / (2.0 * np.pi * hertz)
            s[at.LADDER + j] = _branch(s[at.LADDER + j], rung, tau, moved, step_s)
            force += s[at.LADDER + j]
            hertz *= LADDER_RATIO
    if p[at.LOOP] > 0.0:
        held = 0.0
        for j in range(at.SLIDERS):
            limit = p[at.LOOP_YIELD] * 2.0 * (j + 0.5) / at.SLIDERS
            new = min(max(s[at.SLIDER + j] + moved, -limit), limit)
            s[at.SLIDER + j] = new
            held += new
        force += p[at.LOOP] * stiff * held / at.SLIDERS
    return force


@law
def _branch(force: float, stiff: float, tau: float, moved: float, step_s: float) -> float:
    """A spring in series with a dashpot, exact for a constant speed."""
    ratio = step_s / tau
    left = np.exp(-ratio)
    held: float = force * left + stiff * moved * (1.0 - left) / ratio
    return held


@law
def _hanging(p: Array, stretch: float, chord: float, level: float) -> float:
    """Elastic catenary over its chord: s = (2 T/w) sinh(w L / 2 T), solved by Newton's method."""
    weight = p[at.SAG] * p[at.DENSITY] * 9.80665 * level
    stiff = p[at.STIFFNESS]
    if weight <= 0.0:
        straight: float = p[at.PRETENSION] + stiff * stretch
        return straight
    rest = _arc(p[at.PRETENSION], weight, chord - stretch) - (chord - stretch)
    tension: float = max(p[at.PRETENSION] + stiff * stretch, 0.2 * p[at.PRETENSION])
    for _ in range(8):
        arc = _arc(tension, weight, chord)
        # Elastic length and shape together give the chord.
        off = stretch + (arc - chord) - rest - (tension - p[at.PRETENSION]) / stiff
        slope = -2.0 * (arc - chord) / tension - 1.0 / stiff
        step = -off / slope
        tension = max(tension + step, 0.05 * p[at.PRETENSION])
        if abs(step) < 1e-9:
            break
    return tension


@law
def _arc(tension: float, weight: float, chord: float) -> float:
    """Length of a catenary of given horizontal pull over its chord, m."""
    half = 0.5 * weight * chord / tension
    if half < 1e-3:
        return chord * (1.0 + half * half / 6.0)
    arc: float = chord * np.sinh(half) / half
    return arc


@law
def _hook(p: Array, s: Array, stretch: float, step_s: float) -> float:
    """Way of a hook in its gap, m: held by friction, caught by stiff stops, slow by a damper."""
    stiff, hold, gap = p[at.STIFFNESS], p[at.HOLD], p[at.PLAY]
    way: float = s[at.HOOK]
    drive = stiff * (stretch - way) - STOP * stiff * _beyond(way, gap)
    if abs(drive) > hold:
        goal = stretch - np.sign(drive) * hold / stiff
        if abs(goal) > gap:
            goal = (goal + STOP * gap * np.sign(goal)) / (1.0 + STOP)
        way += (goal - way) * (1.0 - np.exp(-step_s / HOOK_TIME_S))
    s[at.HOOK] = way
    return way


@law
def _beyond(way: float, gap: float) -> float:
    """By how much the hook presses into a stop, m, with its sign."""
    pressed: float = np.sign(way) * max(abs(way) - gap, 0.0)
    return pressed


@law
def _rim(p: Array, s: Array, stretch: float, speed: float, step_s: float) -> float:
    """A rim of its own mass, dragged by the cable through a stiff, lossy contact."""
    turn = 2.0 * np.pi * RIM_HZ
    mass = p[at.RIM]
    way, rate = s[at.WHEEL], s[at.WHEEL + 1]
    force: float = mass * (turn * turn * (stretch - way) + 2.0 * RIM_LOSS * turn * (speed - rate))
    rate += force / mass * step_s
    s[at.WHEEL], s[at.WHEEL + 1] = way + rate * step_s, rate
    return force
