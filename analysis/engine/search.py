"""The search: parameters, what the ring tells, what lines tell, and what both come to."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from analysis.engine.calibrate import Calibrated, calibrate
from analysis.engine.faint import faint
from analysis.engine.faint_search import faint_search, ring_promises
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

    def following(done: int, total: int) -> None:
        if tell is not None:
            tell("following the ring", done, total)

    def found(screened: Sequence[Scored], fitted: Sequence[Fitted], *, faint: bool) -> Search:
        return Search(
            system, lens, data, calibrated, tuple(screened), null, tuple(fitted), refiner,
            faint=faint,
        )  # fmt: skip

    if not rings(system):
        finder = Finder(refiner, _terms(system, lens, calibrated, tell), tell)
        singles = finder.find(null, most_causes)
        return found(singles, finder.ranked(), faint=False)
    nothing = follow_ring(system, calibrated.at, everything=True)
    chosen = [one for one in system.candidates if not one.fixed]
    about = faint(system, nothing.about or nothing, chosen, following)
    screened, faintly = faint_search(about, refiner, refiner.candidates)
    near = nothing.left < FAINT
    if near and not _promising(faintly):
        return found(screened, faintly, faint=True)
    promises = (
        [one for one in faintly if one.hypothesis.parts] if near else ring_promises(about, refiner)
    )
    single = [one for one in promises if len(one.hypothesis.parts) == 1]
    led = FollowedSearch(refiner, nothing, most_causes, following, near=near)
    led.follow(_to_follow(null, single, single if near else ()), single)
    if near or led.explains:
        return found(screened, led.fitted() or faintly, faint=True)
    finder = Finder(refiner, _terms(system, lens, calibrated, tell), tell)
    singles = finder.find(null, most_causes)
    ranked = finder.ranked()
    alone = [one for one in ranked if len(one.hypothesis.parts) == 1]
    led.follow(_to_follow(null, single, ranked), [*single, *alone])
    rung = led.fitted()
    return found(singles, rung or ranked, faint=rung is not None)


def _terms(system: System, lens: Lens, calibrated: Calibrated, tell: Tell | None) -> Columns:
    """What every candidate would do to the lines."""

    def causes(done: int, total: int) -> None:
        if tell is not None:
            tell("simulating what each cause would do", done, total)

    return term_columns(system, lens, system.candidates, calibrated.at, calibrated.columns, causes)


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


def rings(system: System) -> bool:
    """Whether the system has tones of its own."""
    return any(bundle.tones_hz for bundle in system.bundles)


def _promising(faintly: Sequence[Fitted]) -> bool:
    """Whether anything explains, in straight lines, much more than parameters do."""
    nothing = next(one for one in faintly if not one.hypothesis.parts)
    return faintly[0].log_score > nothing.log_score + WORTH_FOLLOWING
