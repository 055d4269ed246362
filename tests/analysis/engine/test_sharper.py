"""What is known loosely is known as well as the recording tells: one that is off stands out."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Term, diagnose
from analysis.engine.array import Array
from analysis.engine.faint import faint
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.sharper import Sharper, Told, how_sharp
from analysis.engine.system import Prediction
from tests.analysis.engine.test_ring_fit import T_S, TONE_HZ

CELLS, NOISE = 8, 0.05
LATE_S = 2e-3
"""By how much a cell's instants may be off."""

LATE = Candidate(
    "late", "a late cell", "cell",
    tuple(Term(f"late_s@{i}", "late_s", "s", f"{i}", -0.02, 0.02, 2e-3)
          for i in range(1, CELLS + 1)),
)  # fmt: skip


class Watched:
    """An oscillator seen by eight cells, each with instants of its own."""

    name = "watched"
    candidates: Sequence[Candidate] = (LATE,)

    def __init__(self, late_s: Array, *, loose: bool, records: Sequence[str] = ("",)) -> None:
        self.nuisances: Sequence[Nuisance] = (
            Nuisance("tone", 1e-3, "1"),
            *(Nuisance(f"instant@{i}", LATE_S, "s", loose=loose) for i in range(1, CELLS + 1)),
        )
        value = seen(0.0, late_s)
        noise = np.random.default_rng(1)
        names = tuple(f"y{i}" for i in range(1, CELLS + 1))
        segments = (Segment(0.0, 1.0, None, 20.0, name="rest"), Segment(1.0, 20.0, None, 20.0))
        self.bundles = tuple(
            Bundle(names, ("V",) * CELLS, T_S, value + NOISE * noise.standard_normal(value.shape),
                   NOISE**2 * np.eye(CELLS), segments, record=record, tones_hz=(TONE_HZ,))
            for record in records
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point)] * len(self.bundles)) for point in points]

    def _one(self, point: Point) -> Array:
        late_s = LATE_S * point.nuisance[1:]
        late = point.effects.get("late")
        if late is not None:
            late_s = late_s + [late.values.get(f"late_s@{i}", 0.0) for i in range(1, CELLS + 1)]
        return seen(1e-3 * float(point.nuisance[0]), late_s)


def seen(tone_share: float, late_s: Array) -> Array:
    """What each cell reads, late by so much, shape (n, 8)."""
    since = np.maximum(T_S[:, None] - 1.0 - late_s, 0.0)
    return np.asarray(np.sin(2.0 * np.pi * TONE_HZ * (1.0 + tone_share) * since))


def one_late(sigmas: float) -> Array:
    late_s = np.zeros(CELLS)
    late_s[2] = sigmas * LATE_S
    return late_s


@pytest.mark.parametrize("records", [("",), ("first", "second", "third")])
def test_one_of_eight_that_is_off_is_named_where_the_others_need_not_be(
    records: Sequence[str],
) -> None:
    found = diagnose(Watched(one_late(2.0), loose=True, records=records))
    assert found.judgement is not None
    (cause,) = found.judgement.causes
    assert (cause.name, set(cause.values)) == ("late", {"late_s@3"})
    assert cause.values["late_s@3"] == pytest.approx(2.0 * LATE_S, rel=0.1)
    assert isinstance(found.system, Sharper)
    (note,) = found.notes
    assert "instant@1 and 7 more" in note


def test_as_far_off_as_is_stated_is_nothing_where_the_statement_is_meant() -> None:
    found = diagnose(Watched(one_late(2.0), loose=False))
    assert found.verdict == "none"


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_all_as_far_off_as_may_be_are_nothing(seed: int) -> None:
    late_s = LATE_S * np.random.default_rng(seed).standard_normal(CELLS)
    found = diagnose(Watched(late_s, loose=True))
    assert found.verdict == "none"
    assert not isinstance(found.system, Sharper)


@pytest.mark.parametrize(("sigmas", "rises"), [(0.0, False), (2.0, True)])
def test_parameters_alone_are_weighed_as_well_known_as_suits_them(
    sigmas: float, rises: bool
) -> None:
    system = Watched(one_late(sigmas), loose=True)
    refiner = Refiner(system, *look(system))
    nothing = follow_ring(system, refiner.calibrated.at, everything=True)
    told = how_sharp(system, faint(system, nothing, system.candidates), refiner.candidates)
    assert told is not None
    assert told.share < 0.1
    assert (told.rises > 0.0) == rises
    # As free as is stated it would be two sigmas, which is 2 of a logarithm; not hundreds.
    assert told.rises < 20.0


def test_what_is_known_better_is_simulated_as_it_was() -> None:
    system = Watched(one_late(0.0), loose=True)
    sharper = Sharper(system, Told(0.1, "late", 9.0))
    nuisance = np.arange(9.0)
    stated = Point(sharper.scales * nuisance)
    assert sharper.nuisances[3].sigma == pytest.approx(0.1 * LATE_S)
    assert sharper.nuisances[0] == system.nuisances[0]
    for one, other in zip(
        sharper.simulate([Point(nuisance)], list)[0], system.simulate([stated], list)[0],
        strict=True,
    ):  # fmt: skip
        np.testing.assert_array_equal(one, other)
