"""Which parameters are off, of all kinds together, where all of them were bent far.

Held to what is known of them, many parameters share what few are off by; and where these are, one
kind after the other does not tell: eight zeros, or anchors of every cable, take up what a centre
of mass and one anchor do. About where they have led to, what each parameter does is known without
a simulation, and so is what any choice of them would leave, were it free: one parameter more, one
less or one instead is led, and asked again from there, for straight lines reach no farther.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from analysis.engine.all_samples import cost_of
from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.evidence import Frame
from analysis.engine.faint import faint
from analysis.engine.faint_search import ASKS
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.kin import lead_from, part_of_the_way
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import limits
from analysis.engine.solve import bounded
from analysis.engine.state import State
from analysis.engine.system import System, own_nuisances

ROUNDS, TRIED = 12, 2
"""So often one parameter is exchanged; so many exchanges are led each time until one is closer."""

MUCH = 0.2
"""And no closer is what takes less than this share of what is left beyond noise: where parameters
are not what is off, they take up a little of it, one after the other."""

Chosen = tuple[int, ...]
"""Places among the numbers."""


def released(
    system: System,
    samples: Samples,
    nothing: Followed,
    candidates: Mapping[str, Candidate],
    most_causes: int,
) -> Iterator[Followed]:
    """Hypotheses of parameters that are free of what is known of them, each closer than before.

    Parameters
    ----------
    system, samples
        What is simulated, and by what it is told.
    nothing
        Parameters alone, bent far.
    candidates
        By name; those are asked whose every term is a nuisance.
    most_causes
        Of a hypothesis.
    """
    numbers = _Numbers(system, candidates)
    if not numbers.names:
        return
    best = nothing
    chosen: Chosen = ()
    tried = {chosen}
    for _ in range(ROUNDS):
        asked = _Asked(system, numbers, best)
        now, found = asked.score(chosen), None
        exchanges = sorted(_exchanges(asked, chosen, most_causes, numbers), reverse=True)
        for score, other in exchanges[:TRIED]:
            if score < now + ASKS or other in tried:
                break
            tried.add(other)
            far = asked.followed(other)
            start = part_of_the_way(samples, best, far)
            assert start.state is not None
            led = lead_from(system, best, start.state, start.nuisance)
            beyond = max(cost_of(best) - len(samples.shares), 0.0)
            if numbers.score(led) > numbers.score(best) + max(ASKS, 0.5 * MUCH * beyond):
                found = led, other
                break
        if found is None:
            return
        best, chosen = found
        yield best


class _Numbers:
    """Terms that are nuisances as well."""

    def __init__(self, system: System, candidates: Mapping[str, Candidate]) -> None:
        same = own_nuisances(system.nuisances)
        self.candidates = [
            one
            for one in candidates.values()
            if not one.fixed and all((one.name, term.name) in same for term in one.terms)
        ]
        self.known = candidates
        self.names = [(one.name, term.name) for one in self.candidates for term in one.terms]
        bounds = [limits(self.known[name], (term,)) for name, term in self.names]
        self.lows, self.highs = np.array(bounds).reshape(-1, 2).T

    def hypothesis(self, chosen: Chosen, like: Followed) -> Hypothesis:
        """Those chosen; shapes as they are where a candidate is on already."""
        terms: dict[str, list[str]] = {}
        for place in chosen:
            name, term = self.names[place]
            terms.setdefault(name, []).append(term)
        on = like.point.effects
        shapes = {
            name: {one.name: one.default for one in self.known[name].shapes}
            | (dict(on[name].shapes) if name in on else {})
            for name in terms
        }
        return Hypothesis({name: Part(tuple(one), False, shapes[name])
                           for name, one in terms.items()})  # fmt: skip

    def score(self, led: Followed) -> float:
        """What speaks for a hypothesis that was led."""
        prior = 0.0 if led.state is None else led.state.hypothesis.log_prior(self.known)
        return prior - 0.5 * cost_of(led) if led.to_end else -np.inf


class _Asked:
    """What any choice of parameters would leave, in straight lines about one that was led."""

    def __init__(self, system: System, numbers: _Numbers, led: Followed) -> None:
        self._numbers, self._led = numbers, led
        self._faint = faint(system, replace(led, about=None), numbers.candidates)
        self._columns = np.hstack([self._faint.terms[one.name, 0] for one in numbers.candidates])
        on = {} if led.state is None else led.state.term_values()
        done = self._columns @ [on.get(one, 0.0) for one in numbers.names]
        problem = self._faint.problem
        self._frame = Frame(replace(problem, residual=problem.residual + done), problem.base)
        self._matrix, self._right = self._frame.normal(self._columns)

    def values(self, chosen: Chosen) -> Array:
        """The likeliest."""
        pick = list(chosen)
        lows, highs = self._numbers.lows[pick], self._numbers.highs[pick]
        return bounded(self._matrix[np.ix_(pick, pick)], self._right[pick], lows, highs)

    def score(self, chosen: Chosen) -> float:
        """What would speak for them, beside nothing."""
        if not chosen:
            return 0.0
        pick, values = list(chosen), self.values(chosen)
        gain = 2.0 * self._right[pick] @ values - values @ self._matrix[np.ix_(pick, pick)] @ values
        hypothesis = self._numbers.hypothesis(chosen, self._led)
        return float(0.5 * gain) + hypothesis.log_prior(self._numbers.known)

    def followed(self, chosen: Chosen) -> Followed:
        """Where straight lines have them."""
        numbers, values = self._numbers, self.values(chosen)
        hypothesis = numbers.hypothesis(chosen, self._led)
        magnitudes = {numbers.names[i]: float(v) for i, v in zip(chosen, values, strict=True)}
        at = self._frame.nuisance(self._columns[:, list(chosen)], values)
        moved = self._faint.rotation @ (at - self._faint.problem.at)
        state = State.at(hypothesis, magnitudes, numbers.known)
        return Followed(self._led.nuisance + moved, state)


def _exchanges(
    asked: _Asked, chosen: Chosen, most_causes: int, numbers: _Numbers
) -> Iterator[tuple[float, Chosen]]:
    """One parameter more, one less, and one instead, with what would speak for each."""
    others = [i for i in range(len(numbers.names)) if i not in chosen]
    found = {tuple(sorted((*rest, i)))
             for rest in [chosen, *_fewer(chosen)] for i in others}  # fmt: skip
    for one in found | {*_fewer(chosen)}:
        if one and len({numbers.names[i][0] for i in one}) <= most_causes:
            yield asked.score(one), one


def _fewer(chosen: Chosen) -> list[Chosen]:
    return [tuple(one for one in chosen if one != out) for out in chosen]
