"""What the ring tells where parameters alone came near the noise: in straight lines about there."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.engine.all_samples import WORTH_IT, cost_of, elsewhere_than, noise_of
from analysis.engine.array import Array
from analysis.engine.beginnings import begun_otherwise
from analysis.engine.faint import Faint, faint
from analysis.engine.faint_search import faint_search
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.found import Start
from analysis.engine.guess import Guess
from analysis.engine.louder import MOST, louder_than_stated
from analysis.engine.part import has_several
from analysis.engine.refine import Refiner
from analysis.engine.restated import Restated
from analysis.engine.ring_fit import FAINT, follow_ring
from analysis.engine.screen import Scored
from analysis.engine.sensitivity import Progress
from analysis.engine.sharper import Sharper, how_sharp, scales_of
from analysis.engine.stride import strides_of
from analysis.engine.stride_search import stride_guesses
from analysis.engine.system import System
from analysis.engine.until import Until
from analysis.engine.whole import whole_guesses

WORTH_FOLLOWING = 8.0
"""What is faint, and in straight lines this far before nothing, is led to the phase as well."""

FROM_AFAR = 8.0
"""And so is what is likelier by so much, as it usually is, than straight lines say; what is so by
less counts as that, where it is no farther behind nothing than"""

NOT_YET_OUT = 6.0
"""this."""

CLOSE_BY, TRIED, LITTLE = 12.0, 2, 150.0
"""Where nothing is promised, so many of what is no farther behind nothing, as it usually is, are
led for so many whole simulations: a ring is no straight line either."""

MUCH = 0.5
"""Where no cause promises to explain this share of what parameters leave beyond noise, those may
have come to a hollow beside their valley: they are led once more from elsewhere."""


@dataclass(frozen=True)
class NearNoise:
    """What may be there beside parameters that came near the noise.

    Attributes
    ----------
    nothing
        Where they came.
    about
        Everything about there.
    screened, faintly
        Single causes to first order, and hypotheses, as `faint_search` has them.
    afar
        Causes that are far likelier as they usually are.
    """

    nothing: Followed
    about: Faint
    screened: Sequence[Scored]
    faintly: Sequence[Fitted]
    afar: Sequence[Guess]

    @property
    def is_promising(self) -> bool:
        """Whether anything explains much more than parameters do, to first order or from afar."""
        alone = next(one for one in self.faintly if not one.hypothesis.parts)
        best = max([self.faintly[0].log_score, *(one.log_score for one in self.afar)])
        return best > alone.log_score + WORTH_FOLLOWING

    def single(self, refiner: Refiner) -> list[Guess]:
        """Single causes to be led from here, the likeliest first."""
        found = [Guess.of(one) for one in self.faintly if len(one.hypothesis.parts) == 1]
        found += self.afar
        found += whole_guesses(refiner.system, refiner.candidates, self.about)
        return sorted(found, key=lambda one: -one.log_score)

    def beside(self, rung: Sequence[Fitted] | None) -> Sequence[Fitted]:
        """What was led to the ring's phase, and single causes that were not, as far behind as told.

        Parameters
        ----------
        rung
            What was led; None: nothing was.
        """
        if rung is None:
            return self.faintly
        led = {one.hypothesis.names: one.log_score for one in rung}
        told = {one.hypothesis.names: one.log_score for one in self.faintly}
        told |= {one.hypothesis.names: one.log_score for one in self.afar}
        common = [names for names in told if names in led and names]
        if not common:
            return list(rung)
        rise = max(led[names] for names in common) - max(told[names] for names in common)
        others = [
            replace(one, log_score=one.log_score + rise)
            for one in self.faintly
            if one.hypothesis.names not in led and len(one.hypothesis.parts) == 1
        ]
        return sorted([*rung, *others], key=lambda one: -one.log_score)


def near_noise(
    refiner: Refiner, nothing: Followed, start: Start, progress: Progress | None
) -> NearNoise:
    """What may be there; where parameters had come to a hollow, about where they are led from it.

    Parameters
    ----------
    refiner
        Fits hypotheses.
    nothing
        Parameters alone, near the noise.
    start
        From where they were led.
    progress
        Told of it.
    """
    system, candidates = refiner.system, refiner.candidates
    strides = strides_of(system.candidates, system.nuisances)
    about = faint(system, nothing, system.candidates, progress, near=start.seen, strides=strides)
    screened, faintly = faint_search(about, refiner, candidates)
    # Known better, parameters come to no other hollow than they came to before.
    known_better = start.seen is not None
    other = None if known_better else _out_of_hollow(system, start.nuisance, nothing, faintly)
    if other is not None:
        nothing = other
        about = faint(system, nothing, system.candidates, progress, strides=strides)
        screened, faintly = faint_search(about, refiner, candidates)
    whole = stride_guesses(about, candidates, faintly)
    usual, afar = _as_usual(refiner, nothing, faintly, whole)
    found = NearNoise(nothing, about, screened, usual, afar)
    if found.is_promising or has_several(system):
        return found
    return replace(found, afar=[*afar, *_led_a_little(refiner, nothing, usual, whole)])


def _as_usual(
    refiner: Refiner, nothing: Followed, faintly: Sequence[Fitted], whole: Sequence[Guess]
) -> tuple[list[Fitted], list[Guess]]:
    """Hypotheses, causes as they usually are in the place of straight lines; and far likelier ones.

    The latter are to be led, and stand as straight lines have them until then.
    """
    found = {one.hypothesis.names: one for one in faintly}
    told = {names: one.log_score for names, one in found.items()}
    alone, afar = told[()], []
    for one in whole:
        names = one.hypothesis.names
        if one.log_score > told.get(names, alone) + FROM_AFAR:
            afar.append(one)
        elif one.log_score > alone - NOT_YET_OUT:
            there = refiner.standing(one.state, one.nuisance)
            found[names] = replace(there, log_score=one.log_score, left=nothing.left)
    return sorted(found.values(), key=lambda one: -one.log_score), afar


def _led_a_little(
    refiner: Refiner, nothing: Followed, faintly: Sequence[Fitted], whole: Sequence[Guess]
) -> list[Guess]:
    """Causes as they usually are, from where a few steps led, that are likelier than nothing."""
    alone = next(one.log_score for one in faintly if not one.hypothesis.parts)
    found = []
    for one in whole[:TRIED]:
        if one.log_score < alone - CLOSE_BY:
            break
        led = follow_ring(
            refiner.system, one.nuisance, one.state, everything=True, near=True,
            ahead=nothing.costs, most=LITTLE, lent=nothing.lends,
        )  # fmt: skip
        rise = 0.5 * (cost_of(nothing) - cost_of(led))
        score = alone + rise + one.hypothesis.log_prior(refiner.candidates)
        if led.state is not None and score > alone + WORTH_FOLLOWING:
            found.append(Guess(led.state, led.nuisance, score))
    return found


def sharper_than_stated(refiner: Refiner, about: Faint) -> tuple[System, Start] | None:
    """Loosely known parameters as well known as the recording tells, and from where to go on.

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
    return Sharper(system, told), Start(nuisance, near=True, lent=lent, seen=about)


def as_loud_as_it_is(system: System, nothing: Followed) -> tuple[System, Start] | None:
    """The noise that samples have, told where parameters alone led to the end, and a new beginning.

    None: it is what is stated, or what is left is more than any noise.
    """
    led = nothing.to_end and nothing.about is None and nothing.left < FAINT * MOST
    if not led or isinstance(system, Restated):
        return None
    found = louder_than_stated(system, nothing.point)
    return None if found is None else (found, Start(nothing.nuisance, near=True))


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


def _is_hollow(system: System, nothing: Followed, faintly: Sequence[Fitted]) -> bool:
    """Whether parameters leave more than noise, and nothing promises to explain much of that."""
    noise = noise_of(system)
    if nothing.left < noise or has_several(system):
        return False
    alone = next(one for one in faintly if not one.hypothesis.parts)
    beyond = 0.5 * nothing.misfit * (1.0 - noise / nothing.left)
    return faintly[0].log_score - alone.log_score < MUCH * beyond
