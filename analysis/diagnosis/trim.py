"""What a trim of the platform does to pretensions, and how it bends what parameters do.

Whoever tightened the cables may have trimmed the platform: then pretensions are off by what it
takes to rest where the rig file has it. That is the product of how far it was trimmed, from 0 to 1,
and of how far the machine is off. Both move by a sigma where pretensions, which make up for it,
are known to a fraction of what the product moves them by.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.nuisances import EVERY, Meaning
from analysis.engine.system import Nuisance, Point
from cdpr8 import CABLES

Array = NDArray[np.float64]

TRIM, TIGHT = "trimmed_share", "pretension_offset_n"


class Trim:
    """The trim among the nuisances of runs of one machine.

    Parameters
    ----------
    meanings, nuisances
        Of all of them.
    pretension_n
        What cables are tightened to in one run (number) of a point, shape (8,), N.
    """

    def __init__(
        self,
        meanings: Sequence[Meaning],
        nuisances: Sequence[Nuisance],
        pretension_n: Callable[[Point, int], Array],
    ) -> None:
        self._share = [i for i, one in enumerate(meanings) if one.parameter == TRIM]
        self._tight: dict[int, list[tuple[int, int]]] = {}
        for i, one in enumerate(meanings):
            if one.parameter == TIGHT:
                self._tight.setdefault(one.record, []).append((i, one.cable - 1))
        self._sigma = np.array([one.sigma for one in nuisances])
        self._pretension_n = pretension_n

    def moved_n(self, point: Point, record: int) -> Array:
        """By how much the trim of a point makes cables tighter in a run, shape (8,), N."""
        return self._at(point, record, None) - self._at(point, record, 0.0)

    def bend(self, here: Point, there: Point, records: Sequence[int]) -> Array:
        """By how much pretensions of `there` are to move, in sigmas, shape (p,).

        Then each cable is as tight as where the trim and what it makes up for had moved it one
        without the other.

        Parameters
        ----------
        here, there
            From where, and where to.
        records
            Numbers of the runs that are asked: what is off in them alone stays in others.
        """
        found = np.zeros(len(self._sigma))
        farther = (there.nuisance - here.nuisance)[self._share] * self._sigma[self._share]
        if farther.any():
            more_n = {
                record: float(farther.sum())
                * (self._whole_n(there, record) - self._whole_n(here, record))
                for record in records
            }
            in_all_n = np.zeros(CABLES)
            if EVERY in self._tight:
                in_all_n = np.mean(list(more_n.values()), axis=0)
            for record, tighter_n in {EVERY: in_all_n, **more_n}.items():
                rest_n = tighter_n if record == EVERY else tighter_n - in_all_n
                for i, cable in self._tight.get(record, ()):
                    found[i] = -rest_n[cable] / self._sigma[i]
        return found

    def _whole_n(self, point: Point, record: int) -> Array:
        """What a trim of 1 does."""
        return self._at(point, record, 1.0) - self._at(point, record, 0.0)

    def _at(self, point: Point, record: int, share: float | None) -> Array:
        nuisance = point.nuisance.copy()
        if share is not None:
            nuisance[self._share] = share / self._sigma[self._share]
        return self._pretension_n(replace(point, nuisance=nuisance, upto=1.0), record)
