"""Kin: another law of the same thing, from where one law was led to the end.

Where one law of friction explains a recording, another is near: in the same places, about as
strong, with the same parameters. How much worse it is, is told within a few steps.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.all_samples import cost_of, farthest_first, noise_of
from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.instead import begun_instead
from analysis.engine.part import has_several
from analysis.engine.ring_fit import BEHIND, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.system import System
from analysis.engine.way import HOPELESS

SHARES = (0.5, 0.2, 0.05)
"""Of what straight lines promise of it, one cause more begins with all, or with so much."""

EFFORT = 400.0
"""Whole simulations for one of kin: some three times all differences."""

FAR_EFFORT = 1200.0
"""And where parameters had made up for something: they are more than a sigma off, on average."""


def lead_instead(samples: Samples, law: Followed, known: str, other: str) -> Followed | None:
    """Lead a hypothesis with another law in the place of one, from where that one has come to.

    Parameters
    ----------
    samples
        By which it is led.
    law
        Led to the end.
    known, other
        The law that is on, and the other.

    Returns
    -------
    Followed or None
        None: the other law has no such places.
    """
    state = begun_instead(samples, law, known, other)
    return None if state is None else lead_from(samples.system, law, state)


def lead_from(
    system: System,
    law: Followed,
    state: State,
    nuisance: Array | None = None,
    *,
    again: bool = False,
) -> Followed:
    """Lead a hypothesis that is near another from where that one has come to the end.

    What nuisances do there is taken to be what they do here, unless they made up for something
    there: then it may be far to where they need not, and one recording, or two, are led by growing
    windows from the likeliest parameters first.

    Parameters
    ----------
    system
        What is simulated.
    law
        Led to the end.
    state
        The free numbers to begin with.
    nuisance
        And the parameters, in sigmas, shape (p,); None: where the other has come to.
    again
        It was led by growing windows before.
    """
    start = law.nuisance if nuisance is None else nuisance
    # Of several recordings each was led on its own: all at once, windows lose that again.
    if not law.is_bent_throughout or has_several(system):
        return follow_ring(
            system, start, state, everything=True, near=True, ahead=law.costs, most=EFFORT,
            lent=law.lends,
        )  # fmt: skip
    anew = None if again else follow_ring(system, np.zeros_like(start), state, everything=True)
    if anew is not None and anew.to_end and anew.left < noise_of(system):
        return anew
    there = follow_ring(
        system, start, state, everything=True, near=True, ahead=law.costs, most=FAR_EFFORT
    )
    if anew is None:
        return there
    closer = anew if anew.to_end and cost_of(anew) < cost_of(there) else there
    return replace(closer, effort=anew.effort + there.effort)


def kin_of(
    best: Followed,
    led: Sequence[Followed],
    others: Sequence[Guess],
    candidates: Mapping[str, Candidate],
) -> list[Guess]:
    """Other laws of the things that came as far as the best.

    Parameters
    ----------
    best
        What came farthest.
    led
        All that was led.
    others
        Single causes, the best first.
    candidates
        By name.
    """
    share, cost = best.reached
    far = [one for one in led if one.reached[0] == share and one.reached[1] < cost + BEHIND]
    known = {one.names for one in led}
    kin = {candidates[name].family for one in far for name in one.names} - {""}
    found: dict[tuple[str, ...], Guess] = {}
    for one in others:
        names = one.hypothesis.names
        if names not in known and candidates[names[0]].family in kin:
            found.setdefault(names, one)
    return list(found.values())


def kin_alike(
    best: Followed, others: Sequence[Guess], candidates: Mapping[str, Candidate]
) -> list[Guess]:
    """Laws of the same thing as the best, where that is on in some places only.

    Which places are on was a guess, over a short stretch: one law's is no guide for another.

    Parameters
    ----------
    best
        What came to the end with one cause.
    others
        Single causes.
    candidates
        By name.
    """
    if best.state is None or not best.to_end or len(best.names) != 1:
        return []
    if best.state.alike() is best.state:
        return []
    (known,) = best.names
    family = candidates[known].family

    def is_kin(one: Guess) -> bool:
        (name,) = one.hypothesis.names
        return name == known or bool(family and candidates[name].family == family)

    return [one for one in others if len(one.hypothesis.names) == 1 and is_kin(one)]


def kin_left(
    best: Followed, led: Sequence[Followed], candidates: Mapping[str, Candidate]
) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Other laws for those of a hypothesis that have not come to the end.

    First those that were not led beside what else is on, and of these, those that led farthest in
    any hypothesis: they are the likeliest.

    Parameters
    ----------
    best
        Which hypothesis.
    led
        All that was led. What was led with what it was lent is led once more, and so is what bends
        parameters more than a sigma on average.
    candidates
        By name.

    Yields
    ------
    str, str, tuple of str
        The law that is on, the other, and the names of the hypothesis with that.
    """
    done = {
        one.names
        for one in led
        if one.to_end
        and not one.borrowed
        and one.misfit < HOPELESS * best.misfit
        and not one.is_bent
    }

    every = [
        (known, name, tuple(sorted({*best.names, name} - {known})))
        for known in best.names
        for name, one in candidates.items()
        if candidates[known].is_kin(one) and name not in best.names
    ]
    tried = {one.names for one in led}

    def order(kin: tuple[str, str, tuple[str, ...]]) -> tuple[bool, tuple[float, float]]:
        _, name, names = kin
        came = (farthest_first(one) for one in led if name in one.names)
        return names in tried, min(came, default=(0.0, 0.0))

    for kin in sorted(every, key=order):
        if kin[2] not in done:
            yield kin


def part_of_the_way(
    samples: Samples, best: Followed, far: Followed, share: float = 1.0
) -> Followed:
    """So much of what straight lines promise as leaves least.

    Parameters
    ----------
    samples
        By which it is told.
    best
        Led to the end.
    far
        With one cause more, where straight lines about the best say.
    share
        Of the time, over which they say so.
    """
    assert far.state is not None
    tried = [far]
    for part in SHARES:
        nuisance = best.nuisance + part * (far.nuisance - best.nuisance)
        tried.append(Followed(nuisance, far.state.nearer(best.state, part)))
    left = samples.residuals([one.point for one in tried], share)
    left = [one[samples.shares <= share] for one in left]
    costs = [found @ found + one.strain for found, one in zip(left, tried, strict=True)]
    return tried[int(np.argmin(costs))]
