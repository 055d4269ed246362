"""What each nuisance and each term of each candidate does to the features."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate, Setting
from analysis.engine.lens import Lens
from analysis.engine.part import rings
from analysis.engine.system import Point, System, own_nuisances

Progress = Callable[[int, int], None]
"""Told how many points are done, of how many."""

BATCH = 128
"""Points simulated at a time."""

BEYOND = 1e12
"""In units of its noise, nothing is recorded that far off: a simulation that is has come to
nothing, and squares of what it holds are more than numbers can be."""

FAILED = (ArithmeticError, ValueError)
"""What solvers raise where they are taken too far; other exceptions are mistakes, and are seen."""

Columns = dict[tuple[str, int], Array]
"""(candidate, variant of its shapes) -> what one unit of each term does, shape (f, k)."""


def simulate_features(
    system: System, lens: Lens, points: Sequence[Point], progress: Progress | None = None
) -> Array:
    """Features of points, shape (number of points, f); NaN where a simulation came to nothing."""
    found = np.empty((len(points), lens.size))
    for first in range(0, len(points), BATCH):
        part = points[first : first + BATCH]
        found[first : first + len(part)] = _simulated(system, lens, part)
        if progress is not None:
            progress(min(first + BATCH, len(points)), len(points))
    return found


def _simulated(system: System, lens: Lens, points: Sequence[Point]) -> Array:
    """Features of points, shape (number of points, f), NaN where a simulation comes to nothing."""
    try:
        return np.asarray(system.simulate(points, lens), dtype=float)
    except FAILED:
        if rings(system):
            raise
    found = np.full((len(points), lens.size), np.nan)
    for i, point in enumerate(points):
        with suppress(*FAILED):
            (found[i],) = system.simulate([point], lens)
    return found


def nuisance_columns(
    system: System,
    lens: Lens,
    about: Array,
    progress: Progress | None = None,
) -> Array:
    """What one sigma of each nuisance does, by differences, shape (f, nuisances).

    Parameters
    ----------
    system, lens
        What is simulated and how it is looked at.
    about
        Nuisances about which, in sigmas.
    progress
        Told of it.
    """
    points = [Point(about, ring="damped")]
    for i, nuisance in enumerate(system.nuisances):
        at = about.copy()
        at[i] += nuisance.step
        points.append(Point(at, ring="damped"))
    found = simulate_features(system, lens, points, progress)
    steps = np.array([one.step for one in system.nuisances])
    return _finite((found[1:] - found[0]) / steps[:, None]).T


def term_columns(
    system: System,
    lens: Lens,
    candidates: Sequence[Candidate],
    about: Array,
    nuisance: Array,
    progress: Progress | None = None,
    effects: Mapping[str, Setting] | None = None,
) -> Columns:
    """What one unit of each term of each candidate does, for each variant of its shapes.

    Parameters
    ----------
    system, lens
        What is simulated and how it is looked at.
    candidates
        Those to look at.
    about
        Nuisances about which, in sigmas.
    nuisance
        What those do: a candidate's term that is a nuisance is not simulated again.
    progress
        Told of it.
    effects
        Others that are on.
    """
    base = Point(about, dict(effects or {}), ring="damped")
    points = [base]
    places: list[tuple[str, int, int, float]] = []
    same = own_nuisances(system.nuisances)
    columns: Columns = {}
    for candidate in candidates:
        for v, shapes in enumerate(candidate.variants()):
            columns[candidate.name, v] = np.zeros((lens.size, len(candidate.terms)))
            for k, term in enumerate(candidate.terms):
                i = same.get((candidate.name, term.name))
                if i is not None:
                    columns[candidate.name, v][:, k] = nuisance[:, i] / system.nuisances[i].sigma
                    continue
                places.append((candidate.name, v, k, term.step))
                setting = Setting({term.name: term.step}, shapes)
                points.append(replace(base, effects={**base.effects, candidate.name: setting}))
    found = simulate_features(system, lens, points, progress)
    for (name, v, k, step), row in zip(places, found[1:], strict=True):
        columns[name, v][:, k] = _finite((row - found[0]) / step)
    return columns


def _finite(change: Array) -> Array:
    """A simulation that came to nothing tells nothing."""
    return np.where(sound(change), change, 0.0)


def sound(features: Array) -> NDArray[np.bool_]:
    """Which of them a simulation can have come to."""
    return np.asarray(np.abs(features) < BEYOND)
