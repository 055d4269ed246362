"""A number that moved too far beside a law is told, as likely as that says; and what it did by
itself is no fit of nothing left out."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine import diagnose
from analysis.engine.hypothesis import Part
from analysis.engine.judge import SECOND
from analysis.engine.look import look
from analysis.engine.moved import EVEN, freed, raised, released_beside
from analysis.engine.refine import Refiner
from analysis.engine.state import State
from tests.analysis.engine.test_freed import RATE, Detuned, beside_damping
from tests.analysis.engine.test_judge import CANDIDATES, DAMPING, STEP, fitted, refiner, state_of
from tests.analysis.engine.test_ring_fit import SIGMA, ring

__all__ = ["refiner"]


@pytest.mark.parametrize(
    ("off", "names"), [(5.0, {"damping", "tone"}), (1.0, {"damping"}), (-1.0, {"damping"})]
)
def test_a_number_that_is_far_off_beside_a_law_is_told_with_it(off: float, names: set[str]) -> None:
    found = diagnose(Detuned(ring(off * SIGMA, RATE, 0.0, 0.0)))
    assert found.judgement is not None
    assert {one.name for one in found.judgement.causes} == names
    told = {one.name: one.values for one in found.judgement.causes}
    if "tone" in names:
        assert told["tone"]["share"] == pytest.approx(off * SIGMA, rel=0.05)


def test_before_has_what_is_told_as_it_was_known_to_be() -> None:
    found = diagnose(Detuned(ring(5.0 * SIGMA, 0.0, 0.0, 0.0)))
    assert found.judgement is not None
    assert [one.name for one in found.judgement.causes] == ["tone"]
    assert found.confirmation is not None
    (before,), (after,) = (
        part["used"].values() for part in (found.confirmation.before, found.confirmation.after)
    )
    assert after == pytest.approx(1.0, abs=0.1)
    assert before > 2.0, "five sigmas of a tone, that nuisances alone would have followed"


@pytest.mark.parametrize(
    ("off", "back", "is_told"), [(5.0, 0.0, True), (1.0, 0.0, False), (5.0, 4.0, False)]
)
def test_a_number_that_was_led_beside_a_law_counts_as_it_had_moved(
    off: float, back: float, is_told: bool
) -> None:
    system = Detuned(ring(off * SIGMA, RATE, 0.0, 0.0))
    refiner = Refiner(system, *look(system))
    alone = beside_damping(system, off)
    both = freed(system, refiner.candidates, replace(alone, nuisance=alone.nuisance - back), "tone")
    fits = []
    for led, score in ((both, 0.0), (alone, -10.0)):
        assert led.state is not None
        there = refiner.standing(led.state, led.nuisance)
        fits.append(replace(there, log_score=score, left=1.0))
    new, beside = released_beside(refiner, fits, noise=1.1, most_causes=2)
    assert new == []
    assert set(beside) == ({("damping", "tone")} if is_told else set())
    for cause, sigmas in beside.values():
        assert cause == "tone"
        assert sigmas == pytest.approx(off, rel=0.1)


@pytest.mark.parametrize(("sigmas", "told"), [(EVEN, 0.5), (5.0, 0.98), (2.0, 0.22)])
def test_it_is_as_likely_as_it_moved_and_no_other_hypothesis_is_less_so(
    refiner: Refiner, sigmas: float, told: float
) -> None:
    law = state_of(DAMPING, 0.2)
    both = [fitted(refiner, one, 0.0, 1.0) for one in (law, state_of(STEP, 1.0, moment=4.0), None)]
    step = Part(("high",), shapes={"moment": 4.0})
    sizes = {("damping", "rate"): 0.2, ("step", "high"): 1.0}
    on = State.at(law.hypothesis.plus("step", step), sizes, CANDIDATES)
    pair = fitted(refiner, on, 0.0, 1.0)
    weights = np.array([0.6, 0.3, 0.1, 0.0])
    found = raised(weights, [*both, pair], CANDIDATES, {("damping", "step"): ("step", sigmas)})
    assert found.sum() == pytest.approx(1.0)
    assert found[1:3] == pytest.approx(weights[1:3])
    assert found[3] / 0.6 == pytest.approx(told, abs=0.01)
    assert (found[3] > SECOND * 0.6) == (sigmas > 4.0)
