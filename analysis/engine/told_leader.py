"""What lines tell, led over the first stretch of the ring, and on from there."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.all_samples import noise_of
from analysis.engine.followed import Followed
from analysis.engine.graduated import alike, graduated
from analysis.engine.guess import Guess
from analysis.engine.leader import ARRIVED, EFFORT, POOR
from analysis.engine.more_leader import MoreLeader
from analysis.engine.survey import sticks, surveyed
from analysis.engine.way import IN_PHASE

TOLD, AS_GOOD = 2, 4.0
"""So many of what lines tell are led on from the first stretch, where they leave no more than so
many times what the best leaves of it."""

NEAR = 10.0
"""What leaves less than this of the first stretch is another law of the same thing, if not its own.
Where friction all but holds the platform, numbers that are right to a percent leave more."""

UNTOLD = 3.0
"""What is one thing or another, of which lines prefer neither by more than this, is begun as both:
with which of them a motion begins is often in the ring alone."""


class ToldLeader(MoreLeader):
    """Begins what lines tell, in what lines cannot tell both ways, and leads on what begins well.

    Parameters are those of `Leader`.
    """

    _slips = False
    """Whether only a survey leads over the first stretch: what holds there slips."""

    def _lead_told(self, guesses: Sequence[Guess]) -> None:
        """Lead what lines tell: what leaves least of the first stretch, as long as none arrives.

        What leaves no more of that than noise is led at once: where it arrives, its kin and rivals
        are led from there.
        """
        before = self._samples.effort
        begun, least = self._begin(self._starts(guesses))
        begun = self._surveyed(begun)
        least = min([least, *(one.left for one in begun[:1])])
        if begun and begun[0].left < NEAR and not (self._led and self._best.to_end):
            more, closer = self._begin(alike(self._samples, begun[0], self._refiner.candidates))
            begun, least = sorted([*begun, *more], key=lambda one: one.left), min(least, closer)
        self._effort += self._samples.effort - before
        for start in begun[:TOLD]:
            if (self._led and self._best.to_end) or start.left > AS_GOOD * least:
                break
            self._lead_on(start)
        # What it takes from here on is spent on what is likely.
        self._most = max(self._most, self._effort + EFFORT)

    def _surveyed(self, begun: list[Followed]) -> list[Followed]:
        """What leaves little of the first stretch put first, where only a survey leads there."""
        stuck = [one for one in begun if one.state is not None and sticks(one.state)]
        if not stuck or begun[0].left < NEAR or (self._led and self._best.to_end):
            return begun
        still = self._nothing.about or self._nothing
        found = surveyed(self._samples, stuck[0], still.nuisance)
        self._slips = found.left < IN_PHASE
        return sorted([found, *begun], key=lambda one: one.left)

    def _starts(self, guesses: Sequence[Guess]) -> Iterator[Followed]:
        """Where what lines tell leads over the first stretch."""
        least = np.inf
        for one in self._fresh([each for guess in guesses for each in self._either(guess)]):
            if not any(one.state.is_about(at) for at in self._begun):
                self._begun.append(one.state)
                start = graduated(self._samples, one, most=AS_GOOD * least)
                least = min(least, start.left)
                yield start

    def _either(self, guess: Guess) -> Iterator[Guess]:
        """A guess, and with what is one thing or another the other way, if lines do not tell."""
        yield guess
        refiner, lines = self._refiner, self._refiner.directions_of(guess.nuisance)
        for state in guess.state.otherwise():
            told = [refiner.score_at(one, lines) for one in (guess.state, state)]
            if abs(told[0] - told[1]) < UNTOLD:
                yield replace(guess, state=state)

    def _begin(self, starts: Iterable[Followed]) -> tuple[list[Followed], float]:
        """Lead on what leaves no more than noise of the first stretch, until that arrives.

        Parameters
        ----------
        starts
            Where hypotheses have come to over the first stretch.

        Returns
        -------
        list of Followed, float
            Those that leave more, the least first, and the least that any leaves.
        """
        begun: list[Followed] = []
        least = np.inf
        for start in starts:
            least = min(least, start.left)
            if start.left > noise_of(self._system) + POOR:
                begun.append(start)
                continue
            self._lead_on(start)
            if self.arrived and not self.is_poor:
                break
        return sorted(begun, key=lambda one: one.left), least

    def _lead_on(self, start: Followed) -> None:
        """Lead on what was led over the first stretch."""
        assert start.state is not None
        passed = start.share if start.left < ARRIVED else 0.0
        self._lead(start.nuisance, start.state, near=False, passed=passed)
