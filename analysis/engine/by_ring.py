"""What the ring tells: hypotheses by every sample, where they can be led to the noise."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.all_samples import WORTH_IT, cost_of, elsewhere_than, noise_of
from analysis.engine.beginnings import begun_otherwise
from analysis.engine.cycles import valley
from analysis.engine.faint import Faint, faint
from analysis.engine.faint_search import faint_search, guessed, one_more
from analysis.engine.finder import Tell
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed, Lent
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.part import has_several
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT, STRETCHES, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import Scored
from analysis.engine.sharper import Sharper, Told, how_sharp, scales_of
from analysis.engine.stride import strides_of
from analysis.engine.stride_search import stride_guesses
from analysis.engine.system import Array, Candidate, System
from analysis.engine.until import Until
from analysis.engine.way import STRAIN
from analysis.engine.whole import whole_guesses, whole_onward

WORTH_FOLLOWING = 8.0
"""What is faint, and in straight lines this far before nothing, is led to the phase as well."""

ABREAST, MOST_ABREAST = 12.0, 4
"""Of causes that are faint, so many that are no farther behind the first are led to the phase."""

MOST_OF_IT = 0.5
"""Where parameters alone lead over this share of the time, bent far, they may be what is off."""

LONG = 0.4
"""Where parameters alone have foretold this share of the time, nothing was left out of that."""

MUCH = 0.5
"""Where no cause promises to explain this share of what parameters leave beyond noise, those may
have come to a hollow beside their valley: they are led once more from elsewhere."""


class Found(NamedTuple):
    """Single causes to first order, hypotheses, whether by the ring, and what was led so far.

    Of several recordings, those that stand aside: hypotheses do not count what is there. Up to
    which share of the time anything can be foretold, and a cause that foretells some of it. How
    much better than stated loosely known parameters are known, and from where to begin anew so.
    Where parameters alone came to the noise, everything about there.
    """

    screened: Sequence[Scored]
    fitted: Sequence[Fitted]
    faint: bool
    led: "Led | None" = None
    aside: tuple[str, ...] = ()
    foretold: float = 1.0
    foretells: Followed | None = None
    sharper: "tuple[Told, Start] | None" = None
    alone: Faint | None = None


class Led(NamedTuple):
    """What was led to the ring's phase so far, and what the ring promised alone.

    Where parameters alone foretell nothing that moves, it was not asked: where they have come.
    """

    search: FollowedSearch
    single: Sequence[Guess]
    still: Followed | None = None

    def promised(self, refiner: Refiner) -> Sequence[Guess]:
        """What the ring promises, from the moment on at which something moves if need be."""
        if self.still is None:
            return self.single
        about = faint(refiner.system, self.still, _free(refiner.system))
        return [guessed(about, refiner, one) for one in one_more(about, refiner)]


class Start(NamedTuple):
    """Where some of the recordings have led to, from where all of them are.

    Attributes
    ----------
    nuisance
        Of parameters alone, in sigmas.
    hypotheses
        What was found there, the best first, with nuisances of the whole system. None: parameters
        alone came to the noise.
    near
        Whether parameters alone ring in phase there.
    lent
        What nuisances do to all samples about there; None: not known.
    seen
        What candidates do about a place that may be near; None: not known.
    stuck
        See `FollowedSearch.follow_from`.
    """

    nuisance: Array
    hypotheses: Sequence[Followed] = ()
    near: bool = False
    lent: Lent | None = None
    seen: Faint | None = None
    stuck: bool = False


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
    if enough is None and _tells_nothing(system, nothing):
        led = FollowedSearch(refiner, nothing, most_causes, following)
        return Found((), (), faint=False, led=Led(led, [], nothing))
    asked = system.candidates if near else _free(system)
    strides = strides_of(system.candidates, system.nuisances) if near else ()
    about = faint(system, nothing, asked, following, near=start.seen, strides=strides)
    if near:
        screened, faintly = faint_search(about, refiner, refiner.candidates)
        other = _out_of_hollow(system, start.nuisance, nothing, faintly)
        if other is not None:
            nothing = other
            about = faint(system, nothing, system.candidates, following, strides=strides)
            screened, faintly = faint_search(about, refiner, refiner.candidates)
        afar = stride_guesses(about, refiner.candidates, faintly)
        sharper = _sharper(refiner, about) if enough is None else None
        if sharper is not None or not _promising(faintly, afar):
            return Found(screened, faintly, faint=True, sharper=sharper, alone=about)
        single = [Guess.of(one) for one in faintly if len(one.hypothesis.parts) == 1]
        single += [*afar, *whole_guesses(system, refiner.candidates, about)]
        single.sort(key=lambda one: -one.log_score)
    else:
        screened, faintly, afar = one_more(about, refiner), [], []
        single = [guessed(about, refiner, one) for one in screened]
        single = [*whole_onward(system, refiner.candidates, nothing), *single]
    led = FollowedSearch(refiner, nothing, most_causes, following, near=near, enough=enough)
    # Where parameters alone come to the noise, what they made up for could be several things.
    first = _abreast(single) if nothing.left < FAINT else _of_one_kind(single)
    if not near and _leads_bent(nothing):
        led.lead_first(first[:1])
        led.lead_released()
        first = [] if led.arrived and not led.is_poor else first[1:]
    if enough is not None:
        led.lead_first(first)
    led.follow(first, single, guessed=about.followed.telling < 1.0)
    if led.ended:
        return Found(screened, (), faint=True)
    # A pilot's poor law is told by the other recordings; that of a single one is asked of lines.
    poor = led.is_poor and enough is None
    if near or (led.arrived and not poor):
        rung = led.fitted()
        fitted = faintly if rung is None else _beside(rung, faintly, afar)
        return Found(screened, fitted, faint=True, alone=about if near else None)
    foretold = 1.0 if led.arrived else _foretold(nothing)
    return Found((), (), faint=False, led=Led(led, single), foretold=foretold)


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


def _free(system: System) -> list[Candidate]:
    """Candidates whose magnitude is free."""
    return [one for one in system.candidates if not one.fixed]


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


def _out_of_hollow(
    system: System, at: Array, nothing: Followed, faintly: Sequence[Fitted]
) -> Followed | None:
    """Parameters led from elsewhere, where they had come to a hollow; None: they had not."""
    if not _is_hollow(system, nothing, faintly):
        return None
    begun = begun_otherwise(system, at)
    starts = [elsewhere_than(nothing), *([] if begun is None else [begun.nuisance])]
    others = [follow_ring(system, one, everything=True) for one in starts]
    elsewhere = min(others, key=cost_of)
    return elsewhere if cost_of(elsewhere) < cost_of(nothing) - WORTH_IT else None


def _sharper(refiner: Refiner, about: Faint) -> tuple[Told, Start] | None:
    """How much better than stated loosely known parameters are known, and from where to go on.

    None: no better, or no cause would be told by it.
    """
    system, nothing = refiner.system, about.followed
    if isinstance(system, (Sharper, Until)):
        return None
    told = how_sharp(system, about, refiner.candidates)
    if told is None or told.rises < WORTH_FOLLOWING:
        return None
    scales = scales_of(system, told.share)
    nuisance = np.where(scales < 1.0, 0.0, nothing.nuisance)
    lent = nothing.lends
    if lent is not None:
        lent = lent._replace(columns=lent.columns * scales[:, None])
    return told, Start(nuisance, near=True, lent=lent, seen=about)


def _is_hollow(system: System, nothing: Followed, faintly: Sequence[Fitted]) -> bool:
    """Whether parameters leave more than noise, and nothing promises to explain much of that."""
    noise = noise_of(system)
    if nothing.left < noise or has_several(system):
        return False
    alone = next(one for one in faintly if not one.hypothesis.parts)
    beyond = 0.5 * nothing.misfit * (1.0 - noise / nothing.left)
    return faintly[0].log_score - alone.log_score < MUCH * beyond


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

    As where a rest is followed, and the motion is lost as it begins: what the ring promises was
    told by the rest. Lines tell more.
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


def _beside(
    rung: Sequence[Fitted], faintly: Sequence[Fitted], afar: Sequence[Guess]
) -> list[Fitted]:
    """What was led to the ring's phase, and single causes that were not, as far behind as told."""
    led = {one.hypothesis.names: one.log_score for one in rung}
    told = {one.hypothesis.names: one.log_score for one in faintly}
    told |= {one.hypothesis.names: one.log_score for one in afar}
    common = [names for names in told if names in led and names]
    if not common:
        return list(rung)
    rise = max(led[names] for names in common) - max(told[names] for names in common)
    others = [
        replace(one, log_score=one.log_score + rise)
        for one in faintly
        if one.hypothesis.names not in led and len(one.hypothesis.parts) == 1
    ]
    return sorted([*rung, *others], key=lambda one: -one.log_score)


def _promising(faintly: Sequence[Fitted], afar: Sequence[Guess]) -> bool:
    """Whether anything explains, in straight lines or from afar, much more than parameters do."""
    nothing = next(one for one in faintly if not one.hypothesis.parts)
    best = max([faintly[0].log_score, *(one.log_score for one in afar)])
    return best > nothing.log_score + WORTH_FOLLOWING
