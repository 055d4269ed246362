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
from analysis.engine.cycles import Valley, information_of, valley
from analysis.engine.followed import Followed
from analysis.engine.known import Known, Told
from analysis.engine.leader import ARRIVED
from analysis.engine.part import Part, records_of
from analysis.engine.ring_fit import FAR, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.system import Array, System
from analysis.engine.way import LEAVES

ANOTHER = 500.0
"""Where parameters alone have to go so far from what was known, squared and in standard deviations,
something is left out, even if it then leaves nothing."""

ASIDE = 0.3
"""A law may not hold in so many of the recordings, as a share of all, and still be what is there:
its error of form shows most where a motion dies away."""

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
    part = Part(system, records)
    at = first.led
    told = Told(Followed(part.whole(at.nuisance, beside), at.state))
    told.add(part, *first)
    led = list(records)
    left = [one for one in records_of(system) if one not in led]
    later: list[str] = []
    aside: list[str] = []
    asked: dict[str, tuple[Told, Valley]] = {}
    most_aside = 0 if at.state is None else int(ASIDE * len(records_of(system)))
    together = len(led)
    while left or later:
        nearest = min(left or later, key=lambda name: left_in(system, name, told.at))
        part = Part(system, (nearest,))
        known = told.of(part)
        # Where nothing was told since, there is nothing new to say.
        if nearest not in asked or asked[nearest][0] is not told:
            asked[nearest] = told, _led(part, told.at, known)
        _, (found, information) = asked[nearest]
        arrived, early = _arrived(found, known), found.share < EARLY
        lost = early or (not arrived and not left)
        if lost and len(aside) < most_aside:
            aside.append(nearest)
            (left or later).remove(nearest)
            continue
        if early:
            return Chained(told.at.nuisance, told.at.state, tuple(led), nearest)
        more = copy(told)
        if arrived:
            more.add(part, found, information)
            arrived = more.at.strain < most_strain
        if left:
            left.remove(nearest)
            if not arrived or _leaves(part, found):
                # Where more is known it may still go without force.
                later.append(nearest)
                continue
        elif not arrived:
            if together == len(led):
                return Chained(told.at.nuisance, told.at.state, tuple(led), nearest)
            told, together = _together(system, led, told.at), len(led)
            continue
        else:
            later.remove(nearest)
        told = more
        led.append(nearest)
    return Chained(told.at.nuisance, told.at.state, tuple(led), aside=tuple(aside))


def _together(system: System, records: Sequence[str], at: Followed) -> Told:
    """What recordings told, led once more all at once: quadratics bend."""
    part = Part(system, records)
    found = follow_ring(part, part.own(at.nuisance), at.state, everything=True, near=True)
    told = Told(Followed(part.whole(found.nuisance, at.nuisance), found.state))
    told.add(part, found, information_of(part, found))
    return told


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
