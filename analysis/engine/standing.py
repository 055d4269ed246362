"""A hypothesis where it stands: simulated there, with a difference for every free number."""

from copy import copy
from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.calibrate import Calibrated
from analysis.engine.evidence import Frame, Problem, weigh
from analysis.engine.fine import nuisances_beside, own_columns
from analysis.engine.fitted import Fitted, sigmas_by_name
from analysis.engine.followed import Followed
from analysis.engine.lens import Lens
from analysis.engine.sensitivity import simulate_features, sound
from analysis.engine.state import State
from analysis.engine.system import System, own_nuisances


class Standing:
    """Weighs hypotheses where they stand.

    Parameters
    ----------
    system, lens
        What is simulated and how it is looked at.
    data
        Recorded features, shape (f,).
    calibrated
        The system at its likeliest parameters; its nuisance columns serve throughout, unless
    anew
        What the nuisances do is simulated anew at every step: for a system that is another one
        with a candidate on.
    """

    def __init__(
        self,
        system: System,
        lens: Lens,
        data: Array,
        calibrated: Calibrated,
        *,
        anew: bool = False,
    ) -> None:
        self.system = system
        self.lens = lens
        self.data = data
        self.candidates = {one.name: one for one in system.candidates}
        self._same = own_nuisances(system.nuisances)
        self._problem = calibrated.problem
        self.calibrated = calibrated
        self._rotation = calibrated.rotation
        self.anew = anew
        self._finely = False
        if anew:
            # A number that moves has no error of form, whether it is called cause or nuisance.
            self.candidates |= {
                one.name: replace(one, form_share=0.0)
                for one in system.candidates
                if all((one.name, term.name) in self._same for term in one.terms)
            }
            # A direction that is not seen here may be seen with a candidate on.
            self._rotation = np.eye(len(calibrated.at))
            self._problem = replace(
                calibrated.problem, nuisance=calibrated.columns, at=calibrated.at
            )

    def exact(self) -> Self:
        """The same, for which laws have no error of form."""
        found = copy(self)
        found.candidates = {
            name: replace(one, form_share=0.0) for name, one in self.candidates.items()
        }
        return found

    def finely(self) -> Self:
        """The same, by differences as fine as what they move asks for (`fine`).

        Longer ones see over hollows, and find the valley that these lead through.
        """
        found = copy(self)
        found._finely = True
        return found

    def at(self, state: State, nuisance: Array) -> Fitted:
        """A hypothesis where it stands, without moving it.

        Parameters
        ----------
        state, nuisance
            Its free numbers and the directions of the nuisances.
        """
        return self._at(state, nuisance, self._problem.used)

    def standing(self, state: State, nuisance: Array) -> Fitted:
        """A hypothesis where it stands, from where it is to be led, ring and all.

        Parameters
        ----------
        state, nuisance
            Its free numbers and the nuisances, in sigmas.
        """
        fitted = self.at(state, self.directions_of(nuisance))
        return replace(fitted, point=Followed(nuisance, state).point)

    def directions_of(self, nuisance: Array) -> Array:
        """Nuisances in the directions that can be seen, shape (p,)."""
        return np.asarray(self._rotation.T @ nuisance)

    def score_at(self, state: State, nuisance: Array) -> float:
        """How well a simulation fits as it stands, parameters free within their priors.

        Parameters
        ----------
        state, nuisance
            Its free numbers and the directions of the nuisances.
        """
        point = state.point(self._rotation @ nuisance)
        (features,) = simulate_features(self.system, self.lens, [point])
        if not sound(features).all():
            return -np.inf
        problem = replace(self._problem, residual=self.data - features, at=nuisance)
        return -misfit_by(problem, state, problem.base)

    def _rise(self, best: Fitted, state: State, nuisance: Array) -> tuple[float, Fitted | None]:
        """By how much a step raises the score, and the hypothesis there where that was needed."""
        if self.anew:
            tried = self._at(state, nuisance, best.problem.used)
            return tried.log_score - best.log_score, tried
        # At one variance: the evidence itself would favour whatever claims to do less. And without
        # what everything does there, which many a step is too bad to be worth.
        point = state.point(self._rotation @ nuisance)
        (features,) = simulate_features(self.system, self.lens, [point])
        if not sound(features).all():
            return -np.inf, None
        problem = replace(best.problem, residual=self.data - features, at=nuisance)
        variance = best.weighed.variance
        before = misfit_by(best.problem, best.state, variance)
        return 0.5 * (before - misfit_by(problem, state, variance)), None

    def _at(self, state: State, nuisance: Array, used: NDArray[np.bool_]) -> Fitted:
        """Simulate there, with a difference for every free number."""
        count, names = len(state.free), state.hypothesis.names
        there = self._rotation @ nuisance
        point = state.point(there)
        calm = [state, *(state.without(name) for name in names)] if count or names else []
        points = [point, *(replace(one.point(there), ring="damped") for one in calm)]
        found = simulate_features(self.system, self.lens, points)
        # With numbers far out a simulation may come to nothing.
        whole = bool(sound(found).all())
        found = np.where(sound(found), found, 0.0)
        features, damped = found[0], found[1:]
        columns = np.zeros((len(features), 0))
        if count:
            columns, came = own_columns(
                self.system, self.lens, state, there, damped[0], self._root, fine=self._finely
            )
            whole = whole and came
        done = {name: damped[0] - row for name, row in zip(names, damped[1:], strict=True)}
        order = [k for name in names for k in state.places(name)]
        lows, highs = state.bounds()
        residuals, rows = state.shape_rows()
        problem = replace(self._problem, residual=self.data - features, at=nuisance, used=used)
        if self.anew:
            anew = nuisances_beside(self.system, self.lens, there, point.effects, self._root)
            problem = replace(problem, nuisance=anew)
            columns = self._as_nuisances(state, columns, anew)
        by_name = {name: columns[:, state.places(name)] for name in names}
        weighed = weigh(
            problem,
            by_name,
            done,
            {name: self.candidates[name].form_share for name in names},
            lows[order],
            highs[order],
            (residuals, rows[:, order]),
            rounds=1,
            standing=True,
        )
        back = np.argsort(order) if order else np.zeros(0, dtype=int)
        weighed = replace(
            weighed,
            estimate=weighed.estimate[back],
            covariance=weighed.covariance[np.ix_(back, back)],
            gains=weighed.gains[back],
        )
        spread = np.sqrt(np.maximum(np.diag(weighed.covariance), 0.0))
        sigmas, shape_sigmas = sigmas_by_name(state, spread)
        return Fitted(
            hypothesis=state.hypothesis,
            point=point,
            features=features,
            problem=problem,
            log_score=(
                weighed.log_evidence + state.hypothesis.log_prior(self.candidates)
                if whole and np.isfinite(weighed.log_evidence)
                else -np.inf
            ),
            weighed=weighed,
            values=state.term_values(),
            sigmas=sigmas,
            shape_sigmas=shape_sigmas,
            done=done,
            columns=by_name,
            at_limit=state.at_edge(),
            state=state,
        )

    def _as_nuisances(self, state: State, columns: Array, nuisance: Array) -> Array:
        """Columns, what a nuisance is as well by just what that does: no more is told of either.

        Two differences of one number, each a little off, would tell which of the two it is.
        """
        sigmas = np.array([one.sigma for one in self.system.nuisances])
        columns = columns.copy()
        for k, i in enumerate(state.free):
            number = state.numbers[i]
            tied = [self._same.get((number.candidate, term)) for term in number.terms]
            if tied and None not in tied:
                which = [one for one in tied if one is not None]
                columns[:, k] = (nuisance[:, which] / sigmas[which]).sum(axis=1)
        return columns

    @property
    def _root(self) -> Array:
        """Noise of features, shape (f,); infinity where they do not count, or none is asked for."""
        counts = self._problem.used & self._finely
        return np.where(counts, np.sqrt(self._problem.base), np.inf)


def misfit_of(fitted: Fitted, variance: Array, used: NDArray[np.bool_]) -> float:
    """Of a simulation as it stands, and of its nuisances to their prior."""
    if not np.isfinite(fitted.log_score):
        return float("inf")
    residual, at = fitted.problem.residual[used], fitted.problem.at
    return float((residual**2 / variance[used]).sum() + at @ at)


def misfit_by(problem: Problem, state: State, variance: Array) -> float:
    """Squared misfit by a given variance, parameters free within their priors."""
    shapes, _ = state.shape_rows()
    return Frame(problem, variance).chi2 + float(shapes @ shapes)
