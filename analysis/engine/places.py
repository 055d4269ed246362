"""Places again: what was led to the end is asked in which places it is, for there they are told.

Over the short stretch where a search begins, places that are on tie with others, and parameters
stand for those that are left out. At the end what a cause does is given back, and it is asked
itself once more, in any places.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.exchange import Exchange, without
from analysis.engine.faint import Faint
from analysis.engine.faint_search import ASKS
from analysis.engine.fitted import Causes, by_cause
from analysis.engine.hypothesis import Part
from analysis.engine.screen import Screen


def is_placed(candidate: Candidate) -> bool:
    """Whether it can be in some places only, of which straight lines tell."""
    whole = candidate.fixed or candidate.together or candidate.grows
    return len(candidate.terms) > 1 and not whole


def placed_again(
    found: Faint, candidates: Mapping[str, Candidate], noise: float = 1.0
) -> list[Exchange]:
    """Hypotheses with one of the causes that are on in other places, the best first.

    Parameters
    ----------
    found
        About a hypothesis that was led to the end, at its end; a cause without `terms` is not
        asked.
    candidates
        By name.
    noise
        Variance along each direction, the error of form of what is on included: what it leaves has
        told how large that is.
    """
    promised: list[Exchange] = []
    for name, part, screen in _asked_again(found, candidates, noise):
        itself = screen.with_part(name, Part(part.terms, part.shared))
        other = screen.best_of(name)
        if other is None:
            continue
        there = replace(other.hypothesis.parts[name], shapes=part.shapes)
        # What needs fewer numbers is worth asking for itself.
        own = candidates[name]
        fewer = len(there.groups(own)) < len(part.groups(own))
        asks = 0.0 if fewer else ASKS
        if other.log_score < itself.log_score + asks:
            continue
        scored = replace(other, hypothesis=other.hypothesis.plus(name, there))
        promised.append(Exchange(other.log_score - itself.log_score, scored))
    return sorted(promised, key=lambda one: -one.ahead)


def as_likely_in(
    found: Faint, candidates: Mapping[str, Candidate], noise: float, behind: float
) -> list[Causes]:
    """The causes that are on, one of them in other places that are about as likely.

    Parameters
    ----------
    found, candidates, noise
        As for `placed_again`.
    behind
        By how much the score may be lower.

    Returns
    -------
    list
        The likeliest first.
    """
    told: list[tuple[float, Causes]] = []
    for name, part, screen in _asked_again(found, candidates, noise):
        itself = screen.with_part(name, Part(part.terms, part.shared))
        for other in screen.several_of(name):
            less = itself.log_score - other.log_score
            if other.hypothesis.parts[name].terms != part.terms and less < behind:
                told.append((less, by_cause(other.hypothesis.names, other.values)))
    return [causes for _, causes in sorted(told, key=lambda one: one[0])]


def _asked_again(
    found: Faint, candidates: Mapping[str, Candidate], noise: float
) -> Iterator[tuple[str, Part, Screen]]:
    """Causes that are on and in places, the part of each, and what is there to explain without."""
    state = found.followed.state
    base = np.maximum(found.problem.base, noise)
    found = replace(found, problem=replace(found.problem, base=base))
    for name, part in () if state is None else state.hypothesis.parts.items():
        if is_placed(candidates[name]) and (name, 0) in found.terms:
            # Its shapes stay as they are.
            asked = replace(candidates[name], shapes=(), form_share=0.0)
            yield name, part, without(found, {**candidates, name: asked}, name)
