"""The engine finds the friction of a motor and ball-screw axis (EMPS)."""

import pytest

from tests.validation.runs import Run, beyond_published, emps, emps_rmse, published_emps

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def run(recordings: None) -> Run:
    return emps()


def test_coulomb_friction_is_named_first(run: Run) -> None:
    assert run.order[0] == ("coulomb",)
    assert "coulomb" in run.names
    # Friction that slides at once and friction that bends first are hard to tell apart here.
    assert run.diagnosis.verdict in ("explained", "ambiguous")


def test_force_is_predicted_as_well_as_by_the_published_model_or_better(run: Run) -> None:
    assert emps_rmse(run, run.chosen.point, "train") <= 2.21
    assert emps_rmse(run, run.chosen.point, "test") <= 3.56


def test_the_linear_model_is_where_it_starts(run: Run) -> None:
    assert emps_rmse(run, run.before, "train") == pytest.approx(9.7, abs=0.1)
    assert emps_rmse(run, run.before, "test") == pytest.approx(10.2, abs=0.1)


def test_the_published_model_is_judged_here_as_it_was_published(run: Run) -> None:
    assert emps_rmse(run, published_emps(), "train") == pytest.approx(2.21, abs=0.05)
    assert emps_rmse(run, published_emps(), "test") == pytest.approx(3.56, abs=0.2)


def test_the_published_offset_comes_out_beside_coulomb_friction(run: Run) -> None:
    form = run.fitted("coulomb", "offset")
    assert form.values["offset", "offset"] == pytest.approx(-3.165, abs=0.1)
    assert form.values["coulomb", "coulomb"] == pytest.approx(20.4, rel=0.15)


def test_the_data_ask_for_more_than_the_published_model(run: Run) -> None:
    assert "one_sided" in beyond_published(run), "viscous friction differs by direction"
    assert run.chosen.log_score > run.fitted("coulomb", "offset").log_score + 100.0
    # What is sure enough to be named foretells the train record better, not the test record.
    published = emps_rmse(run, published_emps(), "train")
    assert emps_rmse(run, run.chosen.point, "train") < 0.95 * published
