"""The search: parameters, what the ring tells, what lines tell, and what both come to."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from analysis.engine.calibrate import Calibrated, calibrate
from analysis.engine.faint import faint
from analysis.engine.faint_search import faint_search, fitted_there, one_more
from analysis.engine.finder import Finder, Tell
from analysis.engine.fitted import Fitted
from analysis.engine.followed_search import FAR_BEHIND, FollowedSearch
from analysis.engine.lens import Lens
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT, follow_ring
from analysis.engine.screen import Scored, Screen
from analysis.engine.sensitivity import Columns, term_columns
from analysis.engine.system import Array, System

FOLLOWED = 2
"""Of what the ring promises, and of what is likely without it, so many are led to its phase."""

WORTH_FOLLOWING = 8.0
"""What is faint, and in straight lines this far before nothing, is led to the phase as well."""

ABREAST, MOST_ABREAST = 12.0, 4
"""Of causes that are faint, so many that are no farther behind the first are led to the phase."""

UNLIKELY, SEEN = 6.0, 8.0
"""What is this far behind nothing, without the ring, is not likely; and what is so far before that,
is seen without it."""


@dataclass(frozen=True)
class Search:
    """Everything that was found out.

    Attributes
    ----------
    system, lens, data
        What was looked at; data are its features, shape (f,).
    calibrated
        The system at its likeliest parameters.
    screened
        Single candidates to first order, the best first.
    null
        Nothing left out, parameters fitted.
    fitted
        Hypotheses fitted in earnest, the best first; the null among them.
    refiner
        Fits more.
    faint
        Whether parameters alone lead to the noise, so that scores are those of the followed ring.
    """

    system: System
    lens: Lens
    data: Array
    calibrated: Calibrated
    screened: tuple[Scored, ...]
    null: Fitted
    fitted: tuple[Fitted, ...]
    refiner: Refiner
    faint: bool = False

    @property
    def lost(self) -> bool:
        """Whether the system rings, and nothing could be led to the ring's phase."""
        return rings(self.system) and not self.faint


class Look(NamedTuple):
    """The system at its likeliest parameters."""

    lens: Lens
    data: Array
    calibrated: Calibrated


def look(system: System, tell: Tell | None = None) -> Look:
    """Fit the parameters."""
    lens = Lens(list(system.bundles))
    data = lens.of_data()

    def parameters(done: int, total: int) -> None:
        if tell is not None:
            tell("fitting parameters", done, total)

    return Look(lens, data, calibrate(system, lens, data, parameters))


def search(
    system: System, tell: Tell | None = None, *, anew: bool = False, most_causes: int = 3
) -> Search:
    """Look for what explains the recording.

    Parameters
    ----------
    system
        What was recorded and how it is simulated.
    tell
        Told of progress.
    anew
        Beside each hypothesis, simulate anew what nuisances and candidates do: for a system in
        which one thing changes what another does, and that is quickly simulated.
    most_causes
        Of a hypothesis.
    """
    lens, data, calibrated = look(system, tell)
    refiner = Refiner(system, lens, data, calibrated, anew=anew)
    null = refiner.fit(Screen(calibrated.problem, refiner.candidates, {}).null())

    found = _Found((), (), faint=False)
    if rings(system):
        found = _by_ring(refiner, most_causes, tell)
    if not found.fitted:
        found = _by_lines(refiner, null, most_causes, tell, found.led)
    return Search(
        system, lens, data, calibrated, tuple(found.screened), null, tuple(found.fitted), refiner,
        faint=found.faint,
    )  # fmt: skip


class _Found(NamedTuple):
    """Single causes to first order, hypotheses, whether by the ring, and what was led so far."""

    screened: Sequence[Scored]
    fitted: Sequence[Fitted]
    faint: bool
    led: "_Led | None" = None


class _Led(NamedTuple):
    """What was led to the ring's phase so far, and what the ring promised alone."""

    search: FollowedSearch
    single: Sequence[Fitted]


def _by_ring(refiner: Refiner, most_causes: int, tell: Tell | None) -> _Found:
    """By every sample, ring and all; no hypotheses, where that does not come to the noise."""

    def following(done: int, total: int) -> None:
        if tell is not None:
            tell("following the ring", done, total)

    system = refiner.system
    nothing = follow_ring(system, refiner.calibrated.at, everything=True)
    chosen = [one for one in system.candidates if not one.fixed]
    about = faint(system, nothing, chosen, following)
    near = nothing.left < FAINT and nothing.about is None
    if near:
        screened, faintly = faint_search(about, refiner, refiner.candidates)
        if not _promising(faintly):
            return _Found(screened, faintly, faint=True)
        single = [one for one in faintly if len(one.hypothesis.parts) == 1]
    else:
        promised = one_more(about, refiner)
        screened, faintly = promised, []
        single = [fitted_there(about, refiner, one) for one in promised]
    led = FollowedSearch(refiner, nothing, most_causes, following, near=near)
    # Where parameters alone come to the noise, what they made up for could be several things.
    led.follow(_abreast(single) if nothing.left < FAINT else single[:1], single)
    if near or led.arrived:
        rung = led.fitted()
        return _Found(screened, faintly if rung is None else _beside(rung, faintly), faint=True)
    return _Found((), (), faint=False, led=_Led(led, single))


def _by_lines(
    refiner: Refiner, null: Fitted, most_causes: int, tell: Tell | None, led: _Led | None
) -> _Found:
    """By lines, the ring left out; what is found there is led to the phase of the ring, if any."""
    finder = Finder(refiner, _terms(refiner, tell), tell)
    singles = finder.singles(null)
    alone = [one for one in finder.ranked() if one.hypothesis.parts]
    if led is not None:
        led.search.follow(_to_follow(null, led.single, alone), [*alone, *led.single])
    if led is None or not led.search.arrived:
        finder.sets(most_causes)
    ranked = finder.ranked()
    if led is None:
        return _Found(singles, ranked, faint=False)
    if not led.search.arrived:
        led.search.follow(_to_follow(null, (), ranked), alone)
    rung = led.search.fitted()
    return _Found(singles, rung or ranked, faint=rung is not None)


def _terms(refiner: Refiner, tell: Tell | None) -> Columns:
    """What every candidate would do to the lines."""

    def causes(done: int, total: int) -> None:
        if tell is not None:
            tell("simulating what each cause would do", done, total)

    found, system = refiner.calibrated, refiner.system
    return term_columns(system, refiner.lens, system.candidates, found.at, found.columns, causes)


def _to_follow(
    null: Fitted,
    promises: Sequence[Fitted],
    ranked: Sequence[Fitted],
) -> list[Fitted]:
    """Hypotheses worth leading to the ring's phase, one for each set of candidates.

    What the ring promises, and what is likely without it.
    """
    least = null.log_score - UNLIKELY
    likely = [one for one in ranked if one.hypothesis.parts and one.log_score > least][:FOLLOWED]
    # Which places are on, lines tell better, where they tell anything.
    seen = {one.hypothesis.names: one for one in reversed(ranked) if one.log_score > least + SEEN}
    most = max((one.log_score for one in promises), default=0.0) - FAR_BEHIND
    told = [one for one in promises[:FOLLOWED] if one.log_score > most]
    known = (*(seen.get(one.hypothesis.names, one) for one in told), *likely)
    tried: dict[tuple[str, ...], Fitted] = {}
    for one in known:
        tried.setdefault(one.hypothesis.names, one)
    return list(tried.values())


def _abreast(single: Sequence[Fitted]) -> list[Fitted]:
    """The likeliest of what the ring tells in straight lines; rivals among them."""
    least = max(one.log_score for one in single) - ABREAST
    return [one for one in single if one.log_score > least][:MOST_ABREAST]


def _beside(rung: Sequence[Fitted], faintly: Sequence[Fitted]) -> list[Fitted]:
    """What was led to the ring's phase, and single causes that were not, as far behind as told."""
    led = {one.hypothesis.names: one.log_score for one in rung}
    told = {one.hypothesis.names: one.log_score for one in faintly}
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


def rings(system: System) -> bool:
    """Whether the system has tones of its own."""
    return any(bundle.tones_hz for bundle in system.bundles)


def _promising(faintly: Sequence[Fitted]) -> bool:
    """Whether anything explains, in straight lines, much more than parameters do."""
    nothing = next(one for one in faintly if not one.hypothesis.parts)
    return faintly[0].log_score > nothing.log_score + WORTH_FOLLOWING
