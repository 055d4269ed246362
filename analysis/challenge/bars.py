"""The table of the challenge: each figure with its interval, its bar and whether that is met."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.grade import Grade
from analysis.challenge.intervals import bootstrap, wilson
from analysis.challenge.plants import FIRST, plant_named

Array = NDArray[np.float64]

KINDS = ("single", "campaign")

BINS = 10
"""Of stated probabilities."""


@dataclass(frozen=True)
class Row:
    """One figure for one kind of case.

    Parameters
    ----------
    figure, kind
        What, and of "single" runs or of "campaign"s.
    value
        None where no case has it.
    low, high
        95 % interval.
    of
        Cases it is made of.
    bar
        What is asked.
    at_least
        Whether the figure should be at least the bar, or at most.
    percent
        Whether it is shown in per cent.
    counts
        Whether it is a share of cases.
    """

    figure: str
    kind: str
    value: float | None
    low: float
    high: float
    of: int
    bar: float
    at_least: bool
    percent: bool
    counts: bool = False

    @property
    def met(self) -> bool | None:
        """Whether the interval does not exclude the bar; None without a figure."""
        if self.value is None:
            return None
        return self.high >= self.bar if self.at_least else self.low <= self.bar

    @property
    def word(self) -> str:
        """How it stands: met, not met, or open where its interval alone reaches the bar."""
        if self.value is None:
            return ""
        if self.value >= self.bar if self.at_least else self.value <= self.bar:
            return "met"
        return "open" if self.met else "not met"


def rows(grades: Sequence[Grade], seed: int = 0) -> list[Row]:
    """Every figure, for single runs and for campaigns.

    Parameters
    ----------
    grades
        All cases.
    seed
        Of the bootstrap.
    """
    generator = np.random.default_rng(seed)
    found = []
    for figure in FIGURES:
        for kind, bar in zip(KINDS, figure.bars, strict=True):
            chosen = [one for one in grades if one.kind == kind]
            found.append(figure.row(kind, bar, chosen, generator))
    return found


@dataclass(frozen=True)
class _Figure:
    """How one figure is made: `hits` of cases, or a statistic of numbers."""

    name: str
    bars: tuple[float, float]
    at_least: bool
    hits: Callable[[Sequence[Grade]], list[bool]] | None = None
    numbers: Callable[[Sequence[Grade]], list[list[float]]] | None = None
    statistic: Callable[[Array], float] = lambda rows: float(np.median(rows))
    percent: bool = True

    def row(
        self, kind: str, bar: float, grades: Sequence[Grade], generator: np.random.Generator
    ) -> Row:
        value: float | None = None
        low, high, count = 0.0, 0.0, 0
        if self.hits is not None:
            hits = self.hits(grades)
            count = len(hits)
            if hits:
                value, (low, high) = sum(hits) / count, wilson(sum(hits), count)
        elif self.numbers is not None:
            numbers = self.numbers(grades)
            count = len(numbers)
            if numbers:
                value = self.statistic(np.asarray(numbers, dtype=float))
                low, high = bootstrap(numbers, self.statistic, generator)
        counts = self.hits is not None
        return Row(
            self.name, kind, value, low, high, count, bar, self.at_least, self.percent, counts
        )


def _one(grades: Sequence[Grade]) -> list[Grade]:
    """Cases that conceal one effect, and one that can be seen."""
    return [one for one in grades if len(one.truth) == 1 and one.visible]


def _false_alarms(grades: Sequence[Grade]) -> list[bool]:
    return [one.verdict != "none" for one in grades if not one.truth]


def _covered(grades: Sequence[Grade]) -> list[bool]:
    return [one.right for one in grades if len(one.truth) == 1]


def _alone(grades: Sequence[Grade]) -> list[bool]:
    return [one.alone for one in _one(grades) if one.truth[0]["separable"] is not False]


def _sizes(grades: Sequence[Grade]) -> list[list[float]]:
    found = []
    for one in _one(grades):
        cause = one.cause_of(one.truth[0]["effect"]) or (one.causes[0] if one.causes else None)
        if cause is not None:
            found.append([float(len(cause.set))])
    return found


def _sides(grades: Sequence[Grade]) -> list[bool]:
    known = plant_named(FIRST).catalogue()
    hits = []
    for one in _one(grades):
        first = one.causes[0] if one.causes else None
        side = None
        if first is not None:
            named = known.get(first.effect)
            side = first.side or (named.side if named else None)
        hits.append(side == one.truth[0]["side"])
    return hits


def _cables(grades: Sequence[Grade]) -> list[bool]:
    answers = [one.cables_right(effect) for one in grades for effect in one.visible]
    return [answer for answer in answers if answer is not None]


def _parameters(grades: Sequence[Grade]) -> list[list[float]]:
    errors = [one.parameter_error(effect) for one in grades for effect in one.visible]
    return [[error] for error in errors if error is not None]


def _held_out(grades: Sequence[Grade]) -> list[list[float]]:
    """Wherever something was named: each has an improved machine."""
    values = [one.held_out for one in grades if one.causes]
    return [[value] for value in values if value is not None]


def _both(grades: Sequence[Grade]) -> list[bool]:
    return [one.right for one in grades if len(one.visible) == 2]


def stated(grades: Sequence[Grade]) -> list[list[float]]:
    """Each reported cause: the probability stated, and 1 where its set holds a true effect."""
    found = []
    for one in grades:
        names = {effect["effect"] for effect in one.truth}
        for cause in one.causes:
            if cause.probability is not None:
                found.append([float(cause.probability), float(bool(cause.set & names))])
    return found


def miscalibration(pairs: Array) -> float:
    """Mean distance of stated probability and hit rate over ten bins, weighed by their number."""
    bins = np.minimum((pairs[:, 0] * BINS).astype(int), BINS - 1)
    off = 0.0
    for number in np.unique(bins):
        chosen = pairs[bins == number]
        off += len(chosen) * abs(chosen[:, 0].mean() - chosen[:, 1].mean())
    return float(off / len(pairs))


FIGURES = (
    _Figure("false alarm where nothing is concealed", (0.05, 0.05), False, _false_alarms),
    _Figure("true effect inside the reported set", (0.95, 0.95), True, _covered),
    _Figure("named alone and right, of those that can be told apart", (0.60, 0.90), True, _alone),
    _Figure("size of the reported set, median", (3.0, 1.0), False, numbers=_sizes, percent=False),
    _Figure("right side", (0.90, 0.97), True, _sides),
    _Figure("right cables, where it names cables", (0.90, 0.95), True, _cables),
    _Figure("error of the named parameter, median", (0.15, 0.07), False, numbers=_parameters),
    _Figure("held-out error after, in noise, median", (1.15, 1.10), False, numbers=_held_out,
            percent=False),
    _Figure("both of two effects found", (0.35, 0.70), True, _both),
    _Figure("stated probability against hit rate", (0.10, 0.07), False, numbers=stated,
            statistic=miscalibration),
)  # fmt: skip
