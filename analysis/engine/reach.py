"""How far a simulator can be taken within what is stated, before it comes to nothing.

What cannot be simulated is not weighed, and what is not weighed is not ruled out: so it is said.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate, Setting
from analysis.engine.recorded import looked_at
from analysis.engine.sensitivity import BEYOND, FAILED
from analysis.engine.system import Point, Prediction, System
from analysis.engine.whiten import sigmas_of

RUNGS = (3.0, 10.0, 30.0)
"""Of a magnitude, so many times the size at which it is screened, as far as its range goes; what
fails at that size is no system (`check`)."""

SIGMAS = (1.0, 2.0, 3.0)
"""And of a parameter."""

USUAL = 3.0
"""What comes to nothing at so many times that size, or less, may well be what is there."""

WHY = "<why>"
"""Stands for the reason, in a note whose point was not simulated yet."""


@dataclass(frozen=True)
class Unreached:
    """Something stated that cannot be simulated.

    Attributes
    ----------
    candidate
        Which one; "": a parameter.
    usual
        Whether it is of a size that may well be there.
    note
        In words.
    """

    candidate: str
    usual: bool
    note: str


def unreached(system: System) -> tuple[Unreached, ...]:
    """What a simulator comes to nothing for, though it is within what is stated, each alone.

    Parameters
    ----------
    system
        What is simulated; the nominal point can be.
    """
    nominal, whole = Point(np.zeros(len(system.nuisances))), _Whole(system)
    found = [
        _first(system, whole, list(_sizes(nominal, candidate, names)))
        for candidate in system.candidates
        for names in _together(candidate)
    ]
    found += [
        _first(system, whole, list(_sigmas(nominal, i, one.name, sign)))
        for i, one in enumerate(system.nuisances)
        for sign in (1.0, -1.0)
    ]
    return tuple(one for one in found if one is not None)


def _together(candidate: Candidate) -> list[tuple[str, ...]]:
    """Magnitudes that are looked at together: all of them, or each."""
    names = [one.name for one in candidate.terms]
    return [tuple(names)] if candidate.together else [(one,) for one in names]


Asked = tuple[Point, Unreached]


def _sizes(nominal: Point, candidate: Candidate, names: Sequence[str]) -> Iterator[Asked]:
    """A candidate at ever larger sizes, within its range."""
    terms = [one for one in candidate.terms if one.name in names]
    shapes = {one.name: one.default for one in candidate.shapes}
    for times in () if candidate.fixed else RUNGS:
        values = {one.name: times * one.step for one in terms}
        if all(one.low <= values[one.name] <= one.high for one in terms):
            said = ", ".join(f"{one.name!r} at {values[one.name]:g} {one.unit}" for one in terms)
            note = (
                f"candidate {candidate.name!r} with {said} cannot be simulated: {WHY}. So much "
                "of it, and more, is not weighed, and not ruled out"
            )
            point = replace(nominal, effects={candidate.name: Setting(values, shapes)})
            yield point, Unreached(candidate.name, times <= USUAL, note)


def _sigmas(nominal: Point, i: int, name: str, sign: float) -> Iterator[Asked]:
    """A parameter ever farther out."""
    for sigmas in SIGMAS:
        at: Array = nominal.nuisance.copy()
        at[i] = sign * sigmas
        note = (
            f"nuisance {name!r} at {sign * sigmas:+g} sigmas cannot be simulated: {WHY}. "
            "No fit can go there: state it so that it can, as the logarithm of what is positive"
        )
        yield replace(nominal, nuisance=at), Unreached("", sigmas < SIGMAS[-1], note)


def _first(system: System, whole: "_Whole", asked: Sequence[Asked]) -> Unreached | None:
    """The first that comes to nothing."""
    for point, one in asked:
        why = "it is not finite"
        try:
            (can,) = system.simulate([point], whole)
        except FAILED as error:
            can, why = False, f"{type(error).__name__}: {error}"
        if not can:
            return replace(one, note=one.note.replace(WHY, why))
    return None


class _Whole:
    """Whether a prediction holds numbers where they are looked at."""

    def __init__(self, system: System) -> None:
        self._inside = [looked_at(one) for one in system.bundles]
        self._most = [
            BEYOND * sigmas_of(one)[inside]
            for one, inside in zip(system.bundles, self._inside, strict=True)
        ]

    def __call__(self, prediction: Prediction) -> Any:
        seen = zip(self._inside, self._most, prediction, strict=True)
        return all(bool((np.abs(one[inside]) < most).all()) for inside, most, one in seen)
