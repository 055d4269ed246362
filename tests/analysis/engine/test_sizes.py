"""What is strong is found in its size, where straight lines lead nowhere."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.candidate import Candidate, Term
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.ring_fit import follow_ring
from analysis.engine.search import search
from analysis.engine.sizes import in_any_size
from analysis.engine.system import Point
from tests.analysis.engine.test_ring_fit import DAMPING, SIGMA, STEP, LetGo, ring, state_of

WHEEL = Candidate(
    "wheel", "a wheel that has to be turned", "plant",
    (Term("share", "share", "1", "", 0.0, 2.0, 0.1),),
)  # fmt: skip
LEAN = Candidate("lean", "lean", "plant", (Term("by", "by", "V", "", -0.3, 5.0, 0.1),))


class Wheeled(LetGo):
    """An oscillator with a wheel on it, which lowers its tone."""

    candidates = (DAMPING, STEP, WHEEL)

    def _one(self, point: Point) -> np.ndarray:
        wheel = point.effects.get("wheel")
        lower = 1.0 / np.sqrt(1.0 + (wheel.values["share"] if wheel else 0.0))
        damping = point.effects.get("damping")
        tone = (1.0 + SIGMA * float(point.nuisance[0])) * lower - 1.0
        return ring(tone, damping.values["rate"] if damping else 0.0, 0.0, 0.0, self.t_s)


def wheeled(share: float) -> Wheeled:
    return Wheeled(ring((1.0 + 0.5 * SIGMA) / np.sqrt(1.0 + share) - 1.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("share", [0.5, 0.8, 1.1])
def test_a_strong_cause_is_put_first_in_about_its_size(share: float) -> None:
    system = wheeled(share)
    candidates = {one.name: one for one in system.candidates}
    nothing = follow_ring(system, np.zeros(1), everything=True)
    assert not nothing.to_end
    first, *_ = in_any_size(system, candidates, nothing)
    assert first.hypothesis.names == ("wheel",)
    size = first.state.term_values()["wheel", "share"]
    assert share / 1.6 < size < 1.6 * share
    assert first.nuisance is (nothing.about or nothing).nuisance


def test_what_lines_told_is_weighed_among_them_where_it_stands() -> None:
    system = wheeled(0.5)
    candidates = {one.name: one for one in system.candidates}
    nothing = follow_ring(system, np.zeros(1), everything=True)
    # Parameters were bent a little before it was lost: beside that it is this.
    right = Guess(state_of(WHEEL, 0.43), np.array([0.5]), log_score=-1e9)
    wrong = Guess(state_of(DAMPING, 0.02), np.array([0.5]), log_score=1e9)
    found = in_any_size(system, candidates, nothing, [wrong, right])
    assert found[0].state is right.state
    assert [one.state is wrong.state for one in found].index(True) > 1
    assert [one.log_score for one in found] == sorted(
        (one.log_score for one in found), reverse=True
    )


def test_no_size_is_beyond_what_is_plausible() -> None:
    system = wheeled(0.5)
    system.candidates = (LEAN,)
    nothing = follow_ring(system, np.zeros(1), everything=True)
    (only,) = in_any_size(system, {"lean": LEAN}, nothing)
    assert -0.3 <= only.state.term_values()["lean", "by"] <= 0.8


def test_it_is_named_with_its_number() -> None:
    found = search(wheeled(0.5))
    assert found.fitted[0].hypothesis.names == ("wheel",)
    assert found.fitted[0].values["wheel", "share"] == pytest.approx(0.5, abs=0.02)
    assert found.fitted[0].left == pytest.approx(1.0, abs=0.1)


def test_what_parameters_made_up_for_over_a_long_time_is_left_to_straight_lines() -> None:
    system = wheeled(0.5)
    candidates = {one.name: one for one in system.candidates}
    late = replace(Followed(np.zeros(1), None), telling=0.27)
    told = [Guess(state_of(DAMPING, 0.02), np.zeros(1))]
    assert in_any_size(system, candidates, late, told) == told
    early = replace(late, telling=0.1)
    assert len(in_any_size(system, candidates, early, told)) == 1 + len(candidates)
