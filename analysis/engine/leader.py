"""Hypotheses that were led to the ring's phase, and what all samples say of them."""

from collections.abc import Sequence
from dataclasses import replace

from analysis.engine.all_samples import (
    all_samples_say,
    cost_of,
    farthest_first,
    led_through,
    misfit_at,
    noise_of,
    nothing_again,
    shown_the_way,
)
from analysis.engine.array import Array
from analysis.engine.clear_part import most_of_it
from analysis.engine.cycles import tuned
from analysis.engine.exchange import Exchange
from analysis.engine.faint import Faint, faint
from analysis.engine.faint_search import kin_beside, others_beside
from analysis.engine.fitted import Causes, Fitted
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.part import has_several, records_of
from analysis.engine.places import is_placed
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import BEHIND, GOES_ON, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.sensitivity import Progress
from analysis.engine.sharpen import sharpened
from analysis.engine.state import State
from analysis.engine.way import HOPELESS

RESTARTS = 1
"""Nothing is led to the phase once more from where so many hypotheses have come: one may have found
a way that nothing missed."""

EFFORT, RECORDS = 3000.0, 4
"""Whole simulations, after which nothing new is tried; fewer, of more recordings than that."""

POOR = 0.2
"""What leaves so much more of a sample, squared, than noise may, is not what is there."""

ARRIVED = 2.5
"""What was led to the end speaks for every sample, where no more than this is left of the squared
misfit of one, on average: laws are not exact."""

A_CAUSE = 10.0
"""What brings no more than this, in squared misfit, is not led on from: beforehand a cause more is
less likely by about twice as much."""

SLIGHTLY = 0.01
"""And where more is left, but no more than `GOES_ON`, nor, as an amplitude, than this of what
parameters alone leave: laws that explain most are not exact to the noise."""


class Leader:
    """Leads hypotheses, each for itself, and keeps what was led.

    Parameters
    ----------
    refiner
        Made the hypotheses.
    nothing
        How far parameters alone lead.
    most_causes
        Of a hypothesis.
    progress
        Told of it.
    near
        All hypotheses are near the ring's phase, and their scores tell what each can come to.
    """

    def __init__(
        self,
        refiner: Refiner,
        nothing: Followed,
        most_causes: int,
        progress: Progress | None = None,
        *,
        near: bool = False,
    ) -> None:
        self._refiner = refiner
        self._system = refiner.system
        self._nothing = nothing
        self._most_causes = most_causes
        self._progress = progress
        self._near = near
        self._samples = Samples(self._system, everything=True)
        self._led: list[Followed] = []
        self._tried: set[tuple[str, ...]] = set()
        self._begun: list[State] = []
        self._effort = 0.0
        self._asked: Faint | None = None
        self._asked_itself = False
        self._exchanged: set[tuple[str, ...]] = set()
        self._waiting: dict[tuple[str, ...], tuple[Faint, list[Exchange]]] = {}
        self._placed: set[tuple[object, ...]] = set()
        self._elsewhere: dict[tuple[object, ...], Sequence[Causes]] = {}
        self._misplaced: set[tuple[str, ...]] = set()
        self._fewer: list[Followed] = []
        self._needed: dict[tuple[tuple[str, ...], tuple[str, ...]], float] = {}
        self._everywhere: set[tuple[str, tuple[str, ...]]] = set()
        self._anew: set[tuple[str, ...]] = set()
        self._asked_more = False
        self._most_of_it: Followed | None = None
        self._asked_whole: set[tuple[str, ...]] = set()
        self._most = EFFORT * min(1.0, RECORDS / len(records_of(self._system)))

    @property
    def arrived(self) -> bool:
        """Whether something was led to the end, near the noise."""
        return bool(self._led) and self._arrives(self._best.misfit)

    @property
    def is_poor(self) -> bool:
        """Whether the best leaves far more than noise: something else may be there."""
        return self._best.left > noise_of(self._system) + POOR

    def fitted(self) -> list[Fitted] | None:
        """Hypotheses with the scores of all samples, the best first; None: none comes near."""
        if not self._led:
            return None
        count = len(self._samples.shares)
        self._led = shown_the_way(self._system, led_through(self._system, self._led), self._led)
        first = sorted(self._led, key=farthest_first)
        nothing = nothing_again(self._system, self._nothing, first[:RESTARTS])
        if not self._arrives(min(one.misfit for one in (*self._led, nothing))):
            return None
        said = all_samples_say(self._refiner, self._led, nothing, count)
        return [one.also_in(self._elsewhere.get(one.hypothesis.key, ())) for one in said]

    def _arrives(self, misfit: float) -> bool:
        """Whether so much, squared, of all samples is near enough to the noise."""
        count = len(self._samples.shares)
        law = min(SLIGHTLY**2 * self._nothing.misfit, GOES_ON * count)
        return misfit < max(ARRIVED * count, law)

    @property
    def _best(self) -> Followed:
        """What led farthest, and there is closest; a cause more counts where it is worth it."""

        def last(led: Followed) -> tuple[float, float]:
            share, cost = farthest_first(led)
            return share, cost + A_CAUSE * len(led.names)

        return min(self._led, key=last, default=self._nothing)

    def _lead(self, nuisance: Array, state: State, *, near: bool, passed: float = 0.0) -> None:
        self._begun.append(state)
        system, ahead = self._system, self._best.costs if self._led else None
        # What nuisances do, about what a new hypothesis is near to.
        close = self._nothing if self._best.lends is None else self._best
        lent = close.lends if near else None
        found = follow_ring(
            system, nuisance, state, everything=True, ahead=ahead, near=near, lent=lent,
            passed=passed,
        )  # fmt: skip
        lost = self._best.to_end and found.misfit > HOPELESS * self._best.misfit
        # Of several recordings each was led on its own. Where all at once are near enough for a
        # step, windows lose that again.
        windows = not has_several(system) or found.effort < len(found.numbers)
        if near and found.share < 1.0 and windows and not lost:
            self._effort += found.effort
            found = follow_ring(system, nuisance, state, everything=True, ahead=ahead)
        if found.share < 1.0:
            left = self._samples, found.nuisance
            sharper = sharpened(state, lambda there: -misfit_at(*left, there))
            if sharper is not state:
                self._effort += found.effort
                found = follow_ring(system, found.nuisance, sharper, everything=True, ahead=ahead)
        self._keep(found)

    def _keep(self, found: Followed) -> None:
        """Among what was led; what may be the best of a single recording is brought in tune."""
        contends = cost_of(found) < cost_of(self._best) + BEHIND
        if found.to_end and contends and not has_several(self._system):
            if not self._arrives(found.misfit) and self._most_of_it is None:
                self._most_of_it = most_of_it(self._samples, found)
            # Of several recordings each is led over its own ridges.
            found = tuned(self._system, found)
        self._effort += found.effort
        if farthest_first(found) > farthest_first(self._best):
            found = replace(found, lends=None)
        self._led.append(found)
        self._misplaced.discard(found.names)
        if self._progress is not None:
            self._progress(len(self._led), len(self._led))

    def _fresh(self, hypotheses: Sequence[Guess]) -> list[Guess]:
        """Those that were not led to the end before, nor lost from about the same start."""
        known = {one.names for one in self._led if one.to_end}
        fresh = [one for one in hypotheses if one.hypothesis.names not in known]
        return [one for one in fresh if not any(one.state.is_about(at) for at in self._begun)]

    def _faint(self, about: Followed, *, itself: bool = False) -> Faint:
        """What could be there beside what is on, and of that elsewhere.

        Where it was asked last is kept.

        Parameters
        ----------
        about
            What was led.
        itself
            Of what is on alone.
        """
        there = about.about or about
        just = self._asked is not None and self._asked.is_about(about)
        if not just or (self._asked_itself and not itself):
            on = [self._refiner.candidates[name] for name in about.names]
            asked = [one for one in on if is_placed(one)]
            if not itself:
                asked = [*others_beside(self._refiner, about), *asked]
                if len(on) > 1 and there.to_end and there.left < noise_of(self._system):
                    asked += kin_beside(self._refiner, about)
            self._asked = faint(self._system, about, asked, near=self._asked)
            self._asked_itself = itself
        assert self._asked is not None
        return self._asked
