"""A system of which something is not taken as stated, for the recording tells it otherwise."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate
from analysis.engine.system import Nuisance, Point, Prediction, System, bend_of, tones_of


class Restated(ABC):
    """What is stated, all of which holds but for what a subclass states anew.

    Parameters
    ----------
    stated
        The system as it is stated; it may be one that was restated before.
    """

    def __init__(self, stated: System) -> None:
        self.stated = stated
        self.name = stated.name
        self.bundles: Sequence[Bundle] = stated.bundles
        self.nuisances: Sequence[Nuisance] = stated.nuisances
        self.candidates: Sequence[Candidate] = stated.candidates

    @property
    @abstractmethod
    def note(self) -> str:
        """What is not as it is stated, in words for whoever stated it."""

    def as_stated(self, point: Point) -> Point:
        """The point of the stated system that one of this is."""
        return point

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return self.stated.simulate([self.as_stated(one) for one in points], reduce)

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return tones_of(self.stated, self.as_stated(point))

    def bend(self, here: Point, there: Point) -> Array:
        """See `Bent`."""
        return bend_of(self.stated, self.as_stated(here), self.as_stated(there))


def restatements(system: System) -> Iterator[Restated]:
    """What was restated, the last first; nothing of a system that is as it was stated.

    Parameters
    ----------
    system
        Any.

    Yields
    ------
    Restated
        Each is about the one that follows.
    """
    while isinstance(system, Restated):
        yield system
        system = system.stated
