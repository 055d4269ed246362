"""The engine on each data set, once, and its figures beside others'."""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from analysis.engine import Diagnosis, Point, Setting, diagnose
from analysis.engine.fitted import Fitted
from tests.validation.emps import EDGE_S, MASS_KG, VISCOUS_N_S_M, Emps
from tests.validation.shared import Described, named, order_of_evidence
from tests.validation.silverbox import RATE_HZ, Hold, Silverbox
from tests.validation.tanks import Tanks

QUICK, FULL = 8192, 65062
"""Samples of the Silverbox's train part: an eighth of it, and all."""

ARROW_INSIDE = 32000
"""Samples of the arrow in which it is no louder than what was trained on."""

ALL = (-1.0, 1e9)


@dataclass(frozen=True)
class Run:
    """One diagnosis.

    Attributes
    ----------
    diagnosis
        What the engine says.
    judged
        The system with the parts that it is judged on, which the engine was not given or which
        were sealed.
    """

    diagnosis: Diagnosis
    judged: Described

    @cached_property
    def before(self) -> Point:
        """Nothing left out, parameters fitted."""
        assert self.diagnosis.search is not None
        return self._settled(self.diagnosis.search.null).point

    @cached_property
    def chosen(self) -> Fitted:
        """The verdict's hypothesis."""
        assert self.diagnosis.judgement is not None
        return self._settled(self.diagnosis.judgement.chosen)

    @property
    def names(self) -> set[str]:
        """What was named."""
        return named(self.diagnosis)

    @property
    def order(self) -> list[tuple[str, ...]]:
        """The best hypothesis of one cause, of two, and so on."""
        assert self.diagnosis.search is not None
        return order_of_evidence(self.diagnosis.search)

    def fitted(self, *names: str) -> Fitted:
        """A hypothesis that was looked at."""
        assert self.diagnosis.search is not None
        fitted = self.diagnosis.search.fitted
        return self._settled(next(f for f in fitted if set(f.hypothesis.names) == set(names)))

    def _settled(self, fitted: Fitted) -> Fitted:
        assert self.diagnosis.search is not None
        return self.diagnosis.search.refiner.settle(fitted, anew=True)

    def rmse(self, point: Point, part: str, start_s: float = -1.0, end_s: float = 1e9) -> float:
        """Of a part, in its unit."""
        return self.judged.rmse(point, part, start_s, end_s)


@cache
def emps() -> Run:
    """The axis; judged between the ends, where the filters see both sides."""
    return Run(diagnose(Emps(), stop_after="name"), Emps())


def emps_rmse(run: Run, point: Point, record: str) -> float:
    """Of the force between the ends of a record [N]."""
    end_s = run.judged.bundles[0].t_s[-1] - EDGE_S
    return run.rmse(point, record, EDGE_S, end_s)


@cache
def silverbox(samples: int = QUICK, hold: Hold = "band-limited") -> Run:
    """The oscillator, from the start of its train part."""
    found = diagnose(Silverbox(samples, hold), stop_after="name")
    return Run(found, Silverbox(FULL, hold, ("multisine", "arrow")))


def arrow_inside_s() -> float:
    """Where the arrow becomes louder than what was trained on."""
    return (100 + ARROW_INSIDE) / RATE_HZ


@cache
def tanks() -> Run:
    """The tanks; one law changes what another does, so each is simulated anew beside others."""
    found = diagnose(Tanks(("train",)), stop_after="name", anew=True, most_causes=4)
    return Run(found, Tanks())


def beyond_published(run: Run) -> set[str]:
    """What the data of the axis ask for beyond the published model."""
    return run.names - {"coulomb", "offset"}


def published_emps() -> Point:
    """The published model of the axis: mass, viscous and Coulomb friction and offset."""
    sigmas = {one.name: one.sigma for one in Emps.nuisances}
    nuisance = np.array(
        [(95.1089 - MASS_KG) / sigmas["mass"], (203.5034 - VISCOUS_N_S_M) / sigmas["viscous"]]
    )
    return Point(
        nuisance,
        {"coulomb": Setting({"coulomb": 20.3935}), "offset": Setting({"offset": -3.1648})},
    )
