"""A ring that is a turn or more out of phase: other valleys, and how they are reached.

Parameters at which a faint tone loses or gains a turn over the length of a recording fit nearly as
well as those at which it is in phase, and between them lies a ridge (cycle skipping, as seismology
has it: Virieux and Operto 2009). No step downhill leads over it. Where the next valleys lie follows
from the tones themselves; and where they are hardly higher, the recording does not tell the tone,
however narrow each valley is.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.differences import differences
from analysis.engine.followed import Followed, straight_on
from analysis.engine.in_tune import in_tune, longest_s, tones_by_number
from analysis.engine.known import Known
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Ringing, System

TURNS_RAD = (7.73, 14.07, 20.37)
"""Where a tone that is so far out of phase at the end is in phase best on the whole: maxima of
sin(x)/x."""

NARROW_RAD = 1.5
"""A tone that is known no better than this at the end has no other valley."""

OPEN, OPEN_RAD = 150.0, 10.0
"""Where the cost rises by no more than this, the tone is not told: it may be so far off as well."""

FLAT = 0.3
"""Where the cost rises by less than this share of what a single valley would have it rise by, there
may be a lower one;"""

MOST, RIDGES = 2, 6
"""so many are tried, those where it rises least, and so many ridges are gone over."""

WORTH_IT = 10.0
"""A valley is lower where the cost is less by this."""


class Valley(NamedTuple):
    """Where a ring was followed to, and what its samples tell of numbers, shape (k, k)."""

    led: Followed
    information: Array


class _Tone(NamedTuple):
    """By how much one unit of each number moves a tone, shape (k,), and the tone's variance.

    In rad, at the end of the recording.
    """

    moves: Array
    variance: float


class _Turn(NamedTuple):
    """Where a tone is a turn off, by how much the cost rises there, and would in one valley."""

    there: Followed
    tone: _Tone
    rise: float
    single: float


def valley(
    system: System, led: Followed, known: Known | None = None, *, lower: bool = False
) -> Valley:
    """Where the ring was followed to, or beyond the ridges about there, if that is lower.

    Parameters
    ----------
    system
        What is simulated.
    led
        Where to.
    known
        What is known of free numbers; None: priors of nuisances.
    lower
        Only what is lower at once is tried: other recordings tell the tones that are open here.
    """
    known = Known.priors(led) if known is None else known
    if not led.to_end:
        # What was lost on the way tells nothing.
        return Valley(led, np.zeros_like(known.information))
    information = information_of(system, led)
    turns = _turns(system, led, known, information)
    for _ in range(RIDGES):
        starts = chain(in_tune(system, led, known), _starts(turns, lower=lower))
        found = _beyond(system, led, known, starts)
        if found is None:
            break
        led, information = found, information_of(system, found)
        turns = _turns(system, led, known, information)
    for tone in {id(one.tone): one.tone for one in turns if one.rise < OPEN}.values():
        surer = 1.0 / tone.variance - 1.0 / OPEN_RAD**2
        information = information - surer * np.outer(tone.moves, tone.moves)
    return Valley(led, information)


def tuned(system: System, led: Followed) -> Followed:
    """Where the ring was followed to, or where a tone that is out of tune there is in tune.

    Turns that are counted take all differences; a ring that is left takes one simulation to be
    seen, and so can be asked of every hypothesis.

    Parameters
    ----------
    system
        What is simulated.
    led
        Where to, over all of the time.
    """
    known, effort = Known.priors(led), led.effort
    for _ in range(RIDGES):
        found = _beyond(system, led, known, in_tune(system, led, known))
        if found is None:
            break
        effort += found.effort
        led = replace(found, effort=effort)
    return led


def information_of(system: System, led: Followed) -> Array:
    """What samples tell of free numbers about where they were led to, shape (numbers, numbers)."""
    if led.information is not None:
        return led.information
    samples = Samples(system, everything=True)
    (here,) = samples.residuals([led.point])
    columns, _ = differences(samples, led, here)
    return np.asarray(columns @ columns.T)


def _starts(turns: Sequence[_Turn], *, lower: bool) -> list[Followed]:
    """Where a lower valley may begin, the likeliest first."""
    flat = (one for one in turns if one.rise < (0.0 if lower else FLAT * one.single))
    return [one.there for one in sorted(flat, key=lambda one: one.rise / one.single)[:MOST]]


def _beyond(
    system: System, led: Followed, known: Known, starts: Iterable[Followed]
) -> Followed | None:
    """The first of some valleys that is lower; None: none is."""
    here = _cost(led, known)
    for start in starts:
        found = follow_ring(
            system, start.nuisance, start.state, everything=True, near=True, known=known,
            ahead={1.0: here},
        )  # fmt: skip
        if _cost(found, known) < here - WORTH_IT:
            return found
    return None


def _turns(system: System, led: Followed, known: Known, information: Array) -> list[_Turn]:
    """Places where one tone is a turn off, and all else is as likely as it then can be."""
    if not isinstance(system, Ringing):
        return []
    found: list[tuple[Followed, _Tone, float]] = []
    covariance = np.linalg.pinv(information + known.information, hermitian=True)
    for moves in tones_by_number(system, led, longest_s(system)):
        along = covariance @ moves
        tone = _Tone(moves, float(moves @ along))
        if 0.0 < tone.variance < NARROW_RAD**2:
            for turn_rad in (sign * one for one in TURNS_RAD for sign in (1.0, -1.0)):
                there = straight_on(system, led, turn_rad / tone.variance * along)
                single = turn_rad**2 / tone.variance
                if known.cost(there.numbers) - known.cost(led.numbers) < max(OPEN, FLAT * single):
                    found.append((there, tone, single))
    if not found:
        return []
    residuals = Samples(system, everything=True).residuals([one.point for one, _, _ in found])
    here = _cost(led, known)
    return [
        _Turn(there, tone, float(left @ left) + known.cost(there.numbers) - here, single)
        for (there, tone, single), left in zip(found, residuals, strict=True)
    ]


def _cost(led: Followed, known: Known) -> float:
    return led.misfit + known.cost(led.numbers)
