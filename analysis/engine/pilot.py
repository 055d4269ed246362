"""Several recordings: one leads the way, and the others are led from where it came to.

To lead parameters to the ring's phase by growing windows is as long a way in eight recordings as in
one, and each step takes eight times as long. What one recording tells of parameters and causes is
handed on to the next, and at the end all are led at once, over the little way that is left.
"""

from collections.abc import Sequence
from typing import NamedTuple

from analysis.engine.array import Array
from analysis.engine.by_lines import by_lines
from analysis.engine.by_ring import by_ring
from analysis.engine.chain import Chained, chained, left_in
from analysis.engine.cycles import valley
from analysis.engine.finder import Tell
from analysis.engine.followed import Followed
from analysis.engine.found import Found, Start
from analysis.engine.lifting import Lifting
from analysis.engine.look import look
from analysis.engine.part import Part, records_of
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT, follow_ring
from analysis.engine.system import System

CHAINS, PILOTS = 2, 3
"""So many are tried to begin with where nothing is left out, and where something is."""

BY_LINES = 1
"""So many pilots, that do not lead by what their ring promises, are asked for what lines tell."""

BESIDE = 2
"""A recording that parameters could not be led on to leads with so many of those before it."""


def by_pilot(
    refiner: Refiner, most_causes: int, tell: Tell | None, start: Start | None = None
) -> Found:
    """By every sample of all recordings, from where one of them came to.

    Parameters
    ----------
    refiner
        Fits hypotheses to all recordings.
    most_causes
        Of a hypothesis.
    tell
        Told of progress.
    start
        From where all of them are led; None: from where one comes to.
    """
    system, at = refiner.system, refiner.calibrated.at
    if start is not None:
        whole = by_ring(refiner, most_causes, tell, start)
        if whole.fitted:
            return whole
    chains = _nothing(system, at, tell)
    if chains and not chains[-1].stuck:
        whole = by_ring(refiner, most_causes, tell, Start(chains[-1].nuisance))
        if whole.fitted:
            return whole
    tried: list[Sequence[str]] = []
    wanted: set[tuple[str, ...]] = set()
    for _ in range(PILOTS):
        pilot = _pilot(system, at, chains, tried)
        if pilot is None:
            break
        tried.append(pilot.records)
        by_lines_too = len(tried) <= BY_LINES
        whole = _led_by(refiner, pilot, most_causes, tell, wanted, by_lines_too)
        if whole.fitted:
            return whole
    return Found((), (), faint=False)


class _Pilot(NamedTuple):
    """Recordings that lead the way, and from where; None: from their likeliest parameters."""

    records: Sequence[str]
    nuisance: Array | None


def _led_by(
    refiner: Refiner,
    pilot: _Pilot,
    most_causes: int,
    tell: Tell | None,
    wanted: set[tuple[str, ...]],
    by_lines_too: bool,
) -> Found:
    """What all recordings say, from where a pilot leads; no hypotheses, where that is nowhere.

    What leads an earlier pilot farthest, though not through it, is `wanted`: it is led in all
    recordings from where the next comes to, however little that says of it. Gains what leads here.
    Where the ring leads nowhere, lines may be asked too.
    """
    at = refiner.calibrated.at
    part = Part(refiner.system, pilot.records)
    beside = at if pilot.nuisance is None else pilot.nuisance
    start = None if pilot.nuisance is None else Start(part.own(pilot.nuisance))
    lifting = Lifting(refiner, part, beside, most_causes, tell)
    own = Refiner(part, *look(part, tell))
    found = by_ring(own, most_causes, tell, start, lifting.enough)
    if not lifting.leads:
        lifting.lift(found.fitted, wanted)
    if found.led is not None:
        wanted |= found.led.search.farther
        if by_lines_too and not lifting.leads:
            told = by_lines(own, own.nothing(), most_causes, tell, found.led)
            if told.faint and not lifting.leads:
                lifting.lift(told.fitted, wanted)
    if not lifting.leads:
        return Found((), (), faint=False)
    # What the pilot screened stays told, where all were led from what it found.
    return lifting.said._replace(screened=lifting.said.screened or found.screened)


def _pilot(
    system: System, at: Array, chains: Sequence[Chained], tried: Sequence[Sequence[str]]
) -> _Pilot | None:
    """What leads next: where parameters could not be led on, something says what is left out.

    With some of those before it first, which know parameters, and then by itself: what those leave,
    or bend parameters by, hides in none of it.
    """
    for one in chains:
        if one.stuck:
            beside, alone = (one.stuck, *one.led[:BESIDE]), (one.stuck,)
            if one.led and beside not in tried:
                return _Pilot(beside, one.nuisance)
            if alone not in tried:
                return _Pilot(alone, None)
    begun = [records[0] for records in tried]
    record = _next(system, at, begun, farthest=len(tried) > 0)
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
