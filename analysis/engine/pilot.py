"""Several recordings: one leads the way, and the others are led from where it came to.

To lead parameters to the ring's phase by growing windows is as long a way in eight recordings as in
one, and each step takes eight times as long. What one recording tells of parameters and causes is
handed on to the next, and at the end all are led at once, over the little way that is left.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.by_ring import Found, Start, by_ring
from analysis.engine.chain import Chained, chained, left_in
from analysis.engine.cycles import Valley, information_of, valley
from analysis.engine.finder import Tell
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.look import look
from analysis.engine.part import Part, records_of
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT, FAR, follow_ring
from analysis.engine.state import State
from analysis.engine.system import Array, System

CHAINS, PILOTS = 2, 3
"""So many are tried to begin with where nothing is left out, and where something is."""

BESIDE = 2
"""A recording that parameters could not be led on to leads with so many of those before it."""

LIFTED, MOST_LIFTED = 40.0, 6
"""What is no farther behind the best of the pilot, as a score, is led in all recordings, at most so
many."""


def by_pilot(refiner: Refiner, most_causes: int, tell: Tell | None) -> Found:
    """By every sample of all recordings, from where one of them came to.

    Parameters
    ----------
    refiner
        Fits hypotheses to all recordings.
    most_causes
        Of a hypothesis.
    tell
        Told of progress.
    """
    system, at = refiner.system, refiner.calibrated.at
    chains = _nothing(system, at, tell)
    if chains and not chains[-1].stuck:
        whole = by_ring(refiner, most_causes, tell, Start(chains[-1].nuisance))
        if whole.fitted:
            return whole
    tried: list[str] = []
    for _ in range(PILOTS):
        pilot = _pilot(system, at, chains, tried)
        if pilot is None:
            break
        tried.append(pilot.records[0])
        whole = _led_by(refiner, pilot, most_causes, tell)
        if whole.fitted:
            return whole
    return Found((), (), faint=False)


class _Pilot(NamedTuple):
    """Recordings that lead the way, and from where; None: from their likeliest parameters."""

    records: Sequence[str]
    nuisance: Array | None


def _led_by(refiner: Refiner, pilot: _Pilot, most_causes: int, tell: Tell | None) -> Found:
    """What all recordings say, from where a pilot leads; no hypotheses, where that is nowhere."""
    system, at = refiner.system, refiner.calibrated.at
    part = Part(system, pilot.records)
    beside = at if pilot.nuisance is None else pilot.nuisance
    start = None if pilot.nuisance is None else Start(part.own(pilot.nuisance))
    wholes: list[Found] = []

    def leads(lifted: _Lifted) -> bool:
        begun = lifted.free or lifted.strained
        if begun:
            wholes.append(_whole(refiner, begun, lifted.aside, most_causes, tell))
        return bool(begun) and bool(wholes[-1].fitted)

    def first(one: Followed) -> bool:
        return leads(_lifted(system, part, [one], beside, FAR)._replace(strained=[]))

    found = by_ring(Refiner(part, *look(part, tell)), most_causes, tell, start, first)
    if not (wholes and wholes[-1].fitted):
        contending = [Followed(one.point.nuisance, one.state) for one in _contending(found.fitted)]
        if not leads(_lifted(system, part, contending, beside)):
            return Found((), (), faint=False)
    # What the pilot screened stays told, where all were led from what it found.
    return wholes[-1]._replace(screened=wholes[-1].screened or found.screened)


class _Some(Refiner):
    """Fits hypotheses to some of the recordings, and shows them in all.

    Parameters
    ----------
    whole
        Of all recordings.
    part
        Some of them.
    beside
        Nuisances of the others, of the whole system, in sigmas.
    """

    def __init__(self, whole: Refiner, part: Part, beside: Array) -> None:
        super().__init__(part, whole.lens, whole.data, whole.calibrated)
        self._whole, self._part, self._beside = whole, part, beside

    def at(self, state: State, nuisance: Array) -> Fitted:
        """As of the whole."""
        return self._whole.at(state, nuisance)

    def directions_of(self, nuisance: Array) -> Array:
        """Of the part's nuisances, the whole system's directions."""
        return self._whole.directions_of(self._part.whole(nuisance, self._beside))

    def shown(self, fitted: Fitted) -> Fitted:
        """A hypothesis with nuisances of the whole system."""
        nuisance = self._part.whole(fitted.point.nuisance, self._beside)
        return replace(fitted, point=replace(fitted.point, nuisance=nuisance))


def _whole(
    refiner: Refiner,
    begun: Sequence[Followed],
    aside: Sequence[str],
    most_causes: int,
    tell: Tell | None,
) -> Found:
    """What all recordings say of hypotheses, but for those that stand aside."""
    if not aside:
        return by_ring(refiner, most_causes, tell, Start(begun[0].nuisance, begun))
    system = refiner.system
    part = Part(system, [one for one in records_of(system) if one not in aside])
    some = _Some(refiner, part, begun[0].nuisance)
    own = [replace(one, nuisance=part.own(one.nuisance)) for one in begun]
    found = by_ring(some, most_causes, tell, Start(own[0].nuisance, own))
    return found._replace(fitted=[some.shown(one) for one in found.fitted], aside=tuple(aside))


def _pilot(
    system: System, at: Array, chains: Sequence[Chained], tried: Sequence[str]
) -> _Pilot | None:
    """What leads next: where parameters could not be led on, something says what is left out."""
    for one in chains:
        if one.stuck and one.stuck not in tried:
            return _Pilot((one.stuck, *one.led[:BESIDE]), one.nuisance if one.led else None)
    record = _next(system, at, tried, farthest=len(tried) > 0)
    return None if record is None else _Pilot((record,), None)


def _nothing(system: System, at: Array, tell: Tell | None) -> list[Chained]:
    """Parameters alone, led through one recording after the other, until that comes through."""
    found: list[Chained] = []
    begun: list[str] = []
    for _ in range(CHAINS):
        # What could not be led with what others told may tell them more.
        stuck = [one.stuck for one in found if one.stuck not in begun]
        record = stuck[-1] if stuck else _next(system, at, begun)
        if record is None:
            break
        begun.append(record)
        part = Part(system, (record,))
        first = follow_ring(part, look(part, tell).calibrated.at, everything=True)
        led = valley(part, first)
        if led.led.share < 1.0:
            found.append(Chained(at, None, (), record))
            continue
        found.append(chained(system, led, (record,), at))
        if not found[-1].stuck:
            break
    return found


def _contending(found: Sequence[Fitted]) -> list[Fitted]:
    """Of what a pilot says, what is led in all recordings; none, where it says nothing."""
    if not found or not found[0].hypothesis.parts:
        return []
    least = found[0].log_score - LIFTED
    causes = [one for one in found if one.hypothesis.parts and one.log_score > least]
    return causes[:MOST_LIFTED]


class _Lifted(NamedTuple):
    """Hypotheses that came through all recordings, and those for which parameters had to bend.

    All but some recordings, which the first of them could not be led through.
    """

    free: list[Followed]
    strained: list[Followed]
    aside: tuple[str, ...] = ()


def _lifted(
    system: System,
    part: Part,
    found: Sequence[Followed],
    beside: Array,
    most_strain: float = np.inf,
) -> _Lifted:
    """Hypotheses of a pilot where they come to in all recordings, but for those that do not.

    Other laws of a kind, and a kind more or less, are led from there when all recordings are.
    """
    lifted = _Lifted([], [])
    aside: tuple[str, ...] | None = None
    known: list[set[str]] = []
    family = {one.name: one.family or one.name for one in system.candidates}
    for one in found:
        kinds = {family[name] for name in one.names}
        if one.state is None or any(kinds <= other or other <= kinds for other in known):
            continue
        at = Followed(one.nuisance, one.state.whole())
        told = Valley(at, information_of(part, at))
        led = chained(system, told, records_of(part), beside, most_strain)
        # All are weighed by the same recordings.
        if led.stuck or led.state is None or (aside is not None and not {*led.aside} <= {*aside}):
            continue
        aside = led.aside if aside is None else aside
        through = Followed(led.nuisance, led.state)
        if through.strain > FAR:
            lifted.strained.append(through)
        else:
            lifted.free.append(through)
            known.append(kinds)
    return lifted._replace(aside=aside or ())


def _next(
    system: System, nuisance: Array, tried: Sequence[str], *, farthest: bool = False
) -> str | None:
    """The recording that is nearest to its simulation, or farthest from it, of those that are off.

    In the nearest rings are least, and are followed farthest.
    """
    at = Followed(nuisance, None)
    left = {name: left_in(system, name, at) for name in records_of(system) if name not in tried}
    off = {name: one for name, one in left.items() if one > FAINT} or left
    return (max if farthest else min)(off, key=lambda name: off[name], default=None)
