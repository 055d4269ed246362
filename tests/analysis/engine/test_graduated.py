"""What sticks begins bent: that is a place's own number, and lines lead to the ring's phase."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Shape, Term
from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.graduated import STRETCH, alike, as_told, graduated
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.survey import sticks, surveyed
from analysis.engine.system import Prediction

T_S = np.arange(0.0, 20.0, 0.02)
NOISE, TONE_HZ, SIGMA = 0.002, 5.0, 0.01
START_S = 1.0
STUCK = Candidate(
    "stuck", "a mass that sticks", "plant",
    tuple(Term(f"force@{k}", "force", "N", f"{k}", 0.0, 5.0, 0.3) for k in (1, 2)),
    tuple(Shape(f"bent@{k}", "1", 0.0, -1.0, 1.0, logarithmic=False, term=f"force@{k}")
          for k in (1, 2)),
)  # fmt: skip


STUCK = replace(STUCK, family="sticking")
SOFT = replace(STUCK, name="soft", title="a mass that sticks softly")
BOTH = {"soft": SOFT, "stuck": STUCK}
PLAY = replace(
    STUCK, name="play", title="a mass with play", family="", bends=True,
    shapes=(Shape("middle", "1", 0.0, -1.0, 1.0, logarithmic=False),
            Shape("held", "1", 1.0, 0.0, 1.0, (1.0, 0.0), logarithmic=False, whole=True)),
)  # fmt: skip


class Sticking:
    """A ring whose tone, size and mean go with what sticks, and with how far that was bent."""

    name = "sticking"
    nuisances: Sequence[Nuisance] = (Nuisance("tone", SIGMA, "1"),)
    candidates: Sequence[Candidate] = tuple(BOTH.values())

    def __init__(self, true: Point) -> None:
        value = self._one(true)
        value = value + NOISE * np.random.default_rng(3).standard_normal(value.shape)
        segments = (Segment(0.0, START_S, None, 20.0, name="rest"), Segment(1.0, 20.0, None, 20.0))
        self.bundles = (
            Bundle(("y",), ("V",), T_S, value, np.eye(1) * NOISE**2, segments, tones_hz=(TONE_HZ,)),
        )

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point)]) for point in points]

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return np.array([TONE_HZ * (1.0 + SIGMA * float(point.nuisance[0]))])

    def _one(self, point: Point) -> Array:
        on = next(iter(point.effects.values()), None)
        shapes = on.shapes if on else {}
        second = 0.02 if "soft" in point.effects or not shapes.get("held", 1.0) else 0.0
        force = on.values.get("force@1", 0.0) if on else 0.0
        bent = shapes.get("bent@1", shapes.get("middle", 0.0))
        since = np.maximum(T_S - START_S, 0.0)
        hertz = TONE_HZ * (1.0 + SIGMA * float(point.nuisance[0]) + 0.3 * force * bent)
        shift = force * (1.0 - bent) * (T_S > START_S)
        turned = 2.0 * np.pi * hertz * since
        ring = (1.0 + 0.5 * force) * np.sin(turned) + second * force * np.sin(2.0 * turned)
        return np.asarray((ring + shift)[:, None])


def state_of(force: float, bent: float, name: str = "stuck") -> State:
    part = Part(("force@1",), shapes={"bent@1": bent, "bent@2": 0.0})
    return State.at(Hypothesis({name: part}), {(name, "force@1"): force}, BOTH)


def test_what_a_place_begins_with_is_free_where_that_place_is_on() -> None:
    one = state_of(0.5, 0.3)
    assert [n.shape.name for n in one.numbers if n.shape is not None] == ["bent@1"]
    both = State.at(
        Hypothesis({"stuck": Part(("force@1", "force@2"), shapes={"bent@1": 0.3})}),
        {("stuck", "force@1"): 0.5, ("stuck", "force@2"): 0.4},
        {"stuck": STUCK},
    )
    assert [n.shape.name for n in both.numbers if n.shape is not None] == ["bent@1", "bent@2"]
    known = {"stuck": STUCK}
    assert one.hypothesis.log_prior(known) > both.hypothesis.log_prior(known)


def test_it_may_come_to_the_end_of_its_range() -> None:
    assert state_of(0.5, 1.0).at_edge() == ()
    assert state_of(5.0, 1.0).at_edge() == (("stuck", "force@1"),)


def test_numbers_that_lines_tell_are_led_to_the_rings_phase() -> None:
    true = state_of(0.6, 0.5)
    system = Sticking(true.point(np.array([1.5])))
    guess = Guess(state_of(0.63, 0.47), np.zeros(1))
    samples = Samples(system, everything=True)
    start = graduated(samples, guess)
    assert start.left < 2.0
    assert start.share == STRETCH
    assert start.state is not None
    found = follow_ring(system, start.nuisance, start.state, everything=True)
    assert found.to_end
    assert found.left == pytest.approx(1.0, abs=0.2)
    assert found.state is not None
    assert found.state.values == pytest.approx(true.values, abs=0.01)


def test_another_law_of_it_is_begun_from_where_the_wrong_one_has_come_to() -> None:
    true = state_of(0.6, 0.5)
    samples = Samples(Sticking(true.point(np.array([1.5]))), everything=True)
    wrong = graduated(samples, Guess(state_of(0.63, 0.47, "soft"), np.zeros(1)))
    assert wrong.left > 2.0
    (right,) = (one for one in alike(samples, wrong, BOTH) if one.names == ("stuck",))
    assert right.left == pytest.approx(1.0, abs=0.2)
    assert right.state is not None
    assert right.state.values == pytest.approx(true.values, abs=0.05)


def test_a_survey_finds_the_valley_where_what_was_told_is_far_off() -> None:
    true = state_of(0.6, 0.5)
    samples = Samples(Sticking(true.point(np.array([1.0]))), everything=True)
    far = Guess(state_of(1.4, -0.6), np.zeros(1))
    lost = graduated(samples, far)
    assert lost.left > 10.0
    assert lost.state is not None
    assert sticks(lost.state)
    found = surveyed(samples, lost, np.zeros(1))
    assert found.left == pytest.approx(1.0, abs=0.2)
    assert found.state is not None
    assert found.state.values == pytest.approx(true.values, abs=0.02)


def test_what_lines_tell_is_known_to_a_share_and_nuisances_as_before() -> None:
    known = as_told(Guess(state_of(0.8, 0.4), np.ones(1)))
    assert known.at == pytest.approx([0.0, 0.8, 0.4])
    assert np.sqrt(1.0 / np.diag(known.information)) == pytest.approx([1.0, 0.04, 0.06])


def test_what_is_one_thing_or_another_is_asked_the_other_way() -> None:
    either = Shape("early", "1", 1.0, 0.0, 1.0, (1.0, 0.0), logarithmic=False, whole=True)
    known = {"stuck": replace(STUCK, shapes=(*STUCK.shapes, either))}
    part = Part(("force@1",), shapes={"bent@1": 0.2, "early": 1.0})
    state = State.at(Hypothesis({"stuck": part}), {("stuck", "force@1"): 0.5}, known)
    (other,) = state.otherwise()
    assert other.hypothesis.parts["stuck"].shapes["early"] == 0.0
    assert other.values == pytest.approx(state.values)
    assert not other.is_about(state)
    assert not list(state_of(0.5, 0.2).otherwise())


def test_a_survey_tells_as_which_of_two_things_what_has_play_is_there() -> None:
    def played(force: float, middle: float, held: float) -> State:
        part = Part(("force@1",), shapes={"middle": middle, "held": held})
        return State.at(Hypothesis({"play": part}), {("play", "force@1"): force}, {"play": PLAY})

    true = played(0.6, -0.5, held=0.0)
    samples = Samples(Sticking(true.point(np.array([1.0]))), everything=True)
    start = Followed(np.zeros(1), played(1.4, 0.6, held=1.0))
    assert start.state is not None
    assert sticks(start.state)
    found = surveyed(samples, start, np.zeros(1))
    assert found.state is not None
    assert found.state.hypothesis.parts["play"].shapes["held"] == 0.0
    assert found.left == pytest.approx(1.0, abs=0.2)
    assert found.state.values == pytest.approx(true.values, abs=0.02)
