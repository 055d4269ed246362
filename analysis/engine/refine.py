"""A hypothesis fitted in earnest: simulated again with everything free, until it stays."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.fitted import Fitted
from analysis.engine.screen import Scored, Screen
from analysis.engine.sharpen import sharpened
from analysis.engine.standing import Standing, misfit_of
from analysis.engine.state import State

ROUNDS = 5
"""Of simulating and solving."""

SETTLED = 0.5
"""Rounds end when the score rises by less than this."""

FAR_SIGMAS = 3.0
"""A fit starts with no nuisance farther out than this."""

SHORTER = 0.4
"""A step that went too far is taken again, this much of it."""

MOST_SETTLING, STILL = 6, 0.001
"""Steps to where the nuisances are likeliest, and what is no step, in sigmas."""

SHORTEST = 2
"""And so often."""

ROUNDS_ANEW, SHORTEST_ANEW = 20, 5
"""The same where everything is simulated anew: the way is longer."""

PATIENCE_ANEW = 4
"""And what a hypothesis promises is asked for after so many steps only: the first tell little."""


class Refiner(Standing):
    """Fits hypotheses; see `Standing`."""

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
            if not misfit_of(tried, variance, used) < misfit_of(best, variance, used):
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
