"""Several recordings: one leads the way, and from where it came to all are led.

To lead parameters to the ring's phase by growing windows is as long a way in eight recordings as in
one, and each step takes eight times as long. What one recording tells of parameters and causes is
mostly near enough for the phase of all others at once; and what it cannot part, all of them do.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.by_ring import Found, Start, by_ring
from analysis.engine.finder import Tell
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.look import look
from analysis.engine.part import Part, records_of
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Array, System

PILOTS_FROM = 3
"""From so many recordings on one leads the way."""

PILOTS = 3
"""So many are tried."""

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
    tried: list[str] = []
    farthest = False
    for _ in range(PILOTS):
        record = _next(system, at, tried, farthest=farthest)
        if record is None:
            break
        tried.append(record)
        part = Part(system, (record,))
        seen = look(part, tell)
        found = by_ring(Refiner(part, *seen), most_causes, tell)
        if not found.fitted:
            continue
        start = _lifted(part, found.fitted, at)
        whole = by_ring(refiner, most_causes, tell, start)
        if whole.fitted:
            # What the pilot screened stays told, where all were led from what it found.
            return whole._replace(screened=whole.screened or found.screened)
        at = start.nuisance
        # Where one says nothing and all are not led, those that ring most know parameters best.
        farthest = not start.hypotheses
    return Found((), (), faint=False)


def _lifted(part: Part, found: Sequence[Fitted], beside: Array) -> Start:
    """From where all recordings are led."""
    whole = [
        replace(one, point=replace(one.point, nuisance=part.whole(one.point.nuisance, beside)))
        for one in found
    ]
    nothing = next(one for one in whole if not one.hypothesis.parts)
    if not whole[0].hypothesis.parts:
        return Start(nothing.point.nuisance)
    least = whole[0].log_score - LIFTED
    causes = [one for one in whole if one.hypothesis.parts and one.log_score > least]
    return Start(whole[0].point.nuisance, causes[:MOST_LIFTED])


def _next(
    system: System, nuisance: Array, tried: Sequence[str], *, farthest: bool = False
) -> str | None:
    """The recording that is nearest to its simulation, or farthest from it, of those that are off.

    In the nearest rings are least, and are followed farthest.
    """
    left = {}
    for name in records_of(system):
        if name not in tried:
            part = Part(system, (name,))
            point = Followed(part.own(nuisance), None).point
            (found,) = Samples(part, everything=True).residuals([point])
            left[name] = float(np.mean(found**2))
    off = {name: one for name, one in left.items() if one > FAINT} or left
    return (max if farthest else min)(off, key=lambda name: off[name], default=None)
