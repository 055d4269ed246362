"""The search: parameters, what the ring tells, what lines tell, and what both come to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from analysis.engine.all_samples import noise_of
from analysis.engine.array import Array
from analysis.engine.by_lines import by_lines
from analysis.engine.by_ring import by_ring
from analysis.engine.calibrate import Calibrated
from analysis.engine.finder import Tell
from analysis.engine.fitted import Fitted
from analysis.engine.found import Found, Start
from analysis.engine.lens import Lens
from analysis.engine.limits import Limit, limits_of
from analysis.engine.look import look
from analysis.engine.louder import Louder, louder_than_stated
from analysis.engine.moved import Beside, moved_far, released, released_beside
from analysis.engine.opening import from_opening, opening_of
from analysis.engine.part import has_several, rings
from analysis.engine.pilot import by_pilot
from analysis.engine.refine import Refiner
from analysis.engine.screen import Scored
from analysis.engine.settled import settled
from analysis.engine.sharper import Sharper, Told
from analysis.engine.system import Point, System
from analysis.engine.until import Until

REMAINS_ALONE = 0.1
"""Where nothing is on, there is no law that could be a little off: what is so much more than noise
for each sample is something."""


@dataclass(frozen=True)
class Search:
    """Everything that was found out.

    Attributes
    ----------
    system, lens, data
        What was looked at, the recording up to some time where nothing foretells the rest; data are
        its features, shape (f,).
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
    aside
        Recordings that count for nothing there: what is on could not be led through them.
    moved
        Candidates whose numbers nothing left out has moved too far, and by how many sigmas.
    beside
        Names of hypotheses -> which of their causes is such a number beside the others, and by how
        many sigmas it had moved without.
    limits
        From which size on causes would have been told; none: parameters alone did not come to the
        noise of every sample.
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
    aside: tuple[str, ...] = ()
    moved: Mapping[str, float] = field(default_factory=dict)
    beside: Beside = field(default_factory=dict)
    limits: tuple[Limit, ...] = ()

    @property
    def lost(self) -> bool:
        """Whether the system rings, and nothing could be led to the ring's phase."""
        return rings(self.system) and not self.faint


def search(
    system: System,
    tell: Tell | None = None,
    *,
    anew: bool = False,
    most_causes: int = 3,
    start: Start | None = None,
    loud: bool = True,
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
    start
        From where what rings is led; None: from the likeliest parameters.
    loud
        Whether samples may tell that noise is more than stated.
    """
    lens, data, calibrated = look(system, tell)
    louder = _louder(system, calibrated) if loud and not rings(system) else None
    if louder is not None:
        return search(louder, tell, anew=anew, most_causes=most_causes)
    refiner = Refiner(system, lens, data, calibrated, anew=anew)
    null = refiner.nothing()

    found = Found((), (), faint=False)
    opening = opening_of(system) if start is None else None
    if opening is not None:
        found = _from_opening(refiner, opening, most_causes, tell)
    if rings(system) and not found.fitted and found.led is None:
        several = has_several(system)
        if several:
            found = by_pilot(refiner, most_causes, tell, start)
        else:
            found = by_ring(refiner, most_causes, tell, start)
    if found.again is not None:
        other, start = found.again
        return search(other, tell, anew=anew, most_causes=most_causes, start=start)
    if not found.fitted and found.foretold < 1.0 and not isinstance(system, Until):
        cut = Until(system, found.foretold, found.begins)
        return search(cut, tell, anew=anew, most_causes=most_causes)
    if not found.fitted and (found.foretells is None or isinstance(system, Until)):
        found = by_lines(refiner, null, most_causes, tell, found.led)
    if found.foretells is not None and not isinstance(system, Until):
        best = found.foretells
        start = Start(best.nuisance, (best,))
        cut = Until(system, best.share, by_cause=True)
        return search(cut, tell, anew=anew, most_causes=most_causes, start=start)
    if not rings(system):
        refiner = refiner if anew else Refiner(system, lens, data, calibrated, anew=True)
        found = found._replace(fitted=settled(refiner, null, found.fitted, as_they_are=anew))
        null = next(one for one in found.fitted if not one.hypothesis.parts)
        quieter = _quieter(system, found.fitted[0]) if loud else None
        if quieter is not None:
            return search(quieter, tell, anew=anew, most_causes=most_causes, loud=False)
    if isinstance(system, Sharper):
        found = found._replace(fitted=_as_stated(found.fitted, system.told))
    alone = next((one for one in found.fitted if not one.hypothesis.parts), null)
    moved = _moved(system, alone) if found.faint or not rings(system) else {}
    more, beside = _released(refiner, found.fitted, alone, moved, most_causes)
    fitted = (*found.fitted, *more)
    limits = () if found.alone is None else limits_of(found.alone, refiner.candidates)
    return Search(
        system, lens, data, calibrated, tuple(found.screened), null, fitted, refiner,
        faint=found.faint, aside=found.aside, moved=moved, beside=beside, limits=limits,
    )  # fmt: skip


def _from_opening(refiner: Refiner, opening: Until, most_causes: int, tell: Tell | None) -> Found:
    """What the first part of a long recording says, led through the whole; nothing: nowhere.

    Where parameters alone explain the first part, the ring of the whole is asked from there.
    """
    told = search(opening, tell, most_causes=most_causes)
    start = from_opening(refiner.system, told.fitted) if told.faint else None
    if start is None:
        return Found((), (), faint=False)
    found = by_ring(refiner, most_causes, tell, start)
    return found._replace(screened=found.screened or told.screened)


def _louder(system: System, calibrated: Calibrated) -> Louder | None:
    """The system with the noise that its samples have; None: as it is."""
    told = isinstance(system, Louder)
    return None if told else louder_than_stated(system, Point(calibrated.at))


def _quieter(system: System, best: Fitted) -> System | None:
    """The system with less noise, where what explains best is rough itself; None: as it is."""
    return system.beside(best.point) if isinstance(system, Louder) else None


def _as_stated(fitted: Sequence[Fitted], told: Told) -> list[Fitted]:
    """Hypotheses, nothing on no farther behind than where parameters are as free as suits it."""
    on = [one for one in fitted if one.hypothesis.parts]
    if not on:
        return list(fitted)
    # Where the cause itself was not led, what was found in its stead.
    same = [one for one in on if one.hypothesis.names == (told.cause,)]
    likely = max(one.log_score for one in same or on)
    found = [
        one
        if one.hypothesis.parts
        else replace(one, log_score=max(one.log_score, likely - told.rises))
        for one in fitted
    ]
    return sorted(found, key=lambda one: -one.log_score)


def _released(
    refiner: Refiner,
    fitted: Sequence[Fitted],
    alone: Fitted,
    moved: Mapping[str, float],
    most_causes: int,
) -> tuple[list[Fitted], Beside]:
    """Numbers that moved too far, alone and beside what is likeliest, and which these are.

    What does not ring has all of them among its hypotheses.
    """
    if not rings(refiner.system):
        return [], {}
    named = {one.hypothesis.names for one in fitted}
    left = [name for name in moved if (name,) not in named]
    more, beside = released_beside(refiner, fitted, noise_of(refiner.system), most_causes)
    return [*more, *(released(refiner, alone, name) for name in left)], beside


def _moved(system: System, alone: Fitted) -> dict[str, float]:
    """Numbers that moved too far where nothing left out was led to the noise."""
    if not alone.left < noise_of(system) + REMAINS_ALONE:
        return {}
    known = {one.name for one in system.candidates}
    far = moved_far(system.nuisances, alone.point.nuisance)
    return {name: sigmas for name, sigmas in far.items() if name in known}
