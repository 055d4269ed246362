"""A product of two nuisances, of which a third makes up: straight lines, and back onto them.

A level is `trim * off + tight`, told to a thousandth of what trim and off move it by, and to a
hundredth of how well `tight` is known. Trim and off are told beside it, the worse the less.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate
from analysis.engine.followed import Followed, straight_on
from analysis.engine.part import Part
from analysis.engine.ring_fit import follow_ring
from analysis.engine.sharper import Sharper, Told
from analysis.engine.system import Nuisance, Point, Prediction, bend_of

T_S = np.arange(0.0, 10.0, 0.02)
NOISE, TIGHT = 1e-3, 0.1
SEEN = (1.0, 2e-3, 2e-3)
"""How much of the level, of the trim and of what is off each channel shows."""

TRUE = np.array([0.9, 1.4, -0.5])
"""Trim, off and tight, in sigmas."""


class Trimmed:
    """A level with a trim, of which nothing is known to be bent."""

    name = "trimmed"
    candidates: Sequence[Candidate] = ()
    nuisances: Sequence[Nuisance] = (
        Nuisance("trim", 1.0, "1"),
        Nuisance("off", 1.0, "m"),
        Nuisance("tight", TIGHT, "N", loose=True),
    )

    def __init__(self) -> None:
        value = shown(TRUE)
        noisy = value + NOISE * np.random.default_rng(1).standard_normal(value.shape)
        segment = Segment(0.0, 10.0, None, 20.0)
        self.bundles = (
            Bundle(("level", "trim", "off"), ("V",) * 3, T_S, noisy, NOISE**2 * np.eye(3),
                   (segment,), record="one"),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([shown(point.nuisance)]) for point in points]


class Straight(Trimmed):
    """The same, where the product is known."""

    def bend(self, here: Point, there: Point) -> Array:
        """See `Bent`."""
        trim, off = (there.nuisance - here.nuisance)[:2]
        return np.array([0.0, 0.0, -trim * off / TIGHT])


def shown(nuisance: Array) -> Array:
    trim, off, tight = nuisance
    return np.outer(np.ones(len(T_S)), np.array(SEEN) * [trim * off + TIGHT * tight, trim, off])


def level(nuisance: Array) -> float:
    return float(shown(nuisance)[0, 0])


def test_a_step_straight_on_does_what_its_parts_do() -> None:
    here, change = Followed(np.array([0.3, 0.2, 0.1]), None), np.array([0.5, -0.7, 0.4])
    there = straight_on(Straight(), here, change)
    parts = sum(level(here.nuisance + one) - level(here.nuisance) for one in np.diag(change))
    assert level(there.nuisance) - level(here.nuisance) == pytest.approx(parts)
    assert there.nuisance[:2] == pytest.approx((here.nuisance + change)[:2])


def test_a_system_that_says_nothing_is_not_bent() -> None:
    here, change = Followed(np.zeros(3), None), np.array([0.5, -0.7, 0.4])
    assert np.array_equal(straight_on(Trimmed(), here, change).nuisance, change)


def test_what_is_known_comes_to_the_valley_s_end_in_fewer_simulations() -> None:
    start = np.array([0.1, 0.1, 0.0])
    blind, sees = (
        follow_ring(system, start, everything=True) for system in (Trimmed(), Straight())
    )
    assert sees.effort < 0.5 * blind.effort
    costs = [one.misfit + one.strain for one in (blind, sees)]
    assert costs[1] < costs[0] + 1.0
    assert level(sees.nuisance) == pytest.approx(level(TRUE), abs=5.0 * NOISE / np.sqrt(len(T_S)))


def test_a_part_and_what_is_known_better_are_bent_alike() -> None:
    system, change = Straight(), np.array([0.5, -0.7, 0.4])
    here, there = Point(np.zeros(3)), Point(change)
    assert bend_of(Part(system, ["one"]), here, there) == pytest.approx(system.bend(here, there))
    known = Sharper(system, Told(0.5, "", 0.0))
    assert known.nuisances[2].sigma == pytest.approx(0.5 * TIGHT)
    scale = np.array([1.0, 1.0, 0.5])
    assert scale * bend_of(known, here, there) == pytest.approx(system.bend(here, there))
