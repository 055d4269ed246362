"""The engine finds the spring of an electronic oscillator (Silverbox), and a wrong hold."""

import pytest

from tests.validation.runs import FULL, Run, silverbox
from tests.validation.silverbox import RATE_HZ


@pytest.fixture(scope="module")
def run(recordings: None) -> Run:
    return silverbox()


@pytest.fixture(scope="module")
def held(recordings: None) -> Run:
    return silverbox(hold="zero-order")


def test_the_cubic_spring_is_named_and_the_quadratic_alone_is_not(run: Run) -> None:
    assert run.order[0] == ("cubic",)
    assert "cubic" in run.names
    assert run.diagnosis.verdict == "explained"
    (quadratic,) = (
        one for one in run.diagnosis.search.screened if one.hypothesis.names == ("quadratic",)
    )
    assert quadratic.log_score < run.diagnosis.search.screened[0].log_score - 1000.0


def test_the_louder_arrow_is_foretold(run: Run) -> None:
    assert run.rmse(run.before, "arrow") > 13e-3
    assert run.rmse(run.chosen.point, "arrow") <= 0.45e-3
    assert run.rmse(run.fitted("cubic").point, "arrow") <= 0.45e-3


@pytest.mark.long
def test_a_wrong_hold_is_named_as_timing_beside_the_spring(held: Run) -> None:
    assert {"cubic", "delay"} <= held.names
    late_s = held.chosen.values["delay", "delay"]
    assert late_s * RATE_HZ == pytest.approx(-0.5, abs=0.05)
    assert held.rmse(held.before, "multisine") > 13e-3
    assert held.rmse(held.chosen.point, "multisine") < 1.0e-3


@pytest.mark.slow
def test_all_of_the_train_part_says_the_same(recordings: None) -> None:
    run = silverbox(FULL)
    assert run.order[0] == ("cubic",)
    assert run.rmse(run.chosen.point, "arrow") <= 0.45e-3
