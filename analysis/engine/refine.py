"""A hypothesis fitted in earnest: simulated again with everything free, until it stays."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis.engine.calibrate import Calibrated
from analysis.engine.evidence import Frame, Problem, weigh
from analysis.engine.fine import nuisances_beside, own_columns
from analysis.engine.fitted import Fitted, sigmas_by_name
from analysis.engine.followed import Followed
from analysis.engine.lens import Lens
from analysis.engine.screen import Scored, Screen
from analysis.engine.sensitivity import simulate_features, sound
from analysis.engine.sharpen import sharpened
from analysis.engine.state import State
from analysis.engine.system import Array, System

ROUNDS = 5
"""Of simulating and solving."""

SETTLED = 0.5
"""Rounds end when the score rises by less than this."""

FAR_SIGMAS = 3.0
"""A fit starts with no nuisance farther out than this."""

SHORTER = 0.4
"""A step that went too far is taken again, this much of it."""

MOST_SETTLING, STILL = 6, 0.01
"""Steps to where the nuisances are likeliest, and what is no step, in sigmas."""

SHORTEST = 2
"""And so often."""

ROUNDS_ANEW, SHORTEST_ANEW = 20, 5
"""The same where everything is simulated anew: the way is longer."""

PATIENCE_ANEW = 4
"""And what a hypothesis promises is asked for after so many steps only: the first tell little."""


class Refiner:
    """Fits hypotheses.

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
        self._problem = calibrated.problem
        self.calibrated = calibrated
        self._rotation = calibrated.rotation
        self.anew = anew
        self._finely = False
        if anew:
            # A direction that is not seen here may be seen with a candidate on.
            self._rotation = np.eye(len(calibrated.at))
            self._problem = replace(
                calibrated.problem, nuisance=calibrated.columns, at=calibrated.at
            )

    def exact(self) -> "Refiner":
        """The same, for which laws have no error of form."""
        found = copy(self)
        found.candidates = {
            name: replace(one, form_share=0.0) for name, one in self.candidates.items()
        }
        return found

    def finely(self) -> "Refiner":
        """The same, by differences as fine as what they move asks for (`fine`).

        Longer ones see over hollows, and find the valley that these lead through.
        """
        found = copy(self)
        found._finely = True
        return found

    def nothing(self) -> Fitted:
        """Nothing left out, parameters fitted."""
        return self.fit(Screen(self.calibrated.problem, self.candidates, {}).null())

    def fit(self, start: Scored, rounds: int = ROUNDS, at_least: float = -np.inf) -> Fitted:
        """From a screened hypothesis to a fitted one.

        Parameters
        ----------
        start
            The screened hypothesis.
        rounds
            Of simulating and solving, at most.
        at_least
            A hypothesis that after a step does not promise to come so far is left where it is.
        """
        nuisance = np.clip(start.weighed.nuisance, -FAR_SIGMAS, FAR_SIGMAS)
        state, used = State.of(start, self.candidates), self._problem.used
        state = sharpened(state, lambda there: self.score_at(there, nuisance), everywhere=False)
        return self._improve(state, nuisance, used, rounds, at_least)

    def fit_from(self, starts: Sequence[Scored], most: int) -> Fitted:
        """The best fit of one set of candidates from several starts, the best of which are tried.

        Parameters
        ----------
        starts
            Where to begin.
        most
            So many are fitted to the end.
        """
        used = self._problem.used
        begun = []
        for start in starts:
            state, nuisance = State.of(start, self.candidates), start.weighed.nuisance
            begun.append((self._at(state, nuisance, used).log_score, state, nuisance))
        begun.sort(key=lambda one: -one[0])
        fitted = [
            self._improve(state, nuisance, used, ROUNDS) for _, state, nuisance in begun[:most]
        ]
        return max(fitted, key=lambda one: one.log_score)

    def again(self, fitted: Fitted, used: NDArray[np.bool_], at_least: float = -np.inf) -> Fitted:
        """Fit a hypothesis once more, to other features.

        Parameters
        ----------
        fitted
            From where.
        used
            Which features count, shape (f,).
        at_least
            As for `fit`.
        """
        used = used & self._problem.used
        return self._improve(fitted.state, fitted.problem.at, used, ROUNDS, at_least)

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

    def settle(self, fitted: Fitted, *, anew: bool = False) -> Fitted:
        """The same hypothesis with its numbers where they are likeliest, nuisances and its own.

        Evidence counts nuisances as moved to where they would fit, so that a fit may end before
        they are there; what is to be predicted with is moved. They are likeliest there together
        with what is on: either alone would be no fit.

        Parameters
        ----------
        fitted
            From where.
        anew
            Simulate anew what the nuisances do, and fit once more with that.
        """
        best, used = fitted, fitted.problem.used
        if anew and not self.anew:
            closer = Refiner(self.system, self.lens, self.data, self.calibrated, anew=True)
            best = closer._improve(fitted.state, fitted.point.nuisance, used, ROUNDS)
            return closer.settle(best)
        for _ in range(MOST_SETTLING):
            nuisance = best.weighed.nuisance
            if float(np.abs(nuisance - best.problem.at).max(initial=0.0)) < STILL:
                break
            tried = self._at(best.state.moved(best.weighed.estimate), nuisance, used)
            variance = best.weighed.variance
            if not _misfit(tried, variance, used) < _misfit(best, variance, used):
                break
            best = tried
        return best

    def _improve(
        self,
        state: State,
        nuisance: Array,
        used: NDArray[np.bool_],
        rounds: int,
        at_least: float = -np.inf,
    ) -> Fitted:
        best = self._at(state, nuisance, used)
        for _ in range(ROUNDS):
            if np.isfinite(best.log_score):
                break
            state = state.smaller(SHORTER)
            best = self._at(state, nuisance, used)
        share = 1.0
        rounds = ROUNDS_ANEW if self.anew else rounds
        shortest = SHORTEST_ANEW if self.anew else SHORTEST
        for turn in range(rounds - 1):
            # A start is where screening thought it best, to first order: one step it gets.
            patience = PATIENCE_ANEW if self.anew else 1
            if turn >= patience and best.log_score + 0.5 * best.weighed.gain < at_least:
                break
            there = state.moved(best.weighed.estimate, share)
            nuisance_there = nuisance + share * (best.weighed.nuisance - nuisance)
            rise, tried = self._rise(best, there, nuisance_there)
            if rise > 0.0:
                if tried is None:
                    tried = self._at(there, nuisance_there, used)
                best, state, nuisance, share = tried, there, nuisance_there, 1.0
                if rise < SETTLED:
                    break
            else:
                share *= SHORTER
                if share < 1.01 * SHORTER**shortest:
                    break
        return best

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
        return -_misfit_by(problem, state, problem.base)

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
        before = _misfit_by(best.problem, best.state, variance)
        return 0.5 * (before - _misfit_by(problem, state, variance)), None

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

    @property
    def _root(self) -> Array:
        """Noise of features, shape (f,); infinity where they do not count, or none is asked for."""
        counts = self._problem.used & self._finely
        return np.where(counts, np.sqrt(self._problem.base), np.inf)


def _misfit(fitted: Fitted, variance: Array, used: NDArray[np.bool_]) -> float:
    """Of a simulation as it stands, and of its nuisances to their prior."""
    if not np.isfinite(fitted.log_score):
        return float("inf")
    residual, at = fitted.problem.residual[used], fitted.problem.at
    return float((residual**2 / variance[used]).sum() + at @ at)


def _misfit_by(problem: Problem, state: State, variance: Array) -> float:
    """Squared misfit by a given variance, parameters free within their priors."""
    shapes, _ = state.shape_rows()
    return Frame(problem, variance).chi2 + float(shapes @ shapes)
