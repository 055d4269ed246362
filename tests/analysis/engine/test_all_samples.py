"""What all samples say of hypotheses, and which are led to say it."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.followed_search import FollowedSearch
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from tests.analysis.engine.test_ring_fit import DAMPING, STEP, LetGo, ring

DAMPED = LetGo(ring(0.0, 0.2, 0.0, 0.0))


@pytest.fixture(scope="module")
def refiner() -> Refiner:
    found = look(DAMPED)
    return Refiner(DAMPED, found.lens, found.data, found.calibrated)


def test_of_two_causes_that_were_led_together_each_is_tried_alone(refiner: Refiner) -> None:
    both = Hypothesis({"damping": Part(("rate",)), "step": Part(("high",), False, {"moment": 9.0})})
    values = {("damping", "rate"): 0.19, ("step", "high"): 0.002}
    state = State.at(both, values, {one.name: one for one in (DAMPING, STEP)})
    pair = refiner.at(state, np.zeros(1))
    nothing = replace(follow_ring(DAMPED, np.zeros(1), everything=True), columns=None)
    search = FollowedSearch(refiner, nothing, 2)
    search.follow([pair], [])
    found = search.fitted()
    assert found is not None
    assert found[0].hypothesis.names == ("damping",)
