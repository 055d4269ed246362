"""One recording after the other: what each tells is what all of them tell at once."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Term
from analysis.engine.chain import Chained, chained
from analysis.engine.cycles import valley
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.hypothesis import Part as PartOf
from analysis.engine.part import Part
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, Prediction

T_S = np.arange(0.0, 10.0, 0.02)
NAMES = ("one", "two", "three", "four")
TRUTH = np.array([1.2, -0.8, 0.5])
SHARED, NOISE = 3, 0.1


class Straight:
    """Recordings that are straight in three shared numbers, each telling of two of them."""

    name = "straight"
    nuisances: Sequence[Nuisance] = (
        *(Nuisance(f"number {k}", 1.0, "1") for k in range(SHARED)),
        *(Nuisance(f"offset of {one}", 1.0, "V", record=one) for one in NAMES),
    )
    candidates: Sequence[Candidate] = ()

    def __init__(self, *, other: str = "") -> None:
        draw = np.random.default_rng(3)
        self._columns = draw.standard_normal((len(NAMES), len(T_S), SHARED))
        for place in range(len(NAMES)):
            self._columns[place, :, place % SHARED] = 0.0
        values = self.simulate([Point(np.concatenate([TRUTH, np.full(4, 0.3)]))], lambda one: one)
        whole = Segment(0.0, 10.0, None, 10.0)
        self.bundles = tuple(
            Bundle(
                ("y",), ("V",), T_S,
                value * (5.0 if name == other else 1.0)
                + NOISE * draw.standard_normal(value.shape),
                np.eye(1) * NOISE**2, (whole,), record=name,
            )
            for name, value in zip(NAMES, values[0], strict=True)
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point.nuisance, k) for k in range(len(NAMES))])
                for point in points]  # fmt: skip

    def _one(self, nuisance: Array, place: int) -> Array:
        told = self._columns[place] @ nuisance[:SHARED] + nuisance[SHARED + place]
        return np.asarray(told[:, None])


LAW = Candidate("law", "law", "plant", (Term("size", "size", "V", "", 0.0, 10.0, 0.1),))


class Inexact(Straight):
    """The same with a law on, of a form that is off while the motion begins."""

    candidates = (LAW,)

    def __init__(self) -> None:
        super().__init__()
        waves = np.sin(2.0 * np.pi * np.array([[7.3], [11.1], [13.7]]) * T_S).sum(axis=0)
        off = 0.72 * NOISE * np.where(T_S < 3.0, waves, 0.0)
        added = np.cos(2.0 * np.pi * 3.1 * T_S) + off
        self.bundles = tuple(replace(one, value=one.value + added[:, None]) for one in self.bundles)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        found = []
        for point in points:
            on = point.effects.get("law")
            size = 0.0 if on is None else on.values["size"]
            added = size * np.cos(2.0 * np.pi * 3.1 * T_S)[:, None]
            seen = [self._one(point.nuisance, k) + added for k in range(len(NAMES))]
            found.append(reduce(seen))
        return found


def lead(system: Straight, record: str, state: State | None = None) -> Chained:
    part = Part(system, (record,))
    first = follow_ring(part, np.zeros(len(part.nuisances)), state, everything=True)
    return chained(system, valley(part, first), (record,), np.zeros(len(system.nuisances)))


@pytest.mark.parametrize("first", NAMES)
def test_one_after_the_other_leads_to_where_all_at_once_lead(first: str) -> None:
    system = Straight()
    found = lead(system, first)
    at_once = follow_ring(system, np.zeros(len(system.nuisances)), everything=True)
    assert found.stuck == ""
    assert sorted(found.led) == sorted(NAMES)
    assert found.led[0] == first
    assert found.nuisance == pytest.approx(at_once.nuisance, abs=2e-3)
    assert found.nuisance[:SHARED] == pytest.approx(TRUTH, abs=0.03)


def test_what_the_first_leaves_open_the_others_close() -> None:
    system = Straight()
    part = Part(system, ("one",))
    alone = follow_ring(part, np.zeros(len(part.nuisances)), everything=True)
    assert abs(alone.nuisance[0] - TRUTH[0]) > 1.0
    assert lead(system, "one").nuisance[0] == pytest.approx(TRUTH[0], abs=0.03)


def test_a_recording_of_another_machine_is_said_to_be_the_one_that_does_not_fit() -> None:
    found = lead(Straight(other="three"), "one")
    assert found.stuck == "three"
    assert sorted(found.led) == ["four", "one", "two"]


def test_a_law_that_is_not_exact_early_on_is_led_through() -> None:
    law = Hypothesis({"law": PartOf(("size",))})
    found = lead(Inexact(), "one", State.at(law, {("law", "size"): 0.9}, {"law": LAW}))
    assert (found.stuck, found.aside) == ("", ())
    assert found.followed.state is not None
    assert found.followed.state.values[0] == pytest.approx(1.0, abs=0.02)


def test_what_parts_tell_is_kept_of_the_numbers_of_others_too() -> None:
    system = Straight()
    found = lead(system, "two")
    part = Part(system, ("two",))
    # The first recording's own offset is moved by what later ones tell of the shared numbers.
    alone = follow_ring(part, np.zeros(len(part.nuisances)), everything=True)
    at_once = follow_ring(system, np.zeros(len(system.nuisances)), everything=True)
    own = SHARED + NAMES.index("two")
    assert alone.nuisance[-1] != pytest.approx(at_once.nuisance[own], abs=1e-5)
    assert found.nuisance[own] == pytest.approx(at_once.nuisance[own], abs=2e-3)
