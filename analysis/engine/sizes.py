"""Causes of any size, weighed over the stretch in which the motion is lost.

Straight lines about where parameters alone came tell what a little of a cause would do. What is
strong need not do more of the same: a wheel that has to be turned lowers every tone, and a motion
that lasts for many periods is soon nowhere near. So each cause is simulated in every size, in all
of its places alike, over the stretch beyond which nothing leads; parameters make up for what they
can, in straight lines. What lines told of single places is weighed among them.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import solve_triangular

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.differences import differences
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import limits
from analysis.engine.solve import root_beside_one
from analysis.engine.state import State
from analysis.engine.system import System
from analysis.engine.way import WINDOWS

SIZES = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Of the size at which a cause is screened: a strong one is anywhere among them."""

BEYOND = 2
"""Windows beyond where parameters alone lead: in the first there may be hardly any motion."""

FORMS, NEARLY = 5, 0.95
"""The likeliest cause is kept in so many forms, where each says this share of what the best does:
a step from a wrong one may lead nowhere, and which is wrong so short a stretch does not tell."""

LONGEST = 0.3
"""Of the time: what parameters can make up for over longer than that is little, and straight lines
tell it; so much more would have to be simulated."""


def in_any_size(
    system: System,
    candidates: Mapping[str, Candidate],
    nothing: Followed,
    told: Sequence[Guess] = (),
) -> list[Guess]:
    """Single causes where the motion is lost, the best first.

    Parameters
    ----------
    system
        What is simulated.
    candidates
        By name.
    nothing
        How far parameters alone led.
    told
        What straight lines told.

    Returns
    -------
    list of Guess
        What was told, and each cause in its likeliest size and form, the likeliest in others too,
        with the rise of the score over that stretch; as it was told, where the motion is not lost
        as it begins.
    """
    at = nothing.about or nothing
    share = [one for one in WINDOWS if one > min(at.telling, WINDOWS[-2])][:BEYOND][-1]
    if share > LONGEST:
        return list(told)
    samples = Samples(system, everything=True)
    base = Followed(at.nuisance, None)
    (here,) = samples.residuals([base.point], share)
    made_up = _MadeUp(samples, base, here, share)
    alone = made_up.cost(here)

    def rises(states: Sequence[State]) -> list[float]:
        points = [Followed(base.nuisance, one).point for one in states]
        left = samples.residuals(points, share)
        return [0.5 * (alone - made_up.cost(one)) for one in left]

    found, forms = [], dict[str, list[Guess]]()
    for candidate in candidates.values():
        states = list(_in_sizes(candidate, candidates))
        if states:
            told_of = zip(states, rises(states), strict=True)
            sized = [Guess(one, base.nuisance, rise) for one, rise in told_of]
            forms[candidate.name] = _of_each_form(sized)
            found.append(forms[candidate.name][0])
    again = rises([one.state for one in told])
    found += [replace(one, log_score=rise) for one, rise in zip(told, again, strict=True)]
    if found:
        first = max(found, key=lambda one: one.log_score)
        found += _as_likely(forms, first)
    return sorted(found, key=lambda one: -one.log_score)


def _of_each_form(sized: Sequence[Guess]) -> list[Guess]:
    """The likeliest size of each form, the likeliest first."""
    best: dict[object, Guess] = {}
    for one in sorted(sized, key=lambda one: -one.log_score):
        shapes = (tuple(sorted(part.shapes.items())) for part in one.hypothesis.parts.values())
        best.setdefault((one.hypothesis.key, *shapes), one)
    return list(best.values())


def _as_likely(forms: Mapping[str, Sequence[Guess]], first: Guess) -> list[Guess]:
    """The first in other forms than its likeliest that say nearly as much, all places alike."""
    (name,) = first.hypothesis.names
    others = forms.get(name, ())[1:FORMS]
    return [one for one in others if one.log_score > NEARLY * first.log_score]


class _MadeUp:
    """What is left after parameters have made up for what they can, in straight lines.

    Parameters
    ----------
    samples
        By which it is told.
    base, here
        Parameters alone, and what they leave, shape (n,).
    share
        Of the time.
    """

    def __init__(self, samples: Samples, base: Followed, here: Array, share: float) -> None:
        self._inside = samples.shares <= share
        columns, _ = differences(samples, base, here, share)
        self._does = columns[:, self._inside].T
        self._factor = root_beside_one(self._does)
        self._moved = self._does @ base.nuisance

    def cost(self, residual: Array) -> float:
        """Squared misfit and strain, where parameters have moved.

        Parameters
        ----------
        residual
            Before they have, shape (n,).
        """
        # As it would be with all of them where they are likeliest beforehand.
        whole = residual[self._inside] + self._moved
        taken = solve_triangular(self._factor, self._does.T @ whole, lower=True, check_finite=False)
        cost = float(whole @ whole - taken @ taken)
        return cost if np.isfinite(cost) else np.inf


def _in_sizes(candidate: Candidate, candidates: Mapping[str, Candidate]) -> Iterator[State]:
    """One cause in every size and form, each of its magnitudes alone, in all places alike."""
    if candidate.fixed:
        return
    none = State.at(Hypothesis(), {}, candidates)
    names = tuple(one.name for one in candidate.terms)
    steps = {one.name: one.step for one in candidate.terms}
    groups = candidate.groups(names, candidate.shareable)
    if candidate.together:
        groups = (names,)
    for terms in groups:
        low, high = limits(candidate, terms)
        for shapes in candidate.variants():
            part = Part(terms, candidate.shareable and len(terms) > 1, shapes)
            for size in (*SIZES, *(-one for one in SIZES)):
                if all(low <= size * steps[one] <= high for one in terms):
                    yield none.plus(candidate.name, part, {one: size * steps[one] for one in terms})
