"""Hypotheses led to the ring's phase, each for itself, and what all samples then say of them."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from analysis.engine.all_samples import (
    WORTH_IT,
    cost_of,
    elsewhere_than,
    farthest_first,
    tells_more,
)
from analysis.engine.clear_part import clear_part
from analysis.engine.cycles import valley
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.kin import (
    kin_of,
    part_of_the_way,
)
from analysis.engine.leader import EFFORT
from analysis.engine.more_leader import FAR_BEHIND
from analysis.engine.part import has_several
from analysis.engine.refine import Refiner
from analysis.engine.released import released
from analysis.engine.ring_fit import follow_ring
from analysis.engine.sensitivity import Progress
from analysis.engine.told_leader import ToldLeader

EARLY = 0.03
"""Where none of the first that were tried can be led so much farther than parameters alone, as a
share of the time, the ring tells nothing of what is left out."""

STRAINED = 500.0
"""What came to the end with parameters bent by more than this, in squared sigmas, has most likely
made them stand for what it is not: the next guesses are led, too."""

GUESSES = 2
"""So many of them, of other kinds, until one comes there with less; and until one comes farther,
where the first came no farther than parameters alone."""


class FollowedSearch(ToldLeader):
    """Hypotheses led to the ring's phase, each for itself, and with one cause more where it asks.

    Parameters are those of `Leader`, and

    Parameters
    ----------
    enough
        Asked of each hypothesis that explains to the noise and is the best: nothing more is led
        where it is.
    """

    def __init__(
        self,
        refiner: Refiner,
        nothing: Followed,
        most_causes: int,
        progress: Progress | None = None,
        *,
        near: bool = False,
        enough: Callable[[Followed], bool] | None = None,
    ) -> None:
        super().__init__(refiner, nothing, most_causes, progress, near=near)
        self._enough = enough
        self._asked_of: set[tuple[str, ...]] = set()
        self._foretold: tuple[Followed, Followed | None] | None = None
        self._spared = False
        self.ended = False
        """Whether something was enough."""

    def follow(
        self,
        hypotheses: Sequence[Guess],
        others: Sequence[Guess],
        *,
        guessed: bool = False,
        seen: bool = False,
    ) -> None:
        """Lead hypotheses to the ring's phase.

        Parameters
        ----------
        hypotheses
            Those to try, the null not among them; what was led to the end is not led again.
        others
            Single causes, the best first: laws of the same things as what comes far are tried too.
        guessed
            In which places they are was told over a short stretch.
        seen
            They are likely by lines as well: what explains but a stretch is looked beside.
        """
        if seen and not self._near:
            self._lead_told(hypotheses)
            self._is_enough()
        else:
            self.lead_first(hypotheses)
        if not self._led or self.ended or (self._slips and self.foretells is not None):
            return
        if not self._near:
            tells = seen and tells_more(self._best, self._nothing, self._samples.shares)
            tells = tells or (seen and self._leads_bent() and self._one_more())
            # Of a single recording lines are asked before the ring is asked for more.
            if not tells and (seen or self._enough is not None):
                self._lead_next(others, self._is_farther, told=seen)
            if not (tells or self._is_farther(self._best)):
                return
        least = max((one.log_score for one in hypotheses), default=0.0) - FAR_BEHIND
        for one in self._fresh(kin_of(self._best, self._led, others, self._refiner.candidates)):
            if self._best.to_end and not self._near:
                break
            if (not self._near or one.log_score > least) and self._effort < self._most:
                self._lead_guess(one)
        asked = seen or self._near or self._enough is not None
        if not asked and self.foretells_most is not None:
            # What there is beside that is asked of the part that it foretells.
            return
        if guessed and not self._near:
            self._lead_next(others, lambda led: not self._is_strained(led))
        if guessed or self._near:
            self._lead_alike(others)
        self._lead_beside()

    def _lead_next(
        self, others: Sequence[Guess], until: Callable[[Followed], bool], *, told: bool = False
    ) -> None:
        """The next guesses, of other kinds than what was led, until the best is of use.

        Parameters
        ----------
        others
            Single causes, the most promising first.
        until
            Whether the best is of use.
        told
            Lines told them.
        """
        kinds = set().union(*(self._kinds(one.names) for one in self._led))
        left = GUESSES
        for one in self._fresh(others):
            if not left or until(self._best):
                return
            kind = self._kinds(one.hypothesis.names)
            if not kind & kinds:
                kinds |= kind
                left -= 1
                if told:
                    self._lead_told([one])
                else:
                    self._lead(one.nuisance, one.state, near=False)

    def _leads_bent(self) -> bool:
        """Whether the best leads over more than parameters alone, but bends them, and loses it.

        What it bends them for is told best by that stretch: lines guess worse at a second cause.
        """
        best, (share, _) = self._best, self._nothing.reached
        return (
            best.state is not None and not best.to_end and best.is_bent and best.reached[0] > share
        )

    def _is_farther(self, led: Followed) -> bool:
        return led.to_end or led.share >= self._nothing.share + EARLY

    @staticmethod
    def _is_strained(led: Followed) -> bool:
        return led.to_end and led.strain > STRAINED

    def follow_from(self, begun: Sequence[Followed], *, stuck: bool = False) -> None:
        """Lead hypotheses of some of the recordings in all of them.

        Parameters
        ----------
        begun
            Where they came to, the best first.
        stuck
            One of these recordings is where the first could not be led on: before all else it is
            asked what there is beside that.
        """
        if stuck:
            at = begun[0]
            led = follow_ring(self._system, at.nuisance, at.state, everything=True, near=True)
            # At the end strained parameters tell what they make up for.
            self._keep(replace(led, about=None))
            self._one_more()
            if self._is_enough():
                return
            begun = begun[1:]
        for number, one in enumerate(begun):
            if one.state is not None and not (number > 0 and self._effort > self._most):
                self._lead(one.nuisance, one.state, near=self._near)
        self._lead_beside()

    def follow_beside(self, names: tuple[str, ...]) -> None:
        """Ask the ring what there is beside what lines are sure of, where that was lost.

        What is beside it may show in the ring alone: there lines tell nothing of it. Where
        parameters are bent they made up for it, and the ring tells that instead.

        Parameters
        ----------
        names
            Of what lines are sure of.
        """
        lost = [one for one in self._led if one.names == names and not one.is_bent]
        if self.arrived or not lost:
            return
        self._most = max(self._most, self._effort + EFFORT)
        if self._one_more(min(lost, key=farthest_first)):
            self._lead_beside()

    def _lead_beside(self) -> None:
        """From the best on: rivals, one cause more, one less."""
        self._lead_from_best()
        if not self.ended and self._lead_waiting():
            self._lead_from_best()
        for one in self._as_close():
            self._one_less(one)

    def _lead_from_best(self) -> None:
        """Rivals of the best, and one cause more, until neither leads farther."""
        for _ in range(self._most_causes):
            self._one_less(self._best)
            waiting = not self._lead_rivals()
            self._lead_freed()
            self._lead_whole()
            best = self._best
            more = self._one_more()
            if self._is_enough():
                break
            if more:
                continue
            if waiting:
                self._lead_rivals(last=True)
            if self._best is best and not (self._lead_elsewhere() or self._spares()):
                break

    def _spares(self) -> bool:
        """Whether more is tried, however much it took to come close to the noise: once.

        What leaves more than that may be another law, or another cause, of what leads there.
        """
        spent = self._effort > self._most and not self._spared
        if not (spent and self.arrived) or self._explains(self._best):
            return False
        self._spared = True
        self._most = self._effort + EFFORT
        return True

    def lead_released(self) -> None:
        """Parameters that are off, of all kinds together, where all of them were bent far.

        Unless a cause was led to the end for which they need not be.
        """
        best = self._best
        if self.ended or (best.to_end and best.state and not best.is_bent):
            return
        system, candidates = self._system, self._refiner.candidates
        for one in released(system, self._samples, self._nothing, candidates, self._most_causes):
            self._keep(one)
        self._most = max(self._most, self._effort + EFFORT)

    def _is_enough(self) -> bool:
        """Whether the best explains to the noise, and that is all that was to be found here."""
        best = self._best
        if self._enough is None or not self._explains(best):
            return False
        if best.names not in self._asked_of:
            self._asked_of.add(best.names)
            self.ended = self._enough(best)
        return self.ended

    def lead_first(self, hypotheses: Sequence[Guess]) -> None:
        """Lead hypotheses, and look no farther.

        Parameters
        ----------
        hypotheses
            Those to try.
        """
        for number, one in enumerate(self._fresh(hypotheses)):
            spent = self._effort > self._most
            if number > 0 and (spent or self._is_kin(one) or self._leads_in_a_form(one)):
                continue
            self._lead_guess(one)
            self._lead_otherwise(one)
        self._is_enough()

    def _leads_in_a_form(self, guess: Guess) -> bool:
        """Whether the same in the same places leads farther than parameters, as it was begun."""
        state = self._best.state
        same = state is not None and state.hypothesis.key == guess.hypothesis.key
        return same and not self._near and self._is_farther(self._best)

    def _lead_guess(self, guess: Guess) -> None:
        """Lead what straight lines promise, or, near the phase, so much of it as leaves least."""
        start = Followed(guess.nuisance, guess.state)
        if self._near:
            start = part_of_the_way(self._samples, self._nothing, start)
        self._lead(start.nuisance, start.state or guess.state, near=self._near)

    def _lead_otherwise(self, guess: Guess) -> None:
        """What is one thing or another, the other way, where it is the best and leaves much."""
        if self._near or self._best.names != guess.hypothesis.names or not self.is_poor:
            return
        for state in guess.state.otherwise():
            self._lead(guess.nuisance, state, near=False)

    @property
    def farther(self) -> set[tuple[str, ...]]:
        """Names of what leads farthest, where that is farther than parameters alone."""
        best = self._best
        is_farther = farthest_first(best) < farthest_first(self._nothing)
        return {best.names} if best.state is not None and is_farther else set()

    @property
    def foretells(self) -> Followed | None:
        """The part of the time that the best foretells to the noise, where it is not at the end."""
        if self._foretold is None or self._foretold[0] is not self._best:
            clear = None if self.arrived else clear_part(self._samples, self._best)
            self._foretold = self._best, clear
        return self._foretold[1]

    @property
    def foretells_most(self) -> Followed | None:
        """Most of the time, where something foretells that and nothing comes to the end."""
        return None if self.arrived and not self.is_poor else self._most_of_it

    def _lead_elsewhere(self) -> bool:
        """Lead the best over a ridge; or from elsewhere, where it leaves what nothing explains."""
        best = self._best
        if best.state is None or not best.to_end or best.names in self._anew:
            return False
        # Of several recordings each was led over its own ridges.
        if has_several(self._system):
            return False
        self._anew.add(best.names)
        beyond = valley(self._system, best).led
        if beyond is not best:
            self._keep(beyond)
        elif self.is_poor:
            start = elsewhere_than(best)
            self._keep(follow_ring(self._system, start, best.state, everything=True))
        return cost_of(self._best) < cost_of(best) - WORTH_IT
