"""Some recordings of a system, as a system of their own."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate
from analysis.engine.system import Nuisance, Point, Prediction, System, bend_of, tones_of

SEVERAL = 3
"""So many recordings and more are led one after the other: all at once takes too long."""


class Part:
    """Some recordings of a system, with the nuisances that move anything there.

    Parameters
    ----------
    system
        All of it.
    records
        Names of the recordings.
    """

    def __init__(self, system: System, records: Sequence[str]) -> None:
        self._system = system
        self.records = tuple(records)
        """Their names."""
        self._chosen = [i for i, one in enumerate(system.bundles) if one.record in records]
        self.places = np.array(
            [i for i, one in enumerate(system.nuisances) if one.record in ("", *records)],
            dtype=np.int64,
        )
        """Places of its nuisances among the whole system's."""
        self.name = ", ".join(records)
        self.bundles: tuple[Bundle, ...] = tuple(system.bundles[i] for i in self._chosen)
        self.nuisances: tuple[Nuisance, ...] = tuple(system.nuisances[i] for i in self.places)

    @property
    def candidates(self) -> Sequence[Candidate]:
        """See `System`."""
        return self._system.candidates

    def whole(self, nuisance: Array, beside: Array | None = None) -> Array:
        """Nuisances of the whole system, in sigmas.

        Parameters
        ----------
        nuisance
            Those of this part, shape (p,).
        beside
            The whole system's, shape (nuisances,): what is of other recordings is from there;
            None: as it is known.
        """
        found = np.zeros(len(self._system.nuisances)) if beside is None else beside.copy()
        found[self.places] = nuisance
        return found

    def own(self, nuisance: Array) -> Array:
        """Of the whole system's nuisances those of this part, shape (p,)."""
        return nuisance[self.places]

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return self._system.simulate(
            [self._of_whole(one) for one in points],
            lambda prediction: reduce([prediction[i] for i in self._chosen]),
        )

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return tones_of(self._system, self._of_whole(point))

    def bend(self, here: Point, there: Point) -> Array:
        """See `Bent`."""
        return self.own(bend_of(self._system, self._of_whole(here), self._of_whole(there)))

    def _of_whole(self, point: Point) -> Point:
        """The same for the whole system, of this part's recordings."""
        return replace(point, nuisance=self.whole(point.nuisance), records=self.records)


def records_of(system: System) -> list[str]:
    """Names of a system's recordings, in their order."""
    return list(dict.fromkeys(one.record for one in system.bundles))


def has_several(system: System) -> bool:
    """Whether it has so many recordings that they are led one after the other."""
    return len(records_of(system)) >= SEVERAL


def rings(system: System) -> bool:
    """Whether the system has tones of its own."""
    return any(bundle.tones_hz for bundle in system.bundles)
