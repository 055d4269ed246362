"""The search: differential evolution from the known sets, written down as it goes.

"current-to-pbest/1/bin" (Zhang and Sanderson, JADE, IEEE Trans. Evol. Comput. 13, 2009), with one
change: a candidate is judged only until it is known to be worse than the one it would replace,
which SciPy's ``differential_evolution`` cannot do and which saves most of the work.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from model.reconstruct.journal import Journal, Member
from model.reconstruct.layout import BOUNDS, Layout
from model.reconstruct.misfit import REFUSED, Judge

Array = NDArray[np.float64]

PBEST_SHARE = 0.15
"""A step is drawn towards one of the best: this share of the population."""

HOPELESS = 300.0
"""In the first generation a machine is judged up to this misfit; the known sets have half of it."""

NEAR_SHARE = 0.4
"""This share of the candidates lies close to one of the best: the valley's floor is rugged."""

STARTS = 400
"""Random points tried for a place in the first population before it is filled otherwise."""


@dataclass(frozen=True)
class Plan:
    """How to search.

    Parameters
    ----------
    judge
        Counts the misfit.
    budget_s
        Wall time.
    population
        Number of machines kept.
    seed
        The one seed of the search; generation g draws from its child g.
    generations
        Most generations in all; None for as many as there is time for.
    """

    judge: Judge
    budget_s: float
    population: int = 64
    seed: int = 0
    generations: int | None = None

    def identity(self) -> dict[str, object]:
        """What has to be the same for a search to go on with what another left."""
        return {
            "population": self.population,
            "seed": self.seed,
            "repetitions": self.judge.repetitions,
            "bounds": {name: list(bounds) for name, bounds in BOUNDS.items()},
        }


def search(
    starts: Sequence[Layout],
    plan: Plan,
    journal_path: Path,
    told: Callable[[int, Member], None] | None = None,
) -> list[Member]:
    """Search until the time is up.

    Parameters
    ----------
    starts
        Sets to start from.
    plan
        How.
    journal_path
        Every improvement is appended to this file; where it exists, the search goes on from its
        last whole generation.
    told
        Called after each generation with its number and the best member.

    Returns
    -------
    list of Member
        The population, best first.
    """
    ends = time.monotonic() + plan.budget_s
    low, high = np.array(list(BOUNDS.values())).T
    with Journal(journal_path, plan.identity()) as journal:
        members = dict(journal.members)
        generation = journal.generations
        while generation == 0 or (time.monotonic() < ends and generation != plan.generations):
            rng = np.random.default_rng(np.random.SeedSequence(plan.seed, spawn_key=(generation,)))
            if generation == 0:
                vectors = _first(starts, plan.population, low, high, rng)
            for slot in range(plan.population):
                if generation > 0 and time.monotonic() > ends:
                    return _ranked(members)
                if generation == 0:
                    trial, enough = vectors[slot], HOPELESS
                else:
                    trial = _trial(members, slot, low, high, rng)
                    enough = members[slot].cost
                found = _judged(plan.judge, trial, starts[0], enough)
                if generation == 0 or found.cost <= enough:
                    members[slot] = found
                    journal.keep(slot, found)
            journal.close_generation()
            generation += 1
            if told is not None:
                told(generation, _ranked(members)[0])
    return _ranked(members)


def settled(members: Sequence[Member], judge: Judge, pattern: Layout) -> list[Member]:
    """The same machines judged again, with more repetitions, best first.

    A search prefers the machines whose few runs happened to come out well; more runs tell.
    """
    again = [_judged(judge, np.array(one.vector), pattern, np.inf) for one in members]
    return sorted(again, key=lambda one: one.cost)


def _ranked(members: dict[int, Member]) -> list[Member]:
    """Best first."""
    return sorted(members.values(), key=lambda one: one.cost)


def _judged(judge: Judge, vector: Array, pattern: Layout, enough: float) -> Member:
    misfit = judge.judge(Layout.of_vector(vector, pattern.front_x, pattern.rear_x), enough)
    # Stopped early is not better: a tie with what was enough must not look like one.
    cost = misfit.cost if misfit.complete else max(misfit.cost, np.nextafter(enough, np.inf))
    return Member(
        cost=min(float(cost), 2.0 * REFUSED),
        vector=[float(value) for value in vector],
        reach=[misfit.layout.front_x, misfit.layout.rear_x],
        terms=misfit.terms,
        figures={str(frequency): values for frequency, values in misfit.figures.items()},
    )


def _first(
    starts: Sequence[Layout], count: int, low: Array, high: Array, rng: np.random.Generator
) -> list[Array]:
    """The starting sets, sets beside them, near and far, and some from anywhere."""
    vectors = [np.clip(start.vector(), low, high) for start in starts]
    anywhere = count // 5
    for _ in range(STARTS):
        if len(vectors) >= len(starts) + anywhere:
            break
        vector = rng.uniform(low, high)
        layout = Layout.of_vector(vector, starts[0].front_x, starts[0].rear_x)
        if layout.pretension.min() > 3.0:
            vectors.append(vector)
    while len(vectors) < count:
        start = starts[len(vectors) % len(starts)].vector()
        width = 10.0 ** rng.uniform(-2.5, -0.7)
        vectors.append(np.clip(start + width * (high - low) * rng.normal(size=low.size), low, high))
    return vectors[:count]


def _trial(
    members: dict[int, Member], slot: int, low: Array, high: Array, rng: np.random.Generator
) -> Array:
    """A candidate for a slot: towards one of the best, along a difference of two others."""
    ranked = sorted(members, key=lambda one: members[one].cost)
    best = members[ranked[rng.integers(max(2, int(PBEST_SHARE * len(ranked))))]]
    first, second = rng.choice([one for one in members if one != slot], 2, replace=False)
    here = np.array(members[slot].vector)
    if rng.random() < NEAR_SHARE:
        near = np.array(best.vector)
        width = 10.0 ** rng.uniform(-3.5, -1.3) * (high - low)
        few = rng.random(near.size) < 0.3
        return np.asarray(np.clip(near + few * width * rng.normal(size=near.size), low, high))
    factor = rng.uniform(0.3, 0.9)
    towards = np.array(best.vector) - here
    along = np.array(members[int(first)].vector) - np.array(members[int(second)].vector)
    moved = here + factor * (towards + along)
    kept = rng.random(here.size) > rng.uniform(0.3, 1.0)
    kept[rng.integers(here.size)] = False
    trial = np.where(kept, here, moved)
    # Beyond a bound, half way back to it: the bounds stay within reach and nothing piles up there.
    trial = np.where(trial < low, 0.5 * (low + here), trial)
    return np.asarray(np.where(trial > high, 0.5 * (high + here), trial))
