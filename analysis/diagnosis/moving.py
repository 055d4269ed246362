"""What nuisances make of one run: effects with their numbers, and what shifts how it is seen."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.nuisances import EVERY, STRINGS, Meaning
from analysis.engine.system import Nuisance
from model import ActiveEffect, Strings
from model.library.discovery import library
from model.strings import UNCHANGED

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Values = dict[str, dict[str, Any]]

OUTSIDE = ("cell", "camera", "clock")
"""Sides that change how a simulation is looked at, and not the simulation."""


@dataclass
class Moved:
    """What one run is simulated with.

    Attributes
    ----------
    values
        Effect -> its numbers, those of cables of shape (8,).
    late_start_s
        By how much later than recorded the simulation begins.
    pose_zero
        What the pose is off by, shape (6,), in m and rad.
    late_s
        How late each cell is read, shape (8,).
    strings
        What cables are as strings.
    """

    values: Values
    late_start_s: float = 0.0
    pose_zero: Array = field(default_factory=lambda: np.zeros(6))
    late_s: Array = field(default_factory=lambda: np.zeros(8))
    strings: Strings = UNCHANGED


class Moving:
    """Which numbers of one run nuisances move.

    Parameters
    ----------
    meanings, nuisances
        Of the whole system, in its order.
    record
        Number of the run.
    strung
        Whether it shows what its cables are as strings with no effect on.
    """

    def __init__(
        self,
        meanings: Sequence[Meaning],
        nuisances: Sequence[Nuisance],
        record: int,
        *,
        strung: bool = False,
    ) -> None:
        self._strung = strung
        self._sigmas = np.array([one.sigma for one in nuisances])
        pairs: dict[tuple[str, str], list[tuple[int, int]]] = {}
        for i, one in enumerate(meanings):
            if one.record in (EVERY, record):
                where = one.axis if one.effect == "pose_zero" else one.cable - 1
                pairs.setdefault((one.effect, one.parameter), []).append((i, where))
        self._places = {key: np.array(found).T for key, found in pairs.items()}
        of_run = [one.record in (EVERY, record) for one in meanings]
        inside = np.array([_acts_inside(one) for one in meanings]) & of_run
        self._inside = np.flatnonzero(inside)
        strings = np.array([one.effect == STRINGS for one in meanings])
        self._with_strings = np.flatnonzero(inside | strings)

    def inside(self, effects: Iterable[str]) -> Indices:
        """Which nuisances change what is simulated.

        Parameters
        ----------
        effects
            Names of those that are on.
        """
        return self._with_strings if self._vibrate(effects) else self._inside

    def _vibrate(self, effects: Iterable[str]) -> bool:
        """Whether it matters what cables are as strings."""
        return self._strung or not on_strings().isdisjoint(effects)

    def by(self, nuisance: Array, values: Values) -> Moved:
        """What one run is simulated with.

        Parameters
        ----------
        nuisance
            In sigmas, shape (p,).
        values
            Effects that are on without them; changed in place.
        """
        found = Moved(values)
        amounts = nuisance * self._sigmas
        vibrate = self._vibrate(values)
        strings: dict[str, tuple[float, ...]] = {}
        for (effect, parameter), (of, where) in self._places.items():
            moved = amounts[of]
            if not moved.any():
                continue
            if effect == "start":
                found.late_start_s += float(moved[0])
            elif effect == "pose_zero":
                found.pose_zero[where] += moved
            elif effect == "sampling":
                found.late_s[where] += moved
            elif effect == STRINGS:
                strings[parameter] = _each_cable(where, moved)
            else:
                mine = values.setdefault(effect, nothing(effect))
                if where[0] < 0:
                    mine[parameter] = mine.get(parameter, 0.0) + float(moved[0])
                else:
                    column = np.array(mine.get(parameter, np.zeros(8)))
                    # A cable's pretension may be off in every run, and in this one.
                    np.add.at(column, where, moved)
                    mine[parameter] = column
        if vibrate and strings:
            found.strings = Strings(**strings)
        return found


@cache
def on_strings() -> frozenset[str]:
    """Effects of which a law asks what a cable weighs, or how its string loses."""
    numbers = ("line_density", "damping")
    return frozenset(
        name for name, effect in library().items() if any(map(effect.asks_for, numbers))
    )


def nothing(name: str) -> dict[str, Any]:
    """An effect with all magnitudes zero, so that only what is moved acts."""
    return {
        one.name: np.zeros(8) if one.per_cable else 0.0
        for one in library()[name].parameters
        if one.magnitude
    }


def active(values: Mapping[str, Mapping[str, Any]]) -> list[ActiveEffect]:
    """Effects that do something, their numbers clipped to the library's range."""
    every = [_active(name, _plain(values[name])) for name in sorted(values)]
    return [one for one in every if not one.is_nothing]


def _each_cable(where: Indices, moved: Array) -> tuple[float, ...]:
    """A number of each cable, zero where nothing moves it."""
    column = np.zeros(8)
    column[where] = moved
    return tuple(column.tolist())


def _acts_inside(meaning: Meaning) -> bool:
    known = library().get(meaning.effect)
    return known is not None and known.acts.side not in OUTSIDE


def _plain(values: Mapping[str, Any]) -> tuple[tuple[str, Any], ...]:
    """Numbers of an effect, to be told apart by value."""
    return tuple(
        (name, tuple(one.tolist()) if isinstance(one, np.ndarray) else one)
        for name, one in values.items()
    )


@lru_cache(maxsize=4096)
def _active(name: str, values: tuple[tuple[str, Any], ...]) -> ActiveEffect:
    """An effect: of neighbours most have the same."""
    given, found = dict(values), {}
    for one in library()[name].parameters:
        if one.name in given:
            clipped = np.clip(given[one.name], one.low, one.high)
            found[one.name] = (
                tuple(float(v) for v in clipped) if np.ndim(clipped) else float(clipped)
            )
    return ActiveEffect(name, found)
