"""Recordings that stand aside: hypotheses are weighed by the others, and shown in all."""

from collections.abc import Sequence
from dataclasses import replace

from analysis.engine.array import Array
from analysis.engine.by_ring import by_ring
from analysis.engine.finder import Tell
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.found import Found, Start
from analysis.engine.part import Part, records_of
from analysis.engine.refine import Refiner
from analysis.engine.state import State


class _Some(Refiner):
    """Fits hypotheses to some of the recordings, and shows them in all.

    Parameters
    ----------
    whole
        Of all recordings.
    part
        Some of them.
    beside
        Nuisances of the others, of the whole system, in sigmas.
    """

    def __init__(self, whole: Refiner, part: Part, beside: Array) -> None:
        super().__init__(part, whole.lens, whole.data, whole.calibrated)
        self._whole, self._part, self._beside = whole, part, beside

    def at(self, state: State, nuisance: Array) -> Fitted:
        """As of the whole."""
        return self._whole.at(state, nuisance)

    def directions_of(self, nuisance: Array) -> Array:
        """Of the part's nuisances, the whole system's directions."""
        return self._whole.directions_of(self._part.whole(nuisance, self._beside))

    def shown(self, fitted: Fitted) -> Fitted:
        """A hypothesis with nuisances of the whole system."""
        nuisance = self._part.whole(fitted.point.nuisance, self._beside)
        return replace(fitted, point=replace(fitted.point, nuisance=nuisance))


def but_for(
    refiner: Refiner,
    begun: Sequence[Followed],
    aside: Sequence[str],
    most_causes: int,
    tell: Tell | None,
) -> Found:
    """What all recordings say of hypotheses, but for those that stand aside.

    Parameters
    ----------
    refiner
        Fits hypotheses to all recordings.
    begun
        Where hypotheses came to, the best first, with nuisances of the whole system.
    aside
        Names of recordings.
    most_causes, tell
        As for `by_ring`.
    """
    if not aside:
        return by_ring(refiner, most_causes, tell, Start(begun[0].nuisance, begun))
    system = refiner.system
    part = Part(system, [one for one in records_of(system) if one not in aside])
    some = _Some(refiner, part, begun[0].nuisance)
    own = [replace(one, nuisance=part.own(one.nuisance)) for one in begun]
    found = by_ring(some, most_causes, tell, Start(own[0].nuisance, own))
    return found._replace(fitted=[some.shown(one) for one in found.fitted], aside=tuple(aside))
