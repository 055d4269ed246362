"""Where recording and simulation differ: channel by channel, line by line, against the noise.

Where every line of a stretch is looked at, it is by bands of lines, and once more by time: an
event is a few blocks of samples, and no line in particular.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import idct
from scipy.stats import chi2

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.evidence import Problem
from analysis.engine.labels import Labels
from analysis.engine.whiten import covariance_over

SIGNIFICANT = 0.01
"""Chance that noise alone makes the strongest finding, all looks counted."""

MOST = 40
"""Findings kept."""

BLOCK = 32
"""Samples of a block of time."""

MOST_BLOCKS = 20
"""Blocks of time kept."""


@dataclass(frozen=True)
class Finding:
    """One place where recording and simulation differ.

    Attributes
    ----------
    record, kind, channel
        Which run and which channel.
    segment
        Which stretch of time.
    line
        Harmonic of the drive; where nothing repeats, Hz, of a band its mean; NaN: a block of time.
    slow
        Whether it is the line's slow change rather than the line.
    in_phase, quadrature
        Recorded less simulated, cosine and sine, in the channel's unit (amplitude); of a band the
        amplitude of all of it, and of a block of time its rms, with no phase.
    unit
        Of these.
    sigmas
        Size against the noise.
    significance
        Chance that noise alone makes it, all looks counted.
    start_s, end_s
        From and to.
    """

    record: str
    kind: str
    channel: str
    segment: str
    line: float
    slow: bool
    in_phase: float
    quadrature: float
    unit: str
    sigmas: float
    significance: float
    start_s: float
    end_s: float

    @property
    def size(self) -> float:
        """Amplitude of the difference."""
        return float(np.hypot(self.in_phase, self.quadrature))


def locate(bundles: Sequence[Bundle], problem: Problem, residual: Array) -> tuple[Finding, ...]:
    """The significant differences, the strongest first.

    Parameters
    ----------
    bundles
        What was recorded.
    problem
        Gives noise and labels.
    residual
        Recorded less simulated features, in units of noise, shape (f,).
    """
    labels = problem.labels
    residual = np.where(labels.sealed, 0.0, residual)
    power = np.bincount(labels.group, residual**2 / problem.base)
    count = np.bincount(labels.group)
    looks = len(count)
    chance = np.minimum(chi2.sf(power, np.maximum(count, 1)) * looks, 1.0)
    order = np.argsort(chance - 1e-300 * power, kind="stable")
    order = order[np.lexsort((-power[order] / count[order], chance[order]))]
    found = []
    for group in order[:MOST]:
        if chance[group] > SIGNIFICANT or not count[group]:
            break
        found.append(
            _finding(
                bundles,
                labels,
                residual,
                int(group),
                float(chance[group]),
                np.asarray(power, dtype=float),
            )
        )
    return (*found, *_blocks(bundles, problem, residual))


def _blocks(bundles: Sequence[Bundle], problem: Problem, residual: Array) -> tuple[Finding, ...]:
    """Blocks of time in which they differ, the strongest first, of stretches seen line by line."""
    labels = problem.labels
    looks = int(np.ceil(labels.every.sum() / BLOCK))
    found = []
    for stretch in np.unique(labels.stretch[labels.every]):
        own = np.flatnonzero(labels.stretch == stretch)
        bundle, channel = bundles[labels.bundle[own[0]]], int(labels.channel[own[0]])
        segment = bundle.segments[labels.segment[own[0]]]
        inside = segment.holds(bundle.t_s)
        t_s = bundle.t_s[inside]
        white = idct(residual[own] / np.sqrt(problem.base[own]), type=2, norm="ortho")
        plain = idct(residual[own], type=2, norm="ortho")
        noise = float(np.sqrt(covariance_over(bundle, inside)[channel, channel]))
        for first in range(0, len(own), BLOCK):
            block = slice(first, min(first + BLOCK, len(own)))
            count = block.stop - block.start
            power = float(white[block] @ white[block])
            chance = min(float(chi2.sf(power, count)) * looks, 1.0)
            if chance <= SIGNIFICANT:
                found.append(
                    Finding(
                        bundle.record, bundle.kind, bundle.names[channel], segment.name,
                        float("nan"), False, noise * float(np.sqrt(np.mean(plain[block] ** 2))),
                        0.0, bundle.units[channel], float(np.sqrt(power / count)), chance,
                        float(t_s[block.start]), float(t_s[block.stop - 1]),
                    )
                )  # fmt: skip
    return tuple(sorted(found, key=lambda one: -one.sigmas)[:MOST_BLOCKS])


def _finding(
    bundles: Sequence[Bundle],
    labels: Labels,
    residual: Array,
    group: int,
    chance: float,
    power: Array,
) -> Finding:
    own = np.flatnonzero(labels.group == group)
    first = int(own[0])
    bundle = bundles[labels.bundle[first]]
    channel = int(labels.channel[first])
    segment = bundle.segments[labels.segment[first]]
    inside = segment.holds(bundle.t_s)
    noise = float(np.sqrt(covariance_over(bundle, inside)[channel, channel]))
    # A unit vector of n samples of a cosine of amplitude a holds a sqrt(n / 2).
    scale = noise / np.sqrt(labels.samples[first] * (0.5 if labels.line[first] > 0 else 1.0))
    if labels.every[first]:
        phase = [float(np.linalg.norm(residual[own]) * scale), 0.0]
    else:
        phase = [float(residual[own][labels.quadrature[own] == q].sum() * scale) for q in (0, 1)]
    return Finding(
        record=bundle.record,
        kind=bundle.kind,
        channel=bundle.names[channel],
        segment=segment.name,
        line=float(labels.line[own].mean()),
        slow=bool(labels.order[first] > 0),
        in_phase=phase[0],
        quadrature=phase[1],
        unit=bundle.units[channel],
        sigmas=float(np.sqrt(power[group] / len(own))),
        significance=chance,
        start_s=segment.start_s,
        end_s=segment.end_s,
    )
