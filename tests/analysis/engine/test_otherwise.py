"""What a law is mistaken for is led too: it the other way, and another that is akin."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from analysis.engine import Candidate, Point, Shape, Term
from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.kin import kin_left
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from tests.analysis.one_ring import T_S, ZERO, OneRing

HARMONICS_HZ = (2.1, 3.3)
"""Besides 0.7 Hz: of the one kind of loop, and of the other."""

KIND = Shape("kind", "1", 0.0, 0.0, 1.0, (0.0, 1.0), logarithmic=False, whole=True)
LOOP = Candidate(
    "loop", "a loop", "plant", (Term("size", "size", "N", "", 0.0, 5.0, 0.3),), (KIND,),
    form_share=0.02,
)  # fmt: skip

HYPOTHESIS = Hypothesis({"loop": Part(("size",), shapes={"kind": 1.0})})


class Looped(OneRing):
    """A ring, and a loop of one kind or the other."""

    name = "looped"
    candidates: Sequence[Candidate] = (LOOP,)

    def added(self, point: Point) -> Array | float:
        """The loop."""
        found: Array | float = 0.0
        for on in point.effects.values():
            hertz = HARMONICS_HZ[round(on.shapes["kind"])]
            loop = np.sin(2.0 * np.pi * 0.7 * T_S) + 0.3 * np.cos(2.0 * np.pi * hertz * T_S)
            found = found + on.values["size"] * loop
        return found


def state_of(size: float, kind: float) -> State:
    one = Hypothesis({"loop": Part(("size",), shapes={"kind": kind})})
    return State.at(one, {("loop", "size"): size}, {"loop": LOOP})


@pytest.mark.parametrize("kind", [0.0, 1.0])
def test_what_leaves_much_is_led_the_other_way(kind: float) -> None:
    system = Looped(state_of(0.25, kind).point(ZERO))
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    search = FollowedSearch(refiner, follow_ring(system, ZERO, everything=True), 2)
    search.lead_first([Guess(state_of(0.2, 1.0 - kind), ZERO)])
    found = search.fitted()
    assert found is not None
    assert found[0].hypothesis.parts["loop"].shapes["kind"] == kind
    assert abs(found[0].values["loop", "size"] - 0.25) < 0.01


def test_what_leaves_noise_is_not() -> None:
    system = Looped(state_of(0.25, 1.0).point(ZERO))
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    led: list[int] = []
    search = FollowedSearch(
        refiner, follow_ring(system, ZERO, everything=True), 2, lambda done, _: led.append(done)
    )
    search.lead_first([Guess(state_of(0.2, 1.0), ZERO)])
    assert led == [1]


def test_a_law_of_another_thing_that_is_akin_is_led_in_its_place_and_no_other() -> None:
    known = {
        "loop": replace(LOOP, akin=("slips", "not listed")),
        "slips": replace(LOOP, name="slips"),
        "bends": replace(LOOP, name="bends"),
    }
    best = Followed(ZERO, State.at(HYPOTHESIS, {("loop", "size"): 0.3}, known))
    assert list(kin_left(best, [best], known)) == [("loop", "slips", ("slips",))]
    assert not known["slips"].is_kin(known["loop"])
