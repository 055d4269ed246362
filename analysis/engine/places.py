"""Another law of the same thing, in the same places."""

import numpy as np

from analysis.engine.hypothesis import Part
from analysis.engine.state import State


def instead(state: State, known: str, other: str) -> State | None:
    """A hypothesis with another law in the place of one that is on.

    It is as strong as the one before: each of its magnitudes is as many of the sizes that it is
    screened at. Numbers of shape that both have stay.

    Parameters
    ----------
    state
        With the law that is known.
    known, other
        The two candidates.

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
    shapes = {
        one.name: float(np.clip(part.shapes.get(one.name, one.default), one.low, one.high))
        for one in new.shapes
    }
    shared = part.shared and new.shareable
    hypothesis = state.hypothesis.without(known)
    hypothesis = hypothesis.plus(other, Part(tuple(one.name for one in terms), shared, shapes))
    strong = {(other, one.name): float(np.mean(sizes[one.place])) * one.step for one in terms}
    return State.at(hypothesis, values | strong, state.candidates)
