"""The free numbers of a hypothesis: magnitudes and shapes, in one vector."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import exp

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate, Setting, Shape
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.screen import Scored, limits
from analysis.engine.system import Point

SHAPE_STEP = 0.05
"""Difference of a shape: of its logarithm, or of its range."""

SHAPE_WIDTH = 0.25
"""Prior of a shape about its default: this share of its (logarithmic) range."""

MAGNITUDE_STEP = 0.02
"""Difference of a magnitude: of itself, and of the size it is screened at."""


ABOUT = 8.0
"""Numbers that differ by fewer of their steps than this begin in one place."""


EITHER = 2
"""A shape with so many values to try is one thing or another."""


@dataclass(frozen=True)
class Number:
    """One free number: a magnitude of terms, or a shape."""

    candidate: str
    terms: tuple[str, ...]
    shape: Shape | None
    low: float
    high: float
    step: float

    @property
    def width(self) -> float:
        """Prior of a shape about its default, as a standard deviation."""
        return SHAPE_WIDTH * (self.high - self.low)


@dataclass(frozen=True)
class State:
    """Numbers of a hypothesis with their values; shapes as logarithms where they count so."""

    hypothesis: Hypothesis
    candidates: Mapping[str, Candidate]
    numbers: tuple[Number, ...]
    values: Array

    @classmethod
    def of(cls, scored: Scored, candidates: Mapping[str, Candidate]) -> "State":
        """From a screened hypothesis."""
        return cls.at(scored.hypothesis, scored.values, candidates)

    @classmethod
    def at(
        cls,
        hypothesis: Hypothesis,
        magnitudes: Mapping[tuple[str, str], float],
        candidates: Mapping[str, Candidate],
    ) -> "State":
        """From magnitudes, (candidate, term) -> value; shapes are the hypothesis's."""
        numbers, values = [], []
        for name in hypothesis.names:
            candidate, part = candidates[name], hypothesis.parts[name]
            for group in part.groups(candidate):
                low, high = limits(candidate, group)
                value = magnitudes[name, group[0]]
                size = next(t.step for t in candidate.terms if t.name == group[0])
                step = 0.0 if candidate.fixed else MAGNITUDE_STEP * (abs(value) + abs(size))
                numbers.append(Number(name, group, None, low, high, step))
                values.append(size if candidate.fixed else float(np.clip(value, low, high)))
            for shape in candidate.shapes_of(part.terms):
                if not shape.whole:
                    at = part.shapes.get(shape.name, shape.default)
                    numbers.append(
                        Number(name, (), shape, shape.counted(shape.low), shape.counted(shape.high),
                               _shape_step(shape))
                    )  # fmt: skip
                    values.append(shape.counted(at))
        # A magnitude that is not free has no difference.
        return cls(hypothesis, candidates, tuple(numbers), np.array(values))

    @property
    def free(self) -> tuple[int, ...]:
        """Places of the numbers that a fit moves."""
        return tuple(i for i, one in enumerate(self.numbers) if one.step > 0.0)

    def places(self, name: str) -> list[int]:
        """Places, among the free, of one candidate's numbers."""
        return [k for k, i in enumerate(self.free) if self.numbers[i].candidate == name]

    def point(self, nuisance: Array) -> Point:
        """What is to be simulated."""
        effects = {}
        for name in self.hypothesis.names:
            values: dict[str, float] = {}
            shapes = dict(self.hypothesis.parts[name].shapes)
            for number, value in zip(self.numbers, self.values, strict=True):
                if number.candidate != name:
                    continue
                if number.shape is None:
                    values |= dict.fromkeys(number.terms, float(value))
                else:
                    shapes[number.shape.name] = _out(number.shape, float(value))
            effects[name] = Setting(values, shapes)
        return Point(nuisance, effects)

    def is_about(self, other: "State") -> bool:
        """Whether another has the same on, with numbers that differ by less than `ABOUT` steps."""
        if self.hypothesis.key != other.hypothesis.key or self._whole() != other._whole():
            return False
        steps = np.array([one.step for one in self.numbers])
        return bool(np.all(np.abs(self.values - other.values) <= ABOUT * steps))

    def _whole(self) -> list[float | None]:
        """Shapes that no fit moves."""
        return [
            part.shapes.get(shape.name)
            for name, part in sorted(self.hypothesis.parts.items())
            for shape in self.candidates[name].shapes
            if shape.whole
        ]

    def bumped(self, free: int, share: float = 1.0) -> "State":
        """With one free number moved by a share of its step, inwards where it is at its edge."""
        values = self.values.copy()
        values[self.free[free]] += self.signed_step(free, share)
        return replace(self, values=values)

    def signed_step(self, free: int, share: float = 1.0) -> float:
        """The step of a free number, or a share of it."""
        number = self.numbers[self.free[free]]
        step = share * number.step
        return -step if self.values[self.free[free]] + step > number.high else step

    def moved(self, change: Array, share: float = 1.0) -> "State":
        """With the free numbers moved, within their ranges."""
        values = self.values.copy()
        for k, i in enumerate(self.free):
            number = self.numbers[i]
            values[i] = np.clip(values[i] + share * change[k], number.low, number.high)
        parts = dict(self.hypothesis.parts)
        for number, value in zip(self.numbers, values, strict=True):
            if number.shape is not None:
                part = parts[number.candidate]
                shapes = {**part.shapes, number.shape.name: _out(number.shape, float(value))}
                parts[number.candidate] = replace(part, shapes=shapes)
        return replace(self, hypothesis=Hypothesis(parts), values=values)

    def shaped(self, name: str, shape: str, value: float) -> "State":
        """With a shape that is only tried at another value."""
        part = self.hypothesis.parts[name]
        changed = replace(part, shapes={**part.shapes, shape: value})
        return replace(self, hypothesis=self.hypothesis.plus(name, changed))

    def otherwise(self) -> Iterator["State"]:
        """With what is one thing or another the other way."""
        for name, part in self.hypothesis.parts.items():
            for shape in self.candidates[name].shapes:
                if shape.whole and len(shape.grid) == EITHER:
                    here = part.shapes.get(shape.name, shape.default)
                    (other,) = (one for one in shape.grid if one != here)
                    yield self.shaped(name, shape.name, other)

    def smaller(self, share: float, only: str = "") -> "State":
        """With magnitudes this much of themselves: of one cause only, or of every one."""
        values = self.values.copy()
        for i in self.free:
            if self.numbers[i].shape is None and only in ("", self.numbers[i].candidate):
                values[i] *= share
        return replace(self, values=values)

    def nearer(self, other: "State | None", share: float) -> "State":
        """So much of the way from another hypothesis, which has fewer causes, to this one."""
        known = {}
        if other is not None:
            known = dict(zip(map(_label, other.numbers), other.values, strict=True))
        values = self.values.copy()
        for i in self.free:
            number = self.numbers[i]
            # What only this one has is nothing there; its shapes are as they are.
            there = known.get(_label(number), 0.0 if number.shape is None else values[i])
            values[i] = there + share * (values[i] - there)
        return replace(self, values=values)

    def plus(self, name: str, part: Part, values: Mapping[str, float]) -> "State":
        """With one candidate more on.

        Parameters
        ----------
        name
            Of the candidate.
        part
            What of it is on.
        values
            Term -> magnitude.
        """
        magnitudes = self.term_values() | {(name, term): one for term, one in values.items()}
        return State.at(self.hypothesis.plus(name, part), magnitudes, self.candidates)

    def without(self, name: str) -> "State":
        """With one candidate off."""
        keep = [i for i, one in enumerate(self.numbers) if one.candidate != name]
        return State(
            self.hypothesis.without(name),
            self.candidates,
            tuple(self.numbers[i] for i in keep),
            self.values[keep],
        )

    def alike(self, only: str = "") -> "State":
        """With all places of causes on, alike, as strong on average as the places that are.

        Parameters
        ----------
        only
            Of this cause; "": of every one.
        """
        hypothesis, magnitudes = self.hypothesis, self.term_values()
        for name, part in self.hypothesis.parts.items():
            if only and name != only:
                continue
            candidate = self.candidates[name]
            every = tuple(one.name for one in candidate.terms)
            if candidate.spreads and not candidate.together:
                for group in candidate.groups(every, True):
                    mean = sum(magnitudes.get((name, one), 0.0) for one in group) / len(group)
                    magnitudes |= {(name, one): mean for one in group}
                hypothesis = hypothesis.plus(name, Part(every, True, part.shapes))
        if hypothesis.key == self.hypothesis.key:
            return self
        return State.at(hypothesis, magnitudes, self.candidates)

    def apart(self) -> "State":
        """With each place free to be what it is, as strong as all of them are."""
        parts = {name: replace(one, shared=False) for name, one in self.hypothesis.parts.items()}
        return State.at(Hypothesis(parts), self.term_values(), self.candidates)

    def whole(self) -> "State":
        """With every number of what acts in one place: a recording may not have told all of it."""
        hypothesis, magnitudes = self.hypothesis, self.term_values()
        for name, part in self.hypothesis.parts.items():
            terms = self.candidates[name].terms
            if not any(one.place for one in terms):
                every = tuple(one.name for one in terms)
                magnitudes = {(name, one): 0.0 for one in every} | magnitudes
                hypothesis = hypothesis.plus(name, Part(every, part.shared, part.shapes))
        if hypothesis.key == self.hypothesis.key:
            return self
        return State.at(hypothesis, magnitudes, self.candidates)

    def bounds(self) -> tuple[Array, Array]:
        """How far the free numbers may move from here, shapes by a third of their range a time."""
        lows, highs = [], []
        for i in self.free:
            number, value = self.numbers[i], self.values[i]
            low, high = number.low - value, number.high - value
            if number.shape is not None:
                most = (number.high - number.low) / 3.0
                low, high = max(low, -most), min(high, most)
            lows.append(low)
            highs.append(high)
        return np.array(lows), np.array(highs)

    def shape_rows(self) -> tuple[Array, Array]:
        """Priors of the shapes as rows of a fit: residuals (s,) and columns (s, free numbers)."""
        residuals, rows = [], []
        for k, i in enumerate(self.free):
            number = self.numbers[i]
            if number.shape is None:
                continue
            row = np.zeros(len(self.free))
            row[k] = 1.0 / number.width
            rows.append(row)
            off = number.shape.counted(number.shape.default) - self.values[i]
            residuals.append(off / number.width)
        return np.array(residuals), np.array(rows).reshape(len(rows), len(self.free))

    def term_values(self) -> dict[tuple[str, str], float]:
        """(candidate, term) -> magnitude."""
        return {
            (number.candidate, term): float(value)
            for number, value in zip(self.numbers, self.values, strict=True)
            for term in number.terms
        }

    def at_edge(self) -> tuple[tuple[str, str], ...]:
        """Numbers at an edge of their range that is not zero, with their candidate."""
        found = []
        for number, value in zip(self.numbers, self.values, strict=True):
            shape = number.shape
            if not number.step or (shape is not None and (shape.term or shape.between)):
                continue
            reach = 1e-3 * (number.high - number.low)
            low = value <= number.low + reach and number.low != 0.0
            if low or value >= number.high - reach:
                what = shape.name if shape else number.terms[0]
                found.append((number.candidate, what))
        return tuple(found)


def _label(number: Number) -> tuple[object, ...]:
    """Equal for numbers that are the same thing in two hypotheses."""
    return number.candidate, number.terms, None if number.shape is None else number.shape.name


def _out(shape: Shape, value: float) -> float:
    return exp(value) if shape.logarithmic else value


def _shape_step(shape: Shape) -> float:
    return SHAPE_STEP if shape.logarithmic else SHAPE_STEP * (shape.high - shape.low)
