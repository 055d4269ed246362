"""Where a candidate acts, such as on which cables."""

from dataclasses import replace

from analysis.engine.state import State

LITTLE = 0.1
"""Of the size that a term is screened at: with so much it starts in a new place."""


def places_of(state: State, name: str) -> frozenset[str]:
    """The places where a candidate is on."""
    on = set(state.hypothesis.parts[name].terms)
    return frozenset(one.place for one in state.candidates[name].terms if one.name in on)


def placed(state: State, name: str, places: frozenset[str]) -> State:
    """With a candidate in some places; the same state, where it has no such places."""
    terms = [one for one in state.candidates[name].terms if one.place in places]
    if {one.place for one in terms} != places:
        return state
    part = state.hypothesis.parts[name]
    chosen = tuple(one.name for one in terms)
    shared = part.shared and set(chosen) == set(part.terms)
    hypothesis = state.hypothesis.plus(name, replace(part, terms=chosen, shared=shared))
    little = {(name, one.name): LITTLE * one.step for one in terms}
    return State.at(hypothesis, little | state.term_values(), state.candidates)
