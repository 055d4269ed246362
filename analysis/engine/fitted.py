"""A fitted hypothesis: where it stands, what it leaves, and how sure its numbers are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from analysis.engine.array import Array
from analysis.engine.evidence import Problem, Weighed
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.state import State
from analysis.engine.system import Point

Causes = Mapping[str, Mapping[str, float]]
"""Candidate -> term -> magnitude."""


@dataclass(frozen=True)
class Fitted:
    """A hypothesis at its best.

    Attributes
    ----------
    hypothesis
        With the fitted shapes.
    point
        What was simulated: the best.
    features
        Simulated there, shape (f,).
    problem
        What is left there.
    log_score
        Evidence times prior odds, as a logarithm.
    weighed
        The evidence in detail; its factors are what could still be added.
    values, sigmas
        (candidate, term) -> magnitude and its standard deviation.
    shape_sigmas
        (candidate, shape) -> standard deviation, of the logarithm where it counts so.
    done, columns
        Candidate -> what it does to the features there, shape (f,), and its columns, (f, k).
    at_limit
        (candidate, number) that ended at the edge of its plausible range.
    state
        The free numbers.
    left
        Squared misfit of a sample, ring and all, on average; not a number where it was not led to
        the ring's phase.
    elsewhere
        The same causes in other places, that are about as likely, the likeliest first.
    """

    hypothesis: Hypothesis
    point: Point
    features: Array
    problem: Problem
    log_score: float
    weighed: Weighed
    values: Mapping[tuple[str, str], float]
    sigmas: Mapping[tuple[str, str], float]
    shape_sigmas: Mapping[tuple[str, str], float]
    done: Mapping[str, Array]
    columns: Mapping[str, Array]
    at_limit: tuple[tuple[str, str], ...]
    state: State
    left: float = nan
    elsewhere: tuple[Causes, ...] = ()

    @property
    def strain(self) -> float:
        """What parameters cost: how far they are from what is known of them, squared, in sigmas."""
        return float(self.point.nuisance @ self.point.nuisance)

    def also_in(self, others: Sequence[Causes]) -> "Fitted":
        """With other places that are about as likely, each set of places once."""
        found = list(self.elsewhere)
        for one in others:
            if all(_terms(one) != _terms(known) for known in found):
                found.append(one)
        return replace(self, elsewhere=tuple(found))

    def as_sure(self, spread: Array) -> "Fitted":
        """With other standard deviations of its free numbers, shape (numbers,)."""
        sigmas, shape_sigmas = sigmas_by_name(self.state, spread)
        return replace(self, sigmas=sigmas, shape_sigmas=shape_sigmas)

    @property
    def remaining(self) -> Array:
        """What is left of features where nuisances are likeliest, shape (f,)."""
        return self.problem.residual + self.problem.nuisance @ (
            self.problem.at - self.weighed.nuisance
        )

    @property
    def lines_left(self) -> float:
        """The square of that over its variance, error of form and all, on average."""
        used = self.problem.used
        return float(np.mean(self.remaining[used] ** 2 / self.weighed.variance[used]))


def by_cause(names: Sequence[str], values: Mapping[tuple[str, str], float]) -> Causes:
    """Causes and what is on of each.

    Parameters
    ----------
    names
        Of the causes.
    values
        (candidate, term) -> magnitude, of these.
    """
    found: dict[str, dict[str, float]] = {name: {} for name in names}
    for (name, term), value in values.items():
        found[name][term] = value
    return found


def _terms(causes: Causes) -> dict[str, set[str]]:
    """Those that are on of each cause."""
    return {name: set(values) for name, values in causes.items()}


def sigmas_by_name(
    state: State, spread: Array
) -> tuple[dict[tuple[str, str], float], dict[tuple[str, str], float]]:
    """Standard deviations of free numbers: (candidate, term) -> its, and (candidate, shape) -> its.

    Parameters
    ----------
    state
        The free numbers.
    spread
        Of each, shape (numbers,).
    """
    sigmas, shape_sigmas = {}, {}
    for sigma, i in zip(spread.tolist(), state.free, strict=True):
        number = state.numbers[i]
        for term in number.terms:
            sigmas[number.candidate, term] = sigma
        if number.shape is not None:
            shape_sigmas[number.candidate, number.shape.name] = sigma
    return sigmas, shape_sigmas
