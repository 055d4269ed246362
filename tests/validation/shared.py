"""What the descriptions of other people's recordings have in common."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from analysis.engine import Bundle, Candidate, Diagnosis, Nuisance, Point, Shape, Term
from analysis.engine.array import Array
from analysis.engine.search import Search
from analysis.engine.system import Prediction


def folder(name: str) -> Path:
    """The folder of a data set: in CDPR_DATA, else in ../shared/data beside the project.

    Raises
    ------
    FileNotFoundError
        It is not there.
    """
    beside = Path(__file__).parents[3] / "shared" / "data"
    found = Path(os.environ.get("CDPR_DATA", beside)) / name
    if not found.is_dir():
        raise FileNotFoundError(
            f"no recordings in {found}: set CDPR_DATA to the folder of recordings"
        )
    return found


class Described:
    """A system of which one point is simulated at a time: a description says `predict`."""

    name: str
    bundles: Sequence[Bundle]
    nuisances: Sequence[Nuisance]
    candidates: Sequence[Candidate]

    def predict(self, point: Point) -> Prediction:
        """What would be recorded, without noise."""
        raise NotImplementedError

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """As `System` has it."""
        return [reduce(self.predict(point)) for point in points]

    def number(self, point: Point, name: str) -> float:
        """A nuisance in its unit, about zero."""
        place = next(i for i, one in enumerate(self.nuisances) if one.name == name)
        return float(point.nuisance[place]) * self.nuisances[place].sigma

    def value(self, point: Point, candidate: str, what: str | None = None) -> float:
        """A magnitude, zero where it is off, or a shape's value; None: the first magnitude."""
        known = next(one for one in self.candidates if one.name == candidate)
        what = known.terms[0].name if what is None else what
        shapes = {one.name: one.default for one in known.shapes}
        on = point.effects.get(candidate)
        if on is None:
            return shapes.get(what, 0.0)
        return {**shapes, **on.shapes, **on.values}.get(what, 0.0)

    def rmse(self, point: Point, record: str, start_s: float, end_s: float) -> float:
        """Of the first channel of a record over a stretch of time, in its unit."""
        for bundle, seen in zip(self.bundles, self.predict(point), strict=True):
            if bundle.record == record:
                inside = (bundle.t_s >= start_s) & (bundle.t_s < end_s)
                return float(np.sqrt(np.mean((bundle.value - seen)[inside, 0] ** 2)))
        raise KeyError(record)


def candidate(
    name: str,
    title: str,
    unit: str,
    low: float,
    high: float,
    step: float,
    shapes: tuple[Shape, ...] = (),
    **more: Any,
) -> Candidate:
    """A candidate of one magnitude of its own name."""
    term = Term(
        name, name, unit, "", low, high, step, more.pop("least", None), more.pop("most", None)
    )
    return Candidate(name, title, more.pop("side", "plant"), (term,), shapes, **more)


def series(
    record: str, channel: str, unit: str, t_s: Array, value: Array, noise: float, **more: Any
) -> Bundle:
    """One channel of one record."""
    covariance = np.array([[noise**2]])
    return Bundle((channel,), (unit,), t_s, value[:, None], covariance, record=record, **more)


def read_between(state: Array, h: float, at: Array) -> Array:
    """A value between steps, by Hermite's cubic.

    Parameters
    ----------
    state
        Value and rate at each step, shape (steps, 2).
    h
        From step to step.
    at
        Where to read, in steps.
    """
    i = np.clip(np.floor(at).astype(int), 0, len(state) - 2)
    s = at - i
    (y0, v0), (y1, v1) = state[i].T, state[i + 1].T
    y = y0 + s * (h * v0 + s * (3.0 * (y1 - y0) - h * (2.0 * v0 + v1)))
    return np.asarray(y + s**3 * (2.0 * (y0 - y1) + h * (v0 + v1)))


def order_of_evidence(found: Search) -> list[tuple[str, ...]]:
    """The best hypothesis of one cause, of two, and so on."""
    best: dict[int, tuple[str, ...]] = {}
    for fitted in found.fitted:
        best.setdefault(len(fitted.hypothesis.parts), fitted.hypothesis.names)
    return [best[size] for size in sorted(best) if size]


def named(diagnosis: Diagnosis) -> set[str]:
    """The causes of the verdict."""
    return set() if diagnosis.judgement is None else {c.name for c in diagnosis.judgement.causes}
