"""A faint tone that was led out of tune: what it leaves tells where it is.

A tone that is known to some per cent beforehand, and rings little, may be led to where it is some
turns off over a recording. The ring that is left then stands in the spectrum of what is left, and
the simulated one beside it. No step downhill leads there, nor do turns counted about a place that
other numbers were bent for. But parameters that bring this tone to the frequency that is seen, and
leave all others where they are, begin in its valley.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.known import Known
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Ringing, System

SOUGHT = 0.1
"""A ring is sought this near a tone, as a share of it, and within what is known of it."""

KNOWN = 3.0
"""A tone is within so many standard deviations, by what is known of numbers beforehand, of where it
is likeliest by that."""

APART = 0.75
"""What is nearer to the tone than this is its own ring, in lines of the longest recording."""

STANDS_OUT = 8.0
"""A ring stands out by so many standard deviations of what noise makes of a line."""

OF_IT = 0.05
"""And is at least this share of what is left beyond noise: of a tone out of tune it is a half, or a
quarter where two are. A law that is not exact leaves many lines that stand out, and each of them
takes a thousand simulations to bring a hundredth of what is left."""

SAMPLED = 2.5
"""Samples a period, at least, by which a ring is seen."""

STRIDES, TURNS = 6, 3
"""A tone is moved in so many strides, each corrected so often."""

MOST = 2
"""So many rings are followed up, the loudest first."""


class _Ring(NamedTuple):
    """A ring that is left: beside which tone, where, and by how much it stands out."""

    tone: int
    hertz: float
    loud: float


class _Beforehand(NamedTuple):
    """Tones, and how far from there they may be, in Hz, by what was known before the samples."""

    tones_hz: Array
    reach_hz: Array


def in_tune(system: System, led: Followed, known: Known) -> Iterator[Followed]:
    """Places where a tone has the frequency of a ring that is left, the loudest first.

    Parameters
    ----------
    system
        What is simulated.
    led
        Where parameters were led to the end.
    known
        What is known of free numbers beforehand.
    """
    if not isinstance(system, Ringing):
        return
    length_s, tones = longest_s(system), system.tones_hz(led.point)
    spread: Array = np.asarray(np.linalg.pinv(known.information, hermitian=True), dtype=float)
    moves = tones_by_number(system, led, length_s)
    turns = np.sqrt(np.maximum(np.einsum("jk,kl,jl->j", moves, spread, moves), 0.0))
    reach_hz = KNOWN * turns / (2.0 * np.pi * length_s)
    about = _Beforehand(system.tones_hz(_as_known(led, known).point), reach_hz)
    for ring in _rings(Samples(system, everything=True), led, tones, about, length_s)[:MOST]:
        yield _tuned(system, led, spread, ring, length_s)


def _as_known(led: Followed, known: Known) -> Followed:
    """Where numbers were likeliest before the samples; what nothing was known of stays."""
    off = np.where(np.diag(known.information) > 0.0, known.at - led.numbers, 0.0)
    return led.moved(off, 1.0)


def _rings(
    samples: Samples, led: Followed, tones: Array, about: _Beforehand, length_s: float
) -> list[_Ring]:
    """What rings beside a tone, within what is known of it beforehand, the loudest of each."""
    (residual,) = samples.residuals([led.point])
    line_hz = 1.0 / length_s
    found = []
    for j, tone in enumerate(tones):
        count = int(4.0 * SOUGHT * tone / line_hz)
        offsets = 0.25 * line_hz * np.arange(-count, count + 1)
        hertz = tone + offsets[np.abs(offsets) > APART * line_hz]
        # Nearer to another tone it is that one's.
        own = np.abs(hertz[:, None] - tones[None, :]).argmin(axis=1) == j
        hertz = hertz[own & (np.abs(hertz - about.tones_hz[j]) <= about.reach_hz[j])]
        if len(hertz):
            loud = _loudness(samples, residual, hertz)
            best = int(np.argmax(loud))
            if loud[best] > STANDS_OUT and _share(samples, residual, float(hertz[best])) > OF_IT:
                found.append(_Ring(j, float(hertz[best]), float(loud[best])))
    return sorted(found, key=lambda one: -one.loud)


def _loudness(samples: Samples, residual: Array, hertz: Array) -> Array:
    """By how much a line stands out at each frequency, in standard deviations of noise."""
    power, channels = np.zeros(len(hertz)), 0
    for t_s, part in samples.parts(residual):
        if len(t_s) < 2 or (len(t_s) - 1) / (t_s[-1] - t_s[0]) < SAMPLED * hertz[-1]:
            continue
        turns = np.exp(-2j * np.pi * np.outer(hertz, t_s))
        level = max(float(np.mean(part**2)), 1.0) * len(t_s)
        power += (np.abs(turns @ part) ** 2).sum(axis=1) / level
        channels += part.shape[1]
    # Of noise, each channel's power has mean and standard deviation 1.
    return np.asarray((power - channels) / np.sqrt(max(channels, 1)))


def _share(samples: Samples, residual: Array, hertz: float) -> float:
    """Which share of what is left beyond noise a line is."""
    of_line = 0.0
    for t_s, part in samples.parts(residual):
        turns = np.exp(-2j * np.pi * hertz * t_s)
        of_line += 2.0 * float((np.abs(turns @ part) ** 2).sum()) / len(t_s)
    return of_line / max(float(residual @ residual) - len(residual), 1.0)


def _tuned(system: Ringing, led: Followed, spread: Array, ring: _Ring, length_s: float) -> Followed:
    """Numbers with one tone elsewhere and all others where they are, the likeliest beforehand."""
    tones, turns = system.tones_hz(led.point), 2.0 * np.pi * length_s
    there = led
    for stride in range(1, STRIDES + 1):
        wanted = tones.copy()
        wanted[ring.tone] += stride / STRIDES * (ring.hertz - tones[ring.tone])
        moves = tones_by_number(system, there, length_s)
        by_tones = spread @ moves.T
        inverse = np.linalg.pinv(moves @ by_tones, hermitian=True)
        for _ in range(TURNS):
            missed = turns * (wanted - system.tones_hz(there.point))
            there = there.moved(by_tones @ inverse @ missed, 1.0)
    return there


def tones_by_number(system: Ringing, led: Followed, length_s: float) -> Array:
    """By how much one unit of each number moves each tone, shape (tones, numbers).

    In rad, after so long a time.
    """
    points, steps = led.neighbours()
    here = system.tones_hz(led.point)
    moved = np.array([system.tones_hz(point) - here for point in points]) / steps[:, None]
    return np.asarray(2.0 * np.pi * length_s * moved.T)


def longest_s(system: System) -> float:
    """Duration of the longest recording, s."""
    return max(float(one.t_s[-1] - one.t_s[0]) for one in system.bundles)
