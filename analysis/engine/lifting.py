"""What one recording says, led through all of them."""

from collections.abc import Container, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.aside import but_for
from analysis.engine.by_ring import by_ring
from analysis.engine.chain import Chained, chained
from analysis.engine.cycles import Valley, information_of
from analysis.engine.finder import Tell
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.found import Found, Start
from analysis.engine.look import look
from analysis.engine.part import Part, records_of
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAR
from analysis.engine.system import System

LIFTED, MOST_LIFTED = 40.0, 6
"""What is no farther behind the best of the pilot, as a score, is led in all recordings, at most so
many."""


class Lifting:
    """Leads what a pilot says through all recordings, and keeps what they say of it.

    Parameters
    ----------
    refiner
        Fits hypotheses to all recordings.
    part
        The pilot.
    beside
        Nuisances of the other recordings to begin with, of the whole system, in sigmas.
    most_causes, tell
        As for `by_ring`.
    """

    def __init__(
        self, refiner: Refiner, part: Part, beside: Array, most_causes: int, tell: Tell | None
    ) -> None:
        self._refiner = refiner
        self._part = part
        self._beside = beside
        self._most_causes = most_causes
        self._tell = tell
        self.said = Found((), (), faint=False)
        """What all recordings said last."""

    @property
    def leads(self) -> bool:
        """Whether all recordings said something."""
        return bool(self.said.fitted)

    def enough(self, led: Followed) -> bool:
        """Whether a law that explains the pilot to the noise came through, and nothing bent.

        Where parameters would have to bend for one of the recordings, that leads beside the pilot
        from there on: it says what there is beside that law.
        """
        through = lifted(self._refiner.system, self._part, [led], self._beside, FAR)
        if self._weigh(through.free, through.aside):
            return True
        return through.stuck is not None and self._grown(through.stuck)

    def _grown(self, stuck: Chained) -> bool:
        """Whether what is led beside a law, where that could not be led on, came through."""
        at = stuck.followed
        if len(at.names) >= self._most_causes:
            return False
        part = Part(self._refiner.system, (*self._part.records, stuck.stuck))
        grown = Lifting(self._refiner, part, at.nuisance, self._most_causes, self._tell)
        own = Refiner(part, *look(part, self._tell))
        led = replace(at, nuisance=part.own(at.nuisance))
        start = Start(led.nuisance, [led], stuck=True)
        by_ring(own, self._most_causes, self._tell, start, grown.enough)
        if grown.leads:
            self.said = grown.said
        return grown.leads

    def lift(self, found: Sequence[Fitted], wanted: Container[tuple[str, ...]] = ()) -> None:
        """Lead all that contend in the pilot, even if parameters have to bend.

        Parameters
        ----------
        found
            What the pilot says, the best first.
        wanted
            Names of what is led however little the pilot says of it.
        """
        contending = [Followed(one.point.nuisance, one.state) for one in _contending(found, wanted)]
        through = lifted(self._refiner.system, self._part, contending, self._beside)
        self._weigh(through.free or through.strained, through.aside)

    def _weigh(self, begun: Sequence[Followed], aside: Sequence[str]) -> bool:
        if not begun:
            return False
        self.said = but_for(self._refiner, begun, aside, self._most_causes, self._tell)
        return self.leads


def _contending(found: Sequence[Fitted], wanted: Container[tuple[str, ...]] = ()) -> list[Fitted]:
    """Of what a pilot says, what is led in all recordings; none, where it says nothing."""
    causes: list[Fitted] = []
    if found and found[0].hypothesis.parts:
        least = found[0].log_score - LIFTED
        causes = [one for one in found if one.hypothesis.parts and one.log_score > least]
    known = {one.hypothesis.names for one in causes[:MOST_LIFTED]}
    asked = [one for one in found if one.hypothesis.names in wanted]
    return [*(one for one in asked if one.hypothesis.names not in known), *causes[:MOST_LIFTED]]


class Lifted(NamedTuple):
    """Hypotheses that came through all recordings, and those for which parameters had to bend.

    All recordings but those that stand aside; and how far the first came that did not.
    """

    free: list[Followed]
    strained: list[Followed]
    aside: tuple[str, ...] = ()
    stuck: Chained | None = None


def lifted(
    system: System,
    part: Part,
    found: Sequence[Followed],
    beside: Array,
    most_strain: float = np.inf,
) -> Lifted:
    """Hypotheses of a pilot where they come to in all recordings, but for those that do not.

    Other laws of a kind, and a kind more or less, are led from there when all recordings are.
    """
    came: list[tuple[Followed, tuple[str, ...]]] = []
    stuck: Chained | None = None
    known: list[set[str]] = []
    kind_of = {one.name: one.kind for one in system.candidates}
    for one in found:
        kinds = {kind_of[name] for name in one.names}
        if one.state is None or any(kinds <= other or other <= kinds for other in known):
            continue
        at = Followed(one.nuisance, one.state.whole())
        told = Valley(at, information_of(part, at))
        led = chained(system, told, records_of(part), beside, most_strain)
        if led.stuck:
            stuck = stuck or led
            continue
        there = led.followed
        came.append((there, led.aside))
        if there.strain <= FAR:
            known.append(kinds)
    # All are weighed by the same recordings: by those that most hold for.
    aside = min((one for _, one in came), key=len, default=())
    same = [one for one, without in came if {*without} <= {*aside}]
    free = [one for one in same if one.strain <= FAR]
    return Lifted(free, [one for one in same if one.strain > FAR], aside, stuck)
