"""Screening: every candidate, alone and beside others, weighed to first order."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.choices import Choice, choices, limits_of
from analysis.engine.evidence import FORM_SIZES, Frame, Problem, Weighed, weigh
from analysis.engine.hypothesis import Hypothesis, Part, part_log_prior
from analysis.engine.variance import form_variance

if TYPE_CHECKING:
    from analysis.engine.state import State

LOOSE_FORM = 1.5
"""To first order a law is less certain than simulated: its error of form, times this."""


SEVERAL, QUICK = 5, (1.0,)
"""So many choices of terms are weighed, first with this size of the error of form alone."""


@dataclass(frozen=True)
class Scored:
    """A hypothesis and how well it explains.

    Attributes
    ----------
    hypothesis
        Candidates and terms.
    log_score
        Evidence times prior odds, as a logarithm.
    weighed
        The evidence in detail; factors are those of `values`.
    values
        (candidate, term) -> magnitude.
    looked
        Of candidates that are not on yet, which of their columns it was told by.
    """

    hypothesis: Hypothesis
    log_score: float
    weighed: Weighed
    values: Mapping[tuple[str, str], float]
    looked: Mapping[str, int] = field(default_factory=dict)


class Screen:
    """Weighs hypotheses to first order about one simulated point.

    Parameters
    ----------
    problem
        What is left to explain there.
    candidates
        By name.
    terms
        (candidate, look) -> columns, shape (f, k): one for each variant of its shapes, and where
        there are more, one for each again.
    on
        What is on already in the problem's simulation: candidate -> its part; `done` has what it
        does to the features.
    done, own
        Candidate -> what it does, shape (f,), and columns of its free numbers, shapes among them.
    state
        Those numbers.
    moved
        As for `part_log_prior`: where nothing found is led on, shapes are only looked at.
    """

    def __init__(
        self,
        problem: Problem,
        candidates: Mapping[str, Candidate],
        terms: Mapping[tuple[str, int], Array],
        on: Hypothesis | None = None,
        done: Mapping[str, Array] | None = None,
        own: Mapping[str, Array] | None = None,
        state: "State | None" = None,
        *,
        moved: bool = True,
    ) -> None:
        self.problem = problem
        self.candidates = candidates
        self.terms = terms
        self.on = on or Hypothesis()
        self._done = dict(done or {})
        self._own = dict(own or {})
        self._state = state
        self._moved = moved
        self._frames: dict[float, Frame] = {}

    def null(self) -> Scored:
        """What is on already, and nothing else."""
        return self._score(self.on, {}, ())

    def best_of(self, name: str) -> Scored | None:
        """The best choice of terms and shapes of one more candidate; None: none helps."""
        several = self.several_of(name)
        if not several:
            return None
        # The quick score has but one size of the error of form, and that is for those that do
        # little, however little of it they explain: what explains most for its numbers is weighed
        # in full as well.
        first, best = several[0], max(several, key=lambda one: one.log_score)
        alike = {(one.hypothesis.key, one.looked[name]): one for one in (best, first)}
        whole = (self._score(one.hypothesis, one.looked, (name,)) for one in alike.values())
        return max(whole, key=lambda one: one.log_score)

    def several_of(self, name: str) -> list[Scored]:
        """Choices of terms and shapes of one more candidate that are among the best.

        In the order of what they explain for their numbers, with what is on as it is; their scores
        are quick ones, with what may move.
        """
        candidate = self.candidates[name]
        found: list[tuple[float, int, tuple[str, ...], bool]] = []
        for v, shapes in self._looks(candidate):
            for terms, shared, gain in self._choices(candidate, self.terms[name, v]):
                part = Part(terms, shared, shapes)
                prior = part_log_prior(candidate, part, moved=self._moved)
                found.append((0.5 * gain + prior, v, terms, shared))
        # The quick score has the variance of what is on only; the best few are weighed in full.
        found.sort(key=lambda one: -one[0])
        chosen: dict[tuple[tuple[str, ...], bool], int] = {}
        for _, v, terms, shared in found:
            if len(chosen) < SEVERAL:
                chosen.setdefault((terms, shared), v)
        return [
            self._score(
                self.on.plus(name, Part(terms, shared, _shapes(candidate, v))),
                {name: v}, (name,), QUICK,
            )
            for (terms, shared), v in chosen.items()
        ]  # fmt: skip

    def with_terms(self, name: str, terms: tuple[str, ...]) -> Scored:
        """One more candidate with given terms, each its own value, at its first variant."""
        return self.with_part(name, Part(terms, False, self.candidates[name].variants()[0]))

    def with_part(self, name: str, part: Part, like: Scored | None = None) -> Scored:
        """One more candidate with given terms and shapes, looked at as another with the same."""
        if like is None:
            look = list(self.candidates[name].variants()).index(dict(part.shapes))
        else:
            look = like.looked[name]
        return self._score(self.on.plus(name, part), {name: look}, (name,))

    def _looks(self, candidate: Candidate) -> Iterator[tuple[int, Mapping[str, float]]]:
        """What was looked at of a candidate, and with which shapes."""
        v = 0
        while (candidate.name, v) in self.terms:
            yield v, _shapes(candidate, v)
            v += 1

    def _choices(self, candidate: Candidate, columns: Array) -> Iterator[Choice]:
        """Sets of its terms worth weighing."""
        frame, own = self._quick_frame(candidate)
        stacked = np.hstack([own, columns])
        matrix, right = frame.normal(stacked)
        fixed = own.shape[1]
        if fixed:
            # What is on may move as well.
            inner = np.linalg.pinv(matrix[:fixed, :fixed])
            cross = matrix[fixed:, :fixed] @ inner
            right = right[fixed:] - cross @ right[:fixed]
            matrix = matrix[fixed:, fixed:] - cross @ matrix[:fixed, fixed:]
        return choices(candidate, matrix, right)

    def _quick_frame(self, candidate: Candidate) -> tuple[Frame, Array]:
        share = candidate.form_share * LOOSE_FORM
        if share not in self._frames:
            # Whatever explains the residual is uncertain by a share of it.
            labels = self.problem.labels
            spread = np.sqrt(form_variance(labels, self.problem.residual, share, 1.0))
            for name, done in self._done.items():
                own_share = self.candidates[name].form_share * LOOSE_FORM
                spread += np.sqrt(form_variance(labels, done, own_share, 1.0))
            self._frames[share] = Frame(self.problem, self.problem.base + spread**2)
        own = (
            np.hstack(list(self._own.values()))
            if self._own
            else np.zeros((len(self.problem.residual), 0))
        )
        return self._frames[share], own

    def _score(
        self,
        hypothesis: Hypothesis,
        variants: Mapping[str, int],
        new: tuple[str, ...],
        sizes: Sequence[float] = FORM_SIZES,
    ) -> Scored:
        columns: dict[str, Array] = dict(self._own)
        done = dict(self._done)
        lows: list[float] = []
        highs: list[float] = []
        prior: tuple[Array, Array] | None = None
        values: dict[tuple[str, str], float] = {}
        kept = 0
        if self._state is not None and self._own:
            low, high = self._state.bounds()
            order = [k for name in self._own for k in self._state.places(name)]
            lows, highs = list(low[order]), list(high[order])
            residuals, rows = self._state.shape_rows()
            prior = (residuals, rows[:, order])
            kept = len(order)
        for name in new:
            part = hypothesis.parts[name]
            candidate = self.candidates[name]
            columns[name] = grouped(candidate, self.terms[name, variants[name]], part)
            done[name] = np.zeros(len(self.problem.residual))
            for group in part.groups(candidate):
                low_one, high_one = limits(candidate, group)
                lows.append(low_one)
                highs.append(high_one)
        if prior is not None:
            wider = np.zeros((len(prior[0]), len(lows) - kept))
            prior = (prior[0], np.hstack([prior[1], wider]))
        shares = {name: self.candidates[name].form_share * LOOSE_FORM for name in columns}
        weighed = weigh(
            self.problem,
            columns,
            done,
            shares,
            np.array(lows),
            np.array(highs),
            prior,
            rounds=2,
            sizes=sizes,
        )
        if self._state is not None:
            moved = np.zeros(len(self._state.free))
            for place, k in enumerate(order if self._own else []):
                moved[k] = weighed.estimate[place]
            values |= self._state.moved(moved).term_values()
        at = kept
        for name in new:
            for group in hypothesis.parts[name].groups(self.candidates[name]):
                value = magnitude(self.candidates[name], group, float(weighed.estimate[at]))
                values |= {(name, term): value for term in group}
                at += 1
        score = weighed.log_evidence + hypothesis.log_prior(self.candidates, moved=self._moved)
        return Scored(hypothesis, score, weighed, values, variants)


def _shapes(candidate: Candidate, look: int) -> Mapping[str, float]:
    """The shapes of a look."""
    variants = candidate.variants()
    return variants[look % len(variants)]


def grouped(candidate: Candidate, columns: Array, part: Part) -> Array:
    """Columns of terms, those with one value added up, shape (f, free numbers)."""
    names = [term.name for term in candidate.terms]
    return np.stack(
        [
            columns[:, [names.index(one) for one in group]].sum(axis=1)
            for group in part.groups(candidate)
        ],
        axis=1,
    )


def magnitude(candidate: Candidate, group: tuple[str, ...], factor: float) -> float:
    """The magnitude of terms that do so many times what their columns hold.

    What grows as the square of its magnitude was screened at its whole step: there alone a factor
    is a magnitude.
    """
    if not candidate.grows:
        return factor
    step = next(term.step for term in candidate.terms if term.name == group[0])
    return float(np.copysign(np.sqrt(abs(factor * step)), factor))


def limits(candidate: Candidate, group: tuple[str, ...]) -> tuple[float, float]:
    """Bounds of a group's value."""
    on = np.array([term.name in group for term in candidate.terms])
    lows, highs = limits_of(candidate)
    return float(lows[on].max()), float(highs[on].min())
