"""How far features may be off though nothing is missing: noise, rings, a law's error of form."""

import numpy as np

from analysis.engine.array import Array
from analysis.engine.labels import Labels
from analysis.engine.lens import Lens

SPILLED = 0.1
"""The error of form reaches lines where the law itself does little: this share of what it does."""

SPILLED_SLOW = 1.0
"""And of what changes slowly."""

MEMORY = 2.5
"""What sticks or creeps remembers: where nothing moves, a law is off by its error of form, times
this, of what it does in motion."""

MEMORY_LINES = 0.3
"""The same for all but the mean and the slowest line."""

SPREAD = 0.3
"""Where every line of a stretch is looked at, the error of form that reaches other lines is, over
all of them, this share of what the law does."""

LEAKED = 0.5
"""Of a ring, this share is seen one line away, half of that two lines away, and so on."""

MOST_FORM = 1.0
"""However high the harmonic, a law is not more wrong than by all it does."""


def form_variance(
    labels: Labels, done: Array, share: float, size: float, beyond: Array | None = None
) -> Array:
    """Variance that the error of form of one candidate gives the features.

    Parameters
    ----------
    labels
        What each feature is.
    done
        What the candidate does to each, shape (f,).
    share, size
        The candidate's error of form, and the size it is taken at.
    beyond
        What of it counts where it acts, shape (f,); default: all.
    """
    felt = done if beyond is None else beyond
    power = group_power(labels, felt)
    moving = np.where((labels.line > 0.0) & ~labels.ringing, felt**2, 0.0)
    total = np.bincount(labels.stretch, moving)[labels.stretch]
    spill = np.where(labels.order > 0, SPILLED_SLOW, SPILLED)
    spill = np.where(labels.every, np.sqrt(SPREAD / labels.samples), spill)
    relative = np.minimum(share * size * labels.growth, MOST_FORM)
    variance = relative**2 * (power + spill**2 * total)
    # What it does while the motion repeats says how far its memory may be off elsewhere.
    series, steady = labels.series, ~labels.free
    repeats = (labels.line > 0.0) & ~labels.ringing & steady
    done_there = np.bincount(series, np.where(repeats, done**2, 0.0))
    _, first = np.unique(labels.stretch, return_index=True)
    samples = np.bincount(
        series[first], np.where(steady[first], labels.samples[first], 0), len(done_there)
    )
    per_sample = (done_there / np.maximum(samples, 1))[series]
    memory = np.minimum(MEMORY * share * size, 1.0) * np.where(labels.line < 1.0, 1.0, MEMORY_LINES)
    variance += np.where(labels.free & ~labels.every, memory**2 * per_sample * labels.samples, 0.0)
    return np.asarray(variance)


def group_power(labels: Labels, features: Array) -> Array:
    """Squared size of each feature's group: cosine and sine; of a band of lines, the mean."""
    total, count = np.bincount(labels.group, features**2), np.bincount(labels.group)
    mean = np.where(labels.every, total[labels.group] / count[labels.group], total[labels.group])
    return np.asarray(mean)


def base_variance(lens: Lens, features: Array, data: Array) -> Array:
    """Variance of the features where nothing was left out: noise, and the simulator's own error.

    A ring cannot be foretold, and is seen on other lines too, less the farther they are: over a
    stretch that repeats, as it is found in the recording; over another, by its own lines.

    Parameters
    ----------
    lens
        How the samples are looked at.
    features, data
        Simulated and recorded, shape (f,).
    """
    labels = lens.labels
    moving = labels.line > 0.0
    total = np.bincount(labels.stretch, np.where(moving, features**2, 0.0))
    share = np.array([bundle.base_share for bundle in lens.bundles])[labels.bundle]
    # Where every line is looked at, the simulator's own error has the signal's colour.
    coloured = group_power(labels, np.where(moving, features, 0.0))
    coloured += SPREAD * total[labels.stretch] / labels.samples
    variance = 1.0 + share**2 * np.where(labels.every, coloured, total[labels.stretch])
    variance += lens.rung + lens.late
    rung = np.where(labels.ringing & labels.free, np.maximum(features**2, data**2) - 1.0, 0.0)
    for stretch in np.unique(labels.stretch[labels.ringing & labels.free]):
        own = np.flatnonzero(labels.stretch == stretch)
        lines = labels.line[own]
        apart = np.unique(np.round(lines, 6))
        spacing = float(np.diff(apart).min()) if len(apart) > 1 else 1.0
        distance = np.abs(lines[:, None] - lines[None, :]) / spacing
        leaks = (LEAKED / np.maximum(distance, 1.0)) ** 2
        variance[own] += leaks @ np.maximum(rung[own], 0.0)
    return np.asarray(variance)
