"""Numbers of a law that sticks and slips, or has play, looked for over all of their ranges.

When it slips first, and how far it was bent, decides all that comes after: over the beginning of a
motion the misfit has a valley for every order of slips, and of these one goes on. Differences lead
to the floor of the valley one is in; which it is, many at once find that learn from each other
(differential evolution: Storn and Price 1997).
"""

from dataclasses import replace
from itertools import product
from math import log
from typing import Any

import numpy as np

from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.ring_samples import Samples
from analysis.engine.state import Number, State
from analysis.engine.way import Way

STRETCHES = (0.12, 0.13, 0.14, 0.15, 0.16)
"""Shares of the time over which samples are fitted: over the first numbers are looked for. Over a
longer one few are near enough to be told from the others."""

FEW = 8
"""So many free numbers can be looked for: those of one or two places."""

FACTOR = log(3.0)
"""How far off what told them magnitudes may be."""

MEMBERS, GENERATIONS = 8, 20
"""For each number, and how often they learn."""

SEEDS, FOUND = (1, 2, 3), 1.3
"""Looked for anew until no more than this is left of the squared misfit of a sample."""

STEPS = 20
"""Of Gauss and Newton's from what is found, for each stretch."""


def sticks(state: State) -> bool:
    """Whether what is on sticks or has play, and its free numbers are few."""
    return len(state.free) <= FEW and (bends(state) or any(map(_begins, state.numbers)))


def bends(state: State) -> bool:
    """Whether a law that is on bends with its size: see `Candidate`."""
    return any(state.candidates[name].bends for name in state.hypothesis.names)


def surveyed(samples: Samples, start: Followed, nuisance: Array) -> Followed:
    """Where the beginning of a motion leads, whatever the numbers of a law were taken for.

    Parameters
    ----------
    samples
        By which it is led.
    start
        A law that sticks, by what told it.
    nuisance
        Likeliest parameters up to where the motion begins, shape (p,).

    Returns
    -------
    Followed
        Led over the last of `STRETCHES`, and what is left there.
    """
    assert start.state is not None
    best = start
    # What is one thing or another may be either.
    for seed, state in product(SEEDS, (start.state, *start.state.otherwise())):
        found = _evolved(samples, nuisance, state, seed)
        best = min(best, _led(samples, Followed(nuisance, found)), key=lambda one: one.left)
        if best.left < FOUND:
            break
    return best


def _led(samples: Samples, start: Followed) -> Followed:
    way = Way(samples, start)
    for share in STRETCHES:
        for _ in range(STEPS):
            if not way.step(share, lost=np.inf):
                break
    return replace(way.at, share=STRETCHES[-1], left=way.left(STRETCHES[-1]))


def _evolved(samples: Samples, nuisance: Array, state: State, seed: int) -> State:
    """The numbers, anywhere in their ranges, that leave least of the first stretch."""
    from scipy.optimize import Bounds, differential_evolution

    stretch, start = STRETCHES[0], state.values[list(state.free)]
    inside = samples.shares <= stretch

    def misfit(members: Array, /) -> Array:
        there = [state.moved(one - start) for one in members.T]
        found = samples.residuals([Followed(nuisance, one).point for one in there], stretch)
        return np.array([np.log(np.mean(one[inside] ** 2)) for one in found])

    low, high = np.array(
        [_range(state.numbers[i], value) for i, value in zip(state.free, start, strict=True)]
    ).T
    vectorized: Any = misfit
    found = differential_evolution(
        vectorized, Bounds(low, high), vectorized=True, updating="deferred", popsize=MEMBERS,
        maxiter=GENERATIONS, tol=0.0, rng=seed, polish=False, init="sobol",
    )  # fmt: skip
    return state.moved(np.asarray(found.x) - start)


def _begins(number: Number) -> bool:
    return number.shape is not None and bool(number.shape.term)


def _range(number: Number, value: float) -> tuple[float, float]:
    """A magnitude by a factor; of a shape all of its range; of one from nothing, up to usual."""
    if number.shape is None:
        factor = float(np.exp(FACTOR))
        return max(value / factor, number.low), min(value * factor, number.high)
    whole = number.shape.logarithmic or _begins(number) or number.low < 0.0
    return number.low, number.high if whole else number.shape.default
