"""In which places a candidate may be, and with how many values: sets of terms worth weighing."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.hypothesis import LOG_COST
from analysis.engine.solve import bounded

EVERY_SET, EACH = 10, 2
"""Of no more places than the first every set is tried with one value, a thousand; and of those of
each size the best ones are weighed."""


class Choice(NamedTuple):
    """Terms, whether they have one value, and what they would win in chi2."""

    terms: tuple[str, ...]
    shared: bool
    gain: float


def choices(candidate: Candidate, matrix: Array, right: Array) -> Iterator[Choice]:
    """Sets of terms worth weighing.

    Terms are added one by one, the best first, each with its own value or all with one, as long as
    the evidence grows; sets that belong together are tried as wholes. Of what has one value in all
    its places, the best sets of each size are found among all: terms that do nearly the same hide
    them from one that adds them one by one.

    Parameters
    ----------
    candidate
        Whose.
    matrix, right
        Normal equations of its terms, all else led along, shapes (k, k) and (k,).
    """
    names = tuple(term.name for term in candidate.terms)
    lows, highs = limits_of(candidate)
    limit = candidate.chosen_terms or len(names)

    def gain(groups: Sequence[Sequence[str]]) -> float:
        adds = np.array([[name in group for name in names] for group in groups])
        m, b = adds @ matrix @ adds.T, adds @ right
        low = np.where(adds, lows, -np.inf).max(axis=1)
        high = np.where(adds, highs, np.inf).min(axis=1)
        e = bounded(m, b, low, high)
        return float(2.0 * b @ e - e @ m @ e)

    def ways(terms: Sequence[str]) -> Iterator[Choice]:
        whole = tuple(one for one in names if one in terms)
        alike, each = candidate.groups(whole, True), candidate.groups(whole, False)
        if candidate.shareable and len(alike) < min(len(each), limit + 1):
            yield Choice(whole, True, gain(alike))
        if len(each) <= limit:
            yield Choice(whole, False, gain(each))

    if candidate.together or len(names) == 1:
        yield from ways(names)
        return
    # One by one, the best next, each with its own value.
    chosen: list[str] = []
    current = 0.0
    while len(chosen) < limit:
        gains = {one: gain([(k,) for k in (*chosen, one)]) for one in names if one not in chosen}
        if not gains:
            break
        best = max(gains, key=lambda one: gains[one])
        if gains[best] - current < 2.0 * LOG_COST and chosen:
            break
        chosen.append(best)
        current = gains[best]
        yield from ways(chosen)
    for combination in candidate.combinations:
        yield from ways(combination)
    one_value = candidate.shareable and len(candidate.groups(names, True)) == 1
    if one_value and len(names) <= EVERY_SET:
        yield from _alike(names, matrix, right, lows, highs)


def limits_of(candidate: Candidate) -> tuple[Array, Array]:
    """Bounds of each term; what is there or not has but one."""
    if candidate.fixed:
        steps = np.array([term.step for term in candidate.terms])
        return steps, steps
    return (
        np.array([term.low for term in candidate.terms]),
        np.array([term.high for term in candidate.terms]),
    )


def _alike(
    names: tuple[str, ...], matrix: Array, right: Array, lows: Array, highs: Array
) -> Iterator[Choice]:
    """Of each number of places, those that win most with one value in all of them."""
    count = len(names)
    sets = (np.arange(1, 2**count)[:, None] >> np.arange(count)) & 1 > 0
    sizes = sets.sum(axis=1)
    curve = np.maximum(np.einsum("si,ij,sj->s", sets, matrix, sets), np.finfo(float).tiny)
    slope = sets @ right
    low = np.where(sets, lows, -np.inf).max(axis=1)
    high = np.where(sets, highs, np.inf).min(axis=1)
    value = np.clip(slope / curve, low, high)
    gains = 2.0 * slope * value - curve * value**2
    for size in range(2, count + 1):
        same = np.flatnonzero(sizes == size)
        for best in same[np.argsort(-gains[same], kind="stable")[:EACH]].tolist():
            terms = tuple(name for name, on in zip(names, sets[best], strict=True) if on)
            yield Choice(terms, True, float(gains[best]))
