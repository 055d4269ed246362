"""Parameters before physics: the system with its parameters fitted within their priors.

What cannot be explained by parameters must not drag them along: a share of whatever residual is
left counts as the unknown's, and shrinks as the residual does.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.evidence import Frame, Problem, directions
from analysis.engine.lens import Lens
from analysis.engine.part import has_several, rings
from analysis.engine.sensitivity import Progress, nuisance_columns, simulate_features
from analysis.engine.system import Point, System
from analysis.engine.variance import base_variance, form_variance

ROUNDS, ROUNDS_ANEW = 6, 20
"""Steps, at most; and where each may be by new differences."""

EXPLAINED = 4.0
"""Parameters that leave more than this, a feature, are left where they were."""

LEAST_TYPICAL = 12
"""Features that a typical misfit needs."""

MEDIAN_OF_SQUARE = 0.455
"""Median of the square of a standard normal number."""

HOPELESS = 40.0
"""Parameters of a system that rings that leave more than this, a feature, are not what it is, and
are not refined. Of one that does not, they may begin a thousand times the noise off."""

WORTH_A_STEP = 6.0
"""A step is taken where it promises that the squared misfit falls by this."""

SHORTEST, SHORTER = 3, 0.4
"""A step that went too far is taken again, this much of it, and so often."""

UNKNOWN_SHARE = 0.15
"""Of the residual, what is not the parameters'."""

FARTHEST = 3.0
"""No parameter is taken farther than this, in sigmas."""

STRIDE = 2.0
"""Nor farther than this at once."""

LINEAR = 0.3
"""Where the simulation misses the prediction by less than this share, the columns still hold."""


@dataclass(frozen=True)
class Calibrated:
    """The system at its likeliest parameters.

    Attributes
    ----------
    at
        Nuisances, in sigmas, shape (nuisances,).
    features
        Simulated there, shape (f,).
    columns
        What one sigma of each nuisance does there, shape (f, nuisances).
    problem
        What is left there, in directions of the nuisances.
    rotation
        Nuisances of directions, shape (nuisances, p).
    """

    at: Array
    features: Array
    columns: Array
    problem: Problem
    rotation: Array


def calibrate(
    system: System, lens: Lens, data: Array, progress: Progress | None = None
) -> Calibrated:
    """Fit the parameters within their priors, with nothing else.

    Parameters
    ----------
    system, lens
        What is simulated and how it is looked at.
    data
        Recorded features, shape (f,).
    progress
        Told of it.
    """
    used = ~(lens.labels.ringing | lens.labels.sealed)
    at = np.zeros(len(system.nuisances))
    features = simulate_features(system, lens, [Point(at)])[0]
    columns = nuisance_columns(system, lens, at, progress)
    nominal = at, features, columns
    fresh, ringing = True, rings(system)
    for _ in range(ROUNDS if ringing else ROUNDS_ANEW):
        residual = data - features
        variance = base_variance(lens, features, data)
        variance = variance + form_variance(lens.labels, residual, UNKNOWN_SHARE, 1.0)
        frame = Frame(Problem(residual, columns, at, variance, lens.labels, used), variance)
        none = np.zeros((lens.size, 0))
        move = np.clip(frame.nuisance(none, np.zeros(0)), -FARTHEST, FARTHEST) - at
        before = _misfit(residual, at, variance, used)
        if before - frame.chi2 < WORTH_A_STEP:
            break
        share = min(1.0, STRIDE / float(np.abs(move).max(initial=1e-9)))
        better = False
        for _ in range(SHORTEST):
            there = at + share * move
            found = simulate_features(system, lens, [Point(there)])[0]
            if _misfit(data - found, there, variance, used) < before:
                better = True
                break
            share *= SHORTER
        if better:
            foretold = features + columns @ (there - at)
            missed = _misfit(found - foretold, np.zeros(1), variance, used)
            moved = _misfit(found - features, np.zeros(1), variance, used)
            at, features = there, found
            straight = missed < LINEAR**2 * moved
        if not better and fresh:
            break
        left = _misfit(data - features, at, base_variance(lens, features, data), used)
        fresh = not better or not straight
        if ringing:
            fresh = fresh and left < HOPELESS * int(used.sum())
            fresh = fresh and not has_several(system)
        if fresh:
            columns = nuisance_columns(system, lens, at, progress)
    base = base_variance(lens, features, data)
    if _misfit(data - features, at, base, used) > EXPLAINED * int(used.sum()):
        # Parameters that do not explain it were dragged along by what does.
        at, features, columns = nominal
        base = base_variance(lens, features, data)
    base = base * unsettled(lens, data - features, base)
    rotation = directions(columns, base, used)
    problem = Problem(
        residual=data - features,
        nuisance=columns @ rotation,
        at=rotation.T @ at,
        base=base,
        labels=lens.labels,
        used=used,
        coloured=bool(lens.labels.every.any()),
    )
    return Calibrated(at, features, columns, problem, rotation)


def unsettled(lens: Lens, residual: Array, base: Array) -> Array:
    """By how much the variance of stretches that do not repeat is too small, shape (f,), 1 or more.

    While a motion starts, stops and dies away, what rings goes its own way in every channel: the
    typical misfit there, not the strongest, tells how far to trust such a stretch.

    Parameters
    ----------
    lens
        How the samples are looked at.
    residual
        Recorded less simulated features, shape (f,).
    base
        Their variance, shape (f,).
    """
    labels = lens.labels
    factor = np.ones(lens.size)
    kinds = {bundle.kind: i for i, bundle in enumerate(lens.bundles)}
    places = [
        (bundle.record, kinds[bundle.kind], segment.name)
        for bundle in lens.bundles
        for segment in bundle.segments
    ]
    known = {place: i for i, place in enumerate(dict.fromkeys(places))}
    starts = np.cumsum([0, *(len(bundle.segments) for bundle in lens.bundles)])
    which = np.array([known[one] for one in places])[starts[labels.bundle] + labels.segment]
    for place, i in known.items():
        own = labels.free & (which == i) & ~labels.ringing
        if place[2] == "rest" or np.count_nonzero(own) < LEAST_TYPICAL:
            continue
        typical = float(np.median(residual[own] ** 2 / base[own])) / MEDIAN_OF_SQUARE
        factor[which == i] = max(typical, 1.0)
    return factor


def _misfit(residual: Array, at: Array, variance: Array, used: NDArray[np.bool_]) -> float:
    return float((residual[used] ** 2 / variance[used]).sum() + at @ at)
