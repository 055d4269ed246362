"""Another law in the place of one that is on: as strong, in the same places."""

from collections.abc import Mapping, Sequence

import numpy as np

from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Part
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State

STRENGTHS = (1.0, 0.8, 0.65, 0.5, 0.4, 0.32, 0.25, 0.2, 0.16, 0.12,
             1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0)  # fmt: skip
"""Sizes that laws are screened at are alike to within so much."""

CLOSER, ROUNDS = 1.13, 6
"""Then closer, first by such a factor, in so many rounds."""

FIRST_PART = 0.2
"""Share of the time that tells how strong the other law is."""


def instead(
    state: State, known: str, other: str, own: Mapping[str, float] | None = None
) -> State | None:
    """A hypothesis with another law in the place of one that is on.

    It is as strong as the one before: each of its magnitudes is as many of the sizes that it is
    screened at. Numbers of shape that both have stay.

    Parameters
    ----------
    state
        With the law that is known.
    known, other
        The two candidates.
    own
        Numbers of shape that only the other law has; those left out have their default.

    Returns
    -------
    State or None
        None: the other law has no such places.
    """
    part, old, new = state.hypothesis.parts[known], state.candidates[known], state.candidates[other]
    values = state.term_values()
    sizes: dict[str, list[float]] = {}
    for term in old.terms:
        if term.name in part.terms:
            sizes.setdefault(term.place, []).append(values[known, term.name] / term.step)
    terms = [one for one in new.terms if one.place in sizes]
    if {one.place for one in terms} != set(sizes):
        return None
    given = {**part.shapes, **(own or {})}
    shapes = {
        one.name: float(np.clip(given.get(one.name, one.default), one.low, one.high))
        for one in new.shapes
    }
    shared = part.shared and new.shareable
    hypothesis = state.hypothesis.without(known)
    hypothesis = hypothesis.plus(other, Part(tuple(one.name for one in terms), shared, shapes))
    strong = {(other, one.name): float(np.mean(sizes[one.place])) * one.step for one in terms}
    if new.grows:
        # Its square: a little of it is as good as none, and led nowhere. As screened, on average.
        mean = float(np.mean([abs(strong[other, one.name]) / one.step for one in terms]))
        strong = {name: value / mean for name, value in strong.items()} if mean else strong
    for one in terms:
        # What one law counts as less another may count as more of something.
        if one.low >= 0.0:
            strong[other, one.name] = abs(strong[other, one.name])
    return State.at(hypothesis, values | strong, state.candidates)


def begun_instead(samples: Samples, law: Followed, known: str, other: str) -> State | None:
    """Give a state with another law in the place of one, as strong as leaves least of the first.

    Parameters
    ----------
    samples
        By which it is told.
    law
        From where that one has come to.
    known, other
        The law that is on, and the other.

    Returns
    -------
    State or None
        None: the other law has no such places.
    """
    if law.state is None or instead(law.state, known, other) is None:
        return None
    return _as_strong(samples, law.nuisance, _alike(samples, law, known, other), other)


def _alike(samples: Samples, law: Followed, known: str, other: str) -> State:
    """With each number of shape that the other law alone has where it leaves least."""
    assert law.state is not None
    own: dict[str, float] = {}
    shared = {one.name for one in law.state.candidates[known].shapes}
    for shape in law.state.candidates[other].shapes:
        if shape.name not in shared and not (shape.whole or shape.term):
            values = (shape.default, shape.low, shape.high)
            tried = [instead(law.state, known, other, {**own, shape.name: one}) for one in values]
            own[shape.name] = values[_least(samples, law.nuisance, tried)]
    found = instead(law.state, known, other, own)
    assert found is not None
    return found


def _least(samples: Samples, nuisance: Array, tried: Sequence[State | None]) -> int:
    """Which of some states leaves least of the first part."""
    points = [Followed(nuisance, one).point for one in tried]
    return int(np.argmin([one @ one for one in samples.residuals(points, FIRST_PART)]))


def _as_strong(samples: Samples, nuisance: Array, state: State, other: str) -> State:
    """With magnitudes that leave least of the first part: by ever smaller factors.

    What the one counts as more of something the other may count as less of it.
    """
    signed = all(one.low < 0.0 for one in state.candidates[other].terms)
    both = (1.0, -1.0) if signed else (1.0,)
    factors, ratio, best = [sign * one for sign in both for one in STRENGTHS], CLOSER, 1.0
    for _ in range(ROUNDS):
        tried = [state.smaller(one, other) for one in factors]
        best = factors[_least(samples, nuisance, tried)]
        factors, ratio = [best / ratio, best, best * ratio], ratio**0.5
    return state.smaller(best, other)
