"""One recording after the other: each is led with what those before it told of all numbers.

What a recording tells is kept as a quadratic about where it was led to: where numbers are likeliest
and how surely (as Kalman's filter keeps it, 1960). So each step costs what one recording costs, and
what one leaves open the next ones close; a number that would have to be two at once shows itself.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from analysis.engine.all_samples import noise_of
from analysis.engine.array import Array
from analysis.engine.cycles import Valley, information_of, valley
from analysis.engine.followed import Followed
from analysis.engine.known import Known, Told
from analysis.engine.leader import ARRIVED
from analysis.engine.part import Part, records_of
from analysis.engine.ring_fit import FAR, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.system import System
from analysis.engine.way import LEAVES

ANOTHER = 500.0
"""Where parameters alone have to go so far from what was known, squared and in standard deviations,
something is left out, even if it then leaves nothing."""

ASIDE = 0.3
"""A law may not hold in so many of the recordings, as a share of all, and still be what is there:
its error of form shows most where a motion dies away."""

AT_ODDS = 2
"""So many recordings that take parameters alone farther than they may be, each led at once with
those before it, and something is left out; of a law, one: it says what there is beside that."""

EARLY = 0.5
"""What is lost before this share of the time, what others tell would not help."""


@dataclass(frozen=True)
class Chained:
    """Where recordings have led to, one after the other.

    Attributes
    ----------
    nuisance
        Of the whole system, in sigmas, shape (nuisances,).
    state
        The free numbers of what is on; None: nothing is.
    led
        Recordings that were led, in their order.
    stuck
        The recording that could not be led with what those before it told; "": none.
    aside
        Recordings that what is on could not be led through, where it came through the others.
    """

    nuisance: Array
    state: State | None
    led: tuple[str, ...]
    stuck: str = ""
    aside: tuple[str, ...] = ()

    @property
    def followed(self) -> Followed:
        """Where the whole system was led to."""
        return Followed(self.nuisance, self.state)


def chained(
    system: System,
    first: Valley,
    records: Sequence[str],
    beside: Array,
    most_strain: float = FAR,
) -> Chained:
    """Lead recordings one after the other, the nearest next.

    Parameters
    ----------
    system
        All recordings.
    first
        Where some of them have come to, as a `Part`, and what they tell.
    records
        Which.
    beside
        Nuisances of the other recordings to begin with, of the whole system, in sigmas.
    most_strain
        What nuisances may come to, squared and in sigmas: the recording that takes them farther
        is one that could not be led.
    """
    return _Chain(system, first, records, beside, most_strain).chained()


class _Chain:
    """Recordings that are led one after the other; parameters are those of `chained`."""

    def __init__(
        self,
        system: System,
        first: Valley,
        records: Sequence[str],
        beside: Array,
        most_strain: float,
    ) -> None:
        self._system, self._most_strain = system, most_strain
        part, at = Part(system, records), first.led
        self._told = Told(Followed(part.whole(at.nuisance, beside), at.state))
        self._told.add(part, *first)
        self._led = list(records)
        every = records_of(system)
        self._left = [one for one in every if one not in records]
        self._later: list[str] = []
        self._aside: list[str] = []
        self._at_odds: list[str] = []
        self._asked: dict[str, tuple[Told, Valley]] = {}
        self._most_aside = 0 if at.state is None else int(ASIDE * len(every))
        self._together = len(records)

    def chained(self) -> Chained:
        """Where all of them lead to."""
        stuck = None
        while stuck is None and (self._left or self._later):
            stuck = self._next()
        at = self._told.at
        aside = () if stuck else tuple(self._aside)
        return Chained(at.nuisance, at.state, tuple(self._led), stuck or "", aside)

    def _next(self) -> str | None:
        """Lead the nearest; the recording that could not be led, where that is the end."""
        told, waiting = self._told, self._left or self._later
        nearest = min(waiting, key=lambda name: left_in(self._system, name, told.at))
        part = Part(self._system, (nearest,))
        known = told.of(part)
        # Where nothing was told since, there is nothing new to say.
        if nearest not in self._asked or self._asked[nearest][0] is not told:
            self._asked[nearest] = told, _led(part, told.at, known)
        _, (found, information) = self._asked[nearest]
        arrived = _arrived(found, known)
        # What a law that is not exact leaves may be much early on, and nothing is lost by it.
        early = found.share < EARLY and (not arrived or _leaves(part, found))
        lost = early or (not arrived and not self._left)
        if lost and len(self._aside) < self._most_aside:
            self._aside.append(nearest)
            waiting.remove(nearest)
            return None
        if early:
            return nearest
        more = self._without_strain(nearest, part, found, information) if arrived else None
        if len(self._at_odds) == (AT_ODDS if told.at.state is None else 1):
            return self._at_odds[0]
        # Where more is known it may still go without force.
        waits = bool(self._left) and (more is None or _leaves(part, found))
        if self._left:
            self._left.remove(nearest)
        if waits:
            self._later.append(nearest)
            return None
        return self._told_more(nearest, more)

    def _told_more(self, name: str, more: Told | None) -> str | None:
        """Go on with what one more has told; None: it does not go, but may from all at once."""
        if more is None:
            if self._together == len(self._led):
                return name
            self._told, _ = _together(self._system, self._led, self._told.at)
            self._together = len(self._led)
            return None
        if name in self._later:
            self._later.remove(name)
        self._told = more
        self._led.append(name)
        return None

    def _without_strain(
        self, name: str, part: Part, found: Followed, information: Array
    ) -> Told | None:
        """What is told with a recording more; None: that takes parameters too far."""
        more = copy(self._told)
        more.add(part, found, information)
        if more.at.strain < self._most_strain:
            return more
        if name in self._at_odds:
            return None
        # Quadratics bend: whether it is at odds with those before it, all of them at once tell.
        both, goes = _together(self._system, [*self._led, name], more.at)
        if goes and both.at.strain < self._most_strain:
            self._together = len(self._led) + 1
            return both
        self._at_odds.append(name)
        return None


def _together(system: System, records: Sequence[str], at: Followed) -> tuple[Told, bool]:
    """What recordings told, led once more all at once, and whether no more than noise is left."""
    part = Part(system, records)
    found = follow_ring(part, part.own(at.nuisance), at.state, everything=True, near=True)
    told = Told(Followed(part.whole(found.nuisance, at.nuisance), found.state))
    told.add(part, found, information_of(part, found))
    return told, not _leaves(part, found)


def _leaves(part: Part, found: Followed) -> bool:
    """Whether more is left than noise, and the simulator's own error; a law is not exact either."""
    count = len(Samples(part, everything=True).shares)
    noise = noise_of(part) + LEAVES * float(np.sqrt(2.0 / count))
    return found.misfit > (noise if found.state is None else max(noise, ARRIVED)) * count


def _led(part: Part, at: Followed, known: Known) -> Valley:
    """A recording, led with what others told."""
    led = follow_ring(part, part.own(at.nuisance), at.state, everything=True, known=known)
    return valley(part, led, known, lower=True)


def _arrived(found: Followed, known: Known) -> bool:
    """Whether a recording came to the noise and near to what was known; a law, to its end."""
    if found.state is not None:
        return found.share == 1.0 or found.to_end
    return found.share == 1.0 and known.cost(found.numbers) < ANOTHER


def left_in(system: System, record: str, at: Followed) -> float:
    """Squared misfit of a recording's sample, on average, at numbers of the whole system."""
    part = Part(system, (record,))
    there = Followed(part.own(at.nuisance), at.state)
    (found,) = Samples(part, everything=True).residuals([there.point])
    return float(np.mean(found**2))
