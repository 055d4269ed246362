"""What the engine is given, checked before anything is made of it.

What is stated is looked at (`recorded`, `stated`), and the simulator is asked: for the nominal
point twice, and of a system that does not ring for each parameter and each magnitude alone as well.
A system that rings takes long to simulate, and is mostly a machine that states itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate, Setting
from analysis.engine.part import rings
from analysis.engine.recorded import check_bundles, looked_at, name_of
from analysis.engine.stated import check_candidates, check_lists, check_nuisances
from analysis.engine.system import Point, Prediction, System
from analysis.engine.unlikely import elsewhere, missing_of, rounded, unknown_kin, unlikely
from cdpr8.errors import DataError

LEAST_CHANGE = 1e-12
"""A change that is less than this share of what was simulated is none."""

PARTS = ("name", "bundles", "nuisances", "candidates", "simulate")


def check(system: System) -> tuple[str, ...]:
    """Whether the engine can make anything of a system; what else is to be known of it.

    Parameters
    ----------
    system
        What is to be diagnosed.

    Returns
    -------
    tuple of str
        What may be as it should and is seldom meant, a sentence for each: a dead channel, another
        unit, rounding; and of what does not ring what does nothing by itself.

    Raises
    ------
    DataError
        Something that is stated, or what is simulated, cannot be.
    """
    missing = [one for one in PARTS if not hasattr(system, one)]
    if missing:
        raise DataError(
            f"a {type(system).__name__} has no {', '.join(missing)}",
            allowed="an object with " + ", ".join(PARTS),
            remedy="see docs/engine.md, 'What you write'",
        )
    check_lists(system)
    check_bundles(system.bundles)
    check_candidates(system.candidates)
    check_nuisances(system)
    nominal = Point(np.zeros(len(system.nuisances)))
    (found,) = _simulated(system, [nominal], "the nominal point")
    _check_prediction(system.bundles, found, "the nominal point")
    (again,) = _simulated(system, [nominal], "the nominal point")
    if _changes(system.bundles, found, again):
        raise DataError(
            "the nominal point, simulated again, comes to something else",
            allowed="the same for the same point",
            where="simulate",
            remedy="draw no random numbers, keep no state, and hand `reduce` arrays of their own",
        )
    odd = (*missing_of(system), *unlikely(system.bundles, found))
    if rings(system):
        return odd
    return (
        *unknown_kin(system.candidates),
        *odd,
        *elsewhere(system.bundles, found),
        *_each(system, nominal, found),
    )


def _each(system: System, nominal: Point, at: Prediction) -> tuple[str, ...]:
    """Each parameter and each magnitude simulated alone."""
    named: list[tuple[str, Point]] = []
    for i, nuisance in enumerate(system.nuisances):
        moved = nominal.nuisance.copy()
        moved[i] += nuisance.step
        named.append((f"nuisance {nuisance.name!r} at its step", Point(moved)))
    for candidate in system.candidates:
        named += [
            (
                f"candidate {candidate.name!r} with {term.name!r} at its step",
                _on(nominal, candidate, term.name),
            )
            for term in candidate.terms
        ]
    points = [one for _, one in named]
    try:
        found = _simulated(system, points, f"{len(points)} points at once")
    except DataError as error:
        if error.__cause__ is None:
            raise
        # Which of them it was.
        found = [_simulated(system, [point], what)[0] for what, point in named]
    idle = []
    for (what, _), one in zip(named, found, strict=True):
        _check_prediction(system.bundles, one, what)
        if not _changes(system.bundles, at, one):
            idle.append(what)
    if named and len(idle) == len(named):
        raise DataError(
            "neither a parameter nor a candidate changes what is simulated",
            allowed="a simulation that goes by the point it is given",
            where="simulate",
            remedy="use point.nuisance (in sigmas) and point.effects, and hand `reduce` arrays "
            "that the next point does not overwrite",
        )
    if system.nuisances and all(
        f"nuisance {one.name!r} at its step" in idle for one in system.nuisances
    ):
        raise DataError(
            "no nuisance changes what is simulated",
            allowed="parameters that the simulation goes by",
            where="simulate",
            remedy="use point.nuisance (in sigmas), or leave out nuisances that do nothing",
        )
    coarse = rounded(system.bundles, [at, *found]) if found else ()
    return (*coarse, *(f"{what} changes nothing that is looked at" for what in idle))


def _on(nominal: Point, candidate: Candidate, term: str) -> Point:
    """With a magnitude at its step; all of them, where they act together."""
    together = [one for one in candidate.terms if candidate.together or one.name == term]
    values = {one.name: one.step for one in together}
    shapes = {one.name: one.default for one in candidate.shapes}
    return replace(nominal, effects={candidate.name: Setting(values, shapes)})


@dataclass(frozen=True)
class _Handed:
    """What was handed to `reduce`."""

    prediction: Prediction


def _simulated(system: System, points: Sequence[Point], what: str) -> list[Any]:
    simulate: Callable[..., Any] = system.simulate
    try:
        found = simulate(points, _Handed)
    except Exception as error:
        raise DataError(
            f"the simulation of {what} raised {type(error).__name__}: {error}",
            where="simulate",
            remedy="the cause is below; a simulation that comes to nothing may hold NaN",
        ) from error
    if not isinstance(found, list | tuple) or len(found) != len(points):
        said = f"{len(found)} results" if isinstance(found, list | tuple) else repr(type(found))
        raise DataError(
            f"simulate returned {said} for {len(points)} points",
            allowed="a list of what `reduce` makes of each point's prediction, one for each",
            where="simulate",
            remedy="return [reduce(predict(point)) for point in points]",
        )
    if not all(isinstance(one, _Handed) for one in found):
        raise DataError(
            "simulate returns something else than what `reduce` makes of a prediction",
            allowed="reduce(prediction) for each point",
            where="simulate",
            remedy="return [reduce(predict(point)) for point in points]",
        )
    return [one.prediction for one in found]


def _check_prediction(bundles: Sequence[Bundle], found: Any, what: str) -> None:
    """Whether a prediction has the form of the recording, and holds numbers where that is seen."""
    if not isinstance(found, list | tuple) or len(found) != len(bundles):
        said = f"{len(found)} arrays" if isinstance(found, list | tuple) else repr(type(found))
        raise DataError(
            f"the simulation of {what} gives {said}",
            allowed=f"a list of {len(bundles)}, one for each bundle",
            where="simulate",
            remedy="hand `reduce` a list of arrays of shape (samples, channels)",
        )
    for i, (bundle, seen) in enumerate(zip(bundles, found, strict=True)):
        if not isinstance(seen, np.ndarray):
            raise DataError(
                f"the simulation of {what} holds a {type(seen).__name__}", allowed="an array",
                where=f"simulate, {name_of(bundle, i)}",
                remedy="hand `reduce` a list of arrays, np.asarray(...) each",
            )  # fmt: skip
        shape = np.shape(seen)
        if shape != bundle.value.shape:
            raise DataError(
                f"the simulation of {what} has shape {shape}",
                allowed=f"{bundle.value.shape}, as its `value` has",
                where=f"simulate, {name_of(bundle, i)}",
                remedy="one row for each sample time, one column for each channel",
            )
        if np.iscomplexobj(seen):
            raise DataError(
                f"the simulation of {what} is complex", allowed="real numbers",
                where=f"simulate, {name_of(bundle, i)}",
                remedy="a real and an imaginary part are two channels",
            )  # fmt: skip
        inside = looked_at(bundle)
        bad = np.flatnonzero(~np.isfinite(np.asarray(seen, dtype=float)[inside]).all(axis=1))
        if bad.size:
            raise DataError(
                f"the simulation of {what} is not finite in {bad.size} of {int(inside.sum())} "
                f"samples, first at {bundle.t_s[inside][bad[0]]:g} s",
                allowed="finite numbers",
                where=f"simulate, {name_of(bundle, i)}",
                remedy="simulate with finer steps, or take a smaller `step`",
            )


def _changes(bundles: Sequence[Bundle], at: Prediction, found: Prediction) -> bool:
    """Whether anything that is looked at differs."""
    for bundle, before, after in zip(bundles, at, found, strict=True):
        inside = looked_at(bundle)
        size = np.abs(before[inside]).max(initial=0.0)
        if np.abs(after[inside] - before[inside]).max(initial=0.0) > LEAST_CHANGE * size:
            return True
    return False
