"""What the engine is given: recorded channels, a simulator, and what it may have left out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate, Setting

Ring = Literal["left_out", "damped", "as_is"]
"""Left out, with no bias on other lines; damped, which is cheaper and good for differences of two
simulations; or as the simulator has it."""


@dataclass(frozen=True)
class Nuisance:
    """A parameter that is free within its prior throughout.

    Parameters
    ----------
    name
        Unique.
    sigma, unit
        How well it is known.
    cause, term
        The candidate that it is, once it moves further than its prior allows, and which term of
        it; None: it has none.
    step
        Half the width of the difference that tells what it does, in sigmas.
    record
        The only recording that it moves; "": it may move all.
    loose
        Its sigma says how far off it may be at most: all such may be known better, by one share of
        their sigmas, which the recording tells.
    """

    name: str
    sigma: float
    unit: str
    cause: str | None = None
    term: str | None = None
    step: float = 0.5
    record: str = ""
    loose: bool = False


@dataclass(frozen=True)
class Point:
    """What is to be simulated.

    Parameters
    ----------
    nuisance
        In sigmas, shape (p,); zero is the nominal.
    effects
        Candidates that are on.
    ring
        What becomes of the system's own ring, where it has one: the phase of a ring that a kick
        left long ago cannot be foretold, and hides what the drive's own lines show.
    upto
        Share of each recording's time that is asked for, from its first sample on: a simulator may
        leave out the rest, and predict anything there.
    records
        Names of the recordings that are asked for; (): all of them. A simulator may leave out
        others, and predict anything in them.
    """

    nuisance: Array
    effects: Mapping[str, Setting] = field(default_factory=dict)
    ring: Ring = "left_out"
    upto: float = 1.0
    records: tuple[str, ...] = ()


Prediction = list[Array]
"""For each bundle its channels at its sample times, shape (n, m)."""


class System(Protocol):
    """Anything that can be simulated and was recorded."""

    @property
    def name(self) -> str:
        """What to call it."""
        ...

    @property
    def bundles(self) -> Sequence[Bundle]:
        """What was recorded."""
        ...

    @property
    def nuisances(self) -> Sequence[Nuisance]:
        """What is free throughout."""
        ...

    @property
    def candidates(self) -> Sequence[Candidate]:
        """What may have been left out."""
        ...

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """Predict what would be recorded, without noise, and keep what `reduce` makes of it."""
        ...


@runtime_checkable
class Ringing(Protocol):
    """A system that says how its numbers move the tones that it rings in."""

    def tones_hz(self, point: Point) -> Array:
        """Its own tones in the first of its recordings, shape (k,), Hz; (0,): not known."""
        ...


@runtime_checkable
class Bent(Protocol):
    """A system that knows where two of its nuisances, moved together, do what neither does."""

    def bend(self, here: Point, there: Point) -> Array:
        """What brings `there` to where straight lines about `here` have it.

        A product of two nuisances, of which a third makes up for much more than it is known to,
        bends every line along which the two move: steps by straight lines lead nowhere then.

        Returns
        -------
        Array
            By how much nuisances of `there` are to move, in sigmas, shape (p,).
        """
        ...


def bend_of(system: System, here: Point, there: Point) -> Array:
    """The same of any system: nothing, where it does not say."""
    if isinstance(system, Bent):
        return system.bend(here, there)
    return np.zeros(len(there.nuisance))


def tones_of(system: System, point: Point) -> Array:
    """Tones of a system, whether or not it says them, as `Ringing.tones_hz` has them."""
    return system.tones_hz(point) if isinstance(system, Ringing) else np.zeros(0)


def own_nuisances(nuisances: Sequence[Nuisance]) -> dict[tuple[str, str], int]:
    """Which nuisance is the same number as a candidate's term: (candidate, term) -> its place."""
    return {(one.cause, one.term): i for i, one in enumerate(nuisances) if one.cause and one.term}


def free_of(system: System) -> list[Candidate]:
    """Candidates of a system whose magnitude is free."""
    return [one for one in system.candidates if not one.fixed]
