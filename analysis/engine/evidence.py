"""How well a hypothesis explains the features: Gaussian evidence that forgives a law its form.

The true law is never quite the library's. What a candidate does to a feature is therefore
uncertain by a share of itself, more so at high harmonics; and how large that share is, is itself
not known: the evidence is averaged over several sizes of it. All other parameters are marginalised
over their priors, to first order about where the residual was simulated.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, solve_triangular

from analysis.engine.array import Array
from analysis.engine.labels import Labels
from analysis.engine.solve import bounded, root_beside_one
from analysis.engine.variance import form_variance

FORM_SIZES = (0.03, 0.1, 0.3, 1.0, 3.0)
"""Sizes of the error of form that are averaged over, relative to what a candidate states: some laws
are the true one, and what they do may be a thousand times the noise."""

FORM_WEIGHTS = (0.1, 0.15, 0.25, 0.3, 0.2)

UNSEEN = 0.1
"""A direction of the nuisances that does less than this, in units of noise, is not seen."""

UNSEEN_VARIANCE = 1e-200
"""The pseudo-inverse has next to none for a number that does nothing."""

FOLLOWED = 0.25
"""Of what nuisances take back of a change, this share counts as the law's."""


@dataclass(frozen=True)
class Problem:
    """What is left to explain.

    Parameters
    ----------
    residual
        Recorded less simulated features, in units of noise, shape (f,).
    nuisance
        What one sigma of each direction of the nuisances does, shape (f, p).
    at
        Where they were in that simulation, in sigmas, shape (p,).
    base
        Variance of the features without any candidate, shape (f,).
    labels
        What each feature is.
    used
        Which features count, shape (f,).
    coloured
        Whether an error of form has the colour of all that a law does, as where every line is
        looked at; else what the nuisances take back of it is not seen.
    """

    residual: Array
    nuisance: Array
    at: Array
    base: Array
    labels: Labels
    used: NDArray[np.bool_]
    coloured: bool = False

    @cached_property
    def _at_base(self) -> "Frame":
        return Frame(self, self.base)

    def beyond(self, done: Array) -> Array:
        """A change less most of what the nuisances can take back of it, shape (f,).

        What they take back is not seen, however wrong a law is about it; but they cannot follow
        every error of form of what they can follow as a whole.
        """
        if self.coloured:
            return done
        left = done - self.nuisance @ self._at_base.absorbed(done)
        return np.asarray(np.hypot(left, FOLLOWED * done))


@dataclass(frozen=True)
class Weighed:
    """Evidence for one set of columns.

    Attributes
    ----------
    log_evidence
        Averaged over the sizes of the error of form.
    estimate, covariance
        Of the columns' factors, at the likeliest size, shapes (k,), (k, k).
    nuisance
        The likeliest directions of the nuisances, in sigmas, shape (p,).
    chi2
        Of the residual under the prior, at the likeliest size.
    variance
        Of the features at the likeliest size, shape (f,).
    gains
        For each column, by how much chi2 would rise without it alone, shape (k,).
    gain
        By how much chi2 would fall, were the factors added.
    """

    log_evidence: float
    estimate: Array
    covariance: Array
    nuisance: Array
    chi2: float
    variance: Array
    gains: Array
    gain: float


class Frame:
    """A problem with given variances: everything that does not depend on the columns, once."""

    def __init__(self, problem: Problem, variance: Array) -> None:
        used = problem.used
        self.root = np.sqrt(variance[used])
        self._used = used
        # The residual as it would be with all nuisances at their prior mean.
        whole = problem.residual + problem.nuisance @ problem.at
        self.r = whole[used] / self.root
        self.j = problem.nuisance[used] / self.root[:, None]
        self._factor = root_beside_one(self.j)
        self._jr = self._half(self.j.T @ self.r)
        self.chi2 = float(self.r @ self.r - self._jr @ self._jr)
        self.log_determinant = float(
            2.0 * np.log(self.root).sum() + 2.0 * np.log(np.diag(self._factor)).sum()
        )

    def _half(self, right: Array) -> Array:
        solved: Array = solve_triangular(self._factor, right, lower=True, check_finite=False)
        return solved

    def normal(self, columns: Array) -> tuple[Array, Array]:
        """Normal equations of columns, shape (f, k): their matrix and right side."""
        a = columns[self._used] / self.root[:, None]
        ja = self._half(self.j.T @ a)
        return a.T @ a - ja.T @ ja, a.T @ self.r - ja.T @ self._jr

    def absorbed(self, change: Array) -> Array:
        """By how much the nuisances would move to take a change back, shape (p,)."""
        moved = self.j.T @ (change[self._used] / self.root)
        return np.asarray(cho_solve((self._factor, True), moved))

    def nuisance(self, columns: Array, estimate: Array) -> Array:
        """The likeliest nuisances, given the columns' factors."""
        rest = self.r - (columns[self._used] / self.root[:, None]) @ estimate
        found: Array = cho_solve((self._factor, True), self.j.T @ rest)
        return found


def _inverse(matrix: Array) -> Array:
    """Pseudo-inverse of a symmetric matrix, whatever the units of its numbers, shape (k, k)."""
    if not matrix.size:
        return matrix
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale[scale == 0.0] = 1.0
    units = np.outer(scale, scale)
    if not np.isfinite(matrix / units).all():
        # What was simulated came to nothing: nothing is known of any of them.
        return np.diag(np.full(len(matrix), np.inf))
    return np.asarray(np.linalg.pinv(matrix / units) / units, dtype=float)


def directions(nuisance: Array, base: Array, used: NDArray[np.bool_]) -> Array:
    """Directions among the nuisances that can be seen at all, shape (nuisances, p).

    Nuisances are independent and of unit variance, and so are orthonormal directions among them;
    those that move no feature by a share of its noise stay at their prior, and are left out.

    Parameters
    ----------
    nuisance
        What one sigma of each does, shape (f, nuisances).
    base
        Variance of the features, shape (f,).
    used
        Which features count.
    """
    seen = nuisance[used] / np.sqrt(base[used])[:, None]
    values, vectors = np.linalg.eigh(seen.T @ seen)
    return np.asarray(vectors[:, values > UNSEEN**2])


def weigh(
    problem: Problem,
    columns: Mapping[str, Array],
    done: Mapping[str, Array],
    shares: Mapping[str, float],
    lows: Array | None = None,
    highs: Array | None = None,
    prior: tuple[Array, Array] | None = None,
    rounds: int = 3,
    standing: bool = False,
    sizes: Sequence[float] = FORM_SIZES,
) -> Weighed:
    """Evidence for candidates whose columns are given.

    Parameters
    ----------
    problem
        What is left to explain. Where it was simulated with the candidates on, the factors of the
        columns are what is to be added.
    columns
        Candidate -> its columns, shape (f, k).
    done
        Candidate -> what it does already in the problem's simulation, shape (f,).
    shares
        Candidate -> its error of form.
    lows, highs
        Bounds of the factors, shape (k,).
    prior
        Rows beside the features, as if the factors had been measured: residuals (s,) and columns
        (s, k).
    rounds
        How often what the candidates do is taken again from the estimate.
    standing
        Evidence of the simulation as it stands: what the factors would still add only tells where
        to go, the nuisances may still move. Otherwise the evidence with the factors added.
    sizes
        Of the error of form.
    """
    names = list(columns)
    widths = [columns[name].shape[1] for name in names]
    ends = np.cumsum([0, *widths])
    size_all = int(problem.residual.size)
    stacked = np.hstack([columns[name] for name in names]) if names else np.zeros((size_all, 0))
    logs, kept = [], []
    for size in sizes if names else (1.0,):
        estimate = np.zeros(stacked.shape[1])
        for turn in range(rounds if names else 1):
            spread = np.zeros(size_all)
            for i, name in enumerate(names):
                does = done[name]
                if not standing:
                    # Before there is an estimate, what is to be explained stands for it.
                    does = does + (
                        columns[name] @ estimate[ends[i] : ends[i + 1]]
                        if turn
                        else problem.residual
                    )
                # Errors of form add up: what one law does is not surer for being shared by two.
                beyond = problem.beyond(does)
                own = form_variance(problem.labels, does, shares[name], size, beyond)
                spread += np.sqrt(own)
            variance = problem.base + spread**2
            frame = Frame(problem, variance)
            matrix, right = frame.normal(stacked)
            chi2 = frame.chi2
            if prior is not None:
                matrix = matrix + prior[1].T @ prior[1]
                right = right + prior[1].T @ prior[0]
                chi2 += float(prior[0] @ prior[0])
            estimate = bounded(matrix, right, lows, highs)
        gain = float(2.0 * right @ estimate - estimate @ matrix @ estimate)
        chi2 -= gain
        logs.append(-0.5 * (chi2 + (gain if standing else 0.0) + frame.log_determinant))
        kept.append((estimate, matrix, frame, chi2, variance, gain))
    weights = FORM_WEIGHTS if len(logs) == len(FORM_WEIGHTS) else (1.0,) * len(logs)
    best = int(np.argmax(np.array(logs) + np.log(weights)))
    log_evidence = float(np.logaddexp.reduce(np.array(logs) + np.log(weights)))
    estimate, matrix, frame, chi2, variance, gain = kept[best]
    covariance = _inverse(matrix)
    variances = np.diag(covariance)
    # What does nothing here explains nothing.
    gains = np.divide(
        estimate**2, variances, out=np.zeros_like(estimate), where=variances > UNSEEN_VARIANCE
    )
    return Weighed(
        log_evidence=log_evidence,
        estimate=estimate,
        covariance=covariance,
        nuisance=frame.nuisance(stacked, estimate),
        chi2=chi2,
        variance=variance,
        gains=gains,
        gain=gain,
    )
