"""The engine finds what makes two cascaded tanks differ from a linear model."""

import pytest

from tests.validation.runs import Run, tanks

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def run(recordings: None) -> Run:
    return tanks()


def test_the_overflow_and_the_clipped_sensor_are_named(run: Run) -> None:
    assert {"overflow", "clipped"} <= run.names
    assert run.diagnosis.verdict == "explained"
    assert not any(cause.at_limit for cause in run.diagnosis.judgement.causes)


def test_wrong_candidates_are_not_named(run: Run) -> None:
    wrong = {"loss", "pump_bent", "splash", "delay", "sensor_bent", "sensor_drift"}
    assert not wrong & run.names


def test_the_test_record_is_foretold(run: Run) -> None:
    assert run.rmse(run.before, "test") > 0.55
    assert run.rmse(run.chosen.point, "test") <= 0.35


def test_the_residual_is_located_where_the_level_is_high(run: Run) -> None:
    blocks = [one for one in run.diagnosis.findings if one.line != one.line]
    level = run.judged.bundles[0]
    inside = (level.t_s >= blocks[0].start_s) & (level.t_s <= blocks[0].end_s)
    assert level.value[inside].max() > 9.0


def test_a_better_fit_with_a_negative_loss_is_flagged_and_not_named(run: Run) -> None:
    (flagged,) = run.diagnosis.implausible
    assert (flagged.candidate, flagged.term) == ("loss", "loss")
    assert flagged.value < 0.0 == flagged.low
    assert flagged.fitted.log_score > run.chosen.log_score
    assert run.rmse(flagged.fitted.point, "train") < run.rmse(run.chosen.point, "train")
    assert "loss" not in run.names
