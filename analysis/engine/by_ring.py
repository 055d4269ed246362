"""What the ring tells: hypotheses by every sample, where they can be led to the noise."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.all_samples import cost_of
from analysis.engine.array import Array
from analysis.engine.beginnings import begun_otherwise
from analysis.engine.begins import begins
from analysis.engine.cycles import valley
from analysis.engine.faint import Faint, faint
from analysis.engine.faint_search import guessed, one_more
from analysis.engine.finder import Tell
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.found import Found, Led, Start
from analysis.engine.guess import Guess
from analysis.engine.near_noise import as_loud_as_it_is, near_noise, sharper_than_stated
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT, STRETCHES, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import Scored
from analysis.engine.sensitivity import Progress
from analysis.engine.sizes import in_any_size
from analysis.engine.system import System, free_of
from analysis.engine.way import STRAIN
from analysis.engine.whole import whole_onward

ABREAST, MOST_ABREAST = 12.0, 4
"""Of causes that are faint, so many that are no farther behind the first are led to the phase."""

MOST_OF_IT = 0.5
"""Where parameters alone lead over this share of the time, bent far, they may be what is off."""

PROMISED = 4
"""So many of what is promised where a rest ends are led from there, until one is at the noise."""

LONG = 0.4
"""Where parameters alone have foretold this share of the time, nothing was left out of that."""


def by_ring(
    refiner: Refiner,
    most_causes: int,
    tell: Tell | None,
    start: Start | None = None,
    enough: Callable[[Followed], bool] | None = None,
) -> Found:
    """By every sample, ring and all; no hypotheses, where that does not come to the noise.

    Parameters
    ----------
    refiner
        Fits hypotheses.
    most_causes
        Of a hypothesis.
    tell
        Told of progress.
    start
        From where; None: from the likeliest parameters, by growing windows.
    enough
        As for `FollowedSearch`: where something was, there are no hypotheses.
    """

    def following(done: int, total: int) -> None:
        if tell is not None:
            tell("following the ring", done, total)

    system = refiner.system
    if start is not None and start.hypotheses:
        nothing = _standing(system, start.nuisance)
        led = FollowedSearch(refiner, nothing, most_causes, following, near=True, enough=enough)
        led.follow_from(start.hypotheses, stuck=start.stuck)
        rung = led.fitted() if led.arrived and not led.ended else None
        return Found((), rung or (), faint=rung is not None)
    start = Start(refiner.calibrated.at) if start is None else start
    nothing = _nothing(system, start)
    near = nothing.left < FAINT and nothing.about is None
    alone = None if enough else _by_nothing(refiner, nothing, most_causes, following)
    if alone is not None:
        return alone
    told = near_noise(refiner, nothing, start, following) if near else None
    if told is not None:
        nothing, about, screened = told.nothing, told.about, told.screened
        again = sharper_than_stated(refiner, about) if enough is None else None
        if again is not None or not told.is_promising:
            return Found(screened, told.faintly, faint=True, again=again, alone=about)
        single = told.single(refiner)
    else:
        about, screened, single = _promised(refiner, nothing, following, near=start.seen)
        single = [*whole_onward(system, refiner.candidates, nothing), *single]
    led = FollowedSearch(refiner, nothing, most_causes, following, near=near, enough=enough)
    # Where parameters alone come to the noise, what they made up for could be several things.
    first = _abreast(single) if nothing.left < FAINT else _of_one_kind(single)
    if not near and _leads_bent(nothing):
        led.lead_first(first[:1])
        led.lead_released()
        to_noise = nothing.left < FAINT
        first = [] if led.arrived and not (led.is_poor or to_noise) else first[1:]
    if enough is not None:
        led.lead_first(first)
    led.follow(first, single, guessed=about.followed.telling < 1.0)
    if led.ended:
        return Found(screened, (), faint=True)
    # A pilot's poor law is told by the other recordings; that of a single one is asked of lines.
    poor = led.is_poor and enough is None
    if told is not None or (led.arrived and not poor):
        rung = led.fitted()
        fitted = (rung or ()) if told is None else told.beside(rung)
        return Found(screened, fitted, faint=True, alone=about if near else None)
    foretold = 1.0 if led.arrived else _foretold(nothing)
    at_once = None if foretold == 1.0 else begins(system, nothing.point, foretold)
    return Found(
        (), (), faint=False, led=Led(led, single), foretold=foretold, begins=at_once,
        foretells=led.foretells_most,
    )  # fmt: skip


def _promised(
    refiner: Refiner, nothing: Followed, tell: Progress, near: Faint | None = None
) -> tuple[Faint, list[Scored], list[Guess]]:
    """What is about where parameters alone lead, in straight lines, and in any size."""
    about = faint(refiner.system, nothing, free_of(refiner.system), tell, near=near)
    screened = one_more(about, refiner)
    straight = [guessed(about, refiner, one) for one in screened]
    sized = in_any_size(refiner.system, refiner.candidates, nothing, straight)
    return about, screened, sized


def _by_nothing(
    refiner: Refiner, nothing: Followed, most_causes: int, tell: Progress
) -> Found | None:
    """What parameters alone tell: how loud noise is, or when a rest ends; None: neither."""
    again = as_loud_as_it_is(refiner.system, nothing)
    if again is not None:
        return Found((), (), faint=False, again=again)
    if _tells_nothing(refiner.system, nothing):
        return _out_of_rest(refiner, nothing, most_causes, tell)
    return None


def _out_of_rest(refiner: Refiner, nothing: Followed, most_causes: int, tell: Progress) -> Found:
    """What the moment tells in which a rest ends that parameters alone foretell.

    Which place has how much of it, the ring that follows tells. Where none leads to the noise,
    lines are asked.
    """
    _, screened, single = _promised(refiner, nothing, tell)
    led = FollowedSearch(refiner, nothing, most_causes, tell)
    apart = [replace(one, state=one.state.apart()) for one in single[:PROMISED]]
    led.follow(apart, single, seen=True)
    rung = led.fitted() if led.arrived and not led.is_poor else None
    if rung is not None:
        return Found(screened, rung, faint=True)
    return Found((), (), faint=False, led=Led(led, single), foretells=led.foretells_most)


def _foretold(nothing: Followed) -> float:
    """Up to which share of the time parameters alone foretell all, before nothing does.

    What was left out acts from the beginning: parameters make up for it, or lose the ring at once.
    Where they have foretold half of the motion, and nothing foretells the rest, the motion may have
    grown of itself, out of what is too small to be seen.
    """
    share, _ = nothing.reached
    about = nothing.about
    bent = nothing.strain > STRAIN or (about is not None and about.telling <= share)
    return share if LONG <= share < 1.0 and not bent else 1.0


def _nothing(system: System, start: Start) -> Followed:
    """Parameters alone, led as far as they lead, begun otherwise where that is not to the end."""
    if start.near:
        near = follow_ring(system, start.nuisance, everything=True, near=True, lent=start.lent)
        return valley(system, near).led
    nothing = follow_ring(system, start.nuisance, everything=True)
    if nothing.left > FAINT or nothing.about is not None:
        begun = begun_otherwise(system, start.nuisance)
        if begun is not None:
            other = follow_ring(system, begun.nuisance, everything=True)
            nothing = min(nothing, other, key=lambda one: (-one.reached[0], cost_of(one)))
    return valley(system, nothing).led


def _standing(system: System, nuisance: Array) -> Followed:
    """Parameters where they stand, not led."""
    at = Followed(nuisance, None, share=0.0)
    (found,) = Samples(system, everything=True).residuals([at.point])
    return replace(at, misfit=float(found @ found), left=float(np.mean(found**2)))


def _leads_bent(nothing: Followed) -> bool:
    """Whether parameters alone lead over most of the time, bent."""
    return nothing.share > MOST_OF_IT and nothing.is_bent


def _tells_nothing(system: System, nothing: Followed) -> bool:
    """Whether nothing moves as long as parameters alone foretell what is recorded.

    As where a rest is followed, and the motion is lost as it begins.
    """
    before = nothing.share - 1.0 / STRETCHES
    if nothing.reached[0] > 0.0 or before <= 0.0:
        return False
    return Samples(system, everything=True, share=before).motion < FAINT


def _of_one_kind(single: Sequence[Guess]) -> list[Guess]:
    """The likeliest single cause, in other places too, where these are promised."""
    return [one for one in single if one.hypothesis.names == single[0].hypothesis.names]


def _abreast(single: Sequence[Guess]) -> list[Guess]:
    """The likeliest of what the ring tells in straight lines; rivals among them."""
    least = max((one.log_score for one in single), default=0.0) - ABREAST
    return [one for one in single if one.log_score > least][:MOST_ABREAST]
