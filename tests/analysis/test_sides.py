"""The truth table of the three residuals: what is said of each, and where nothing is."""

from pathlib import Path
from typing import Any

import pytest
from recorded_by import STILL, by_model

from analysis.diagnosis.balance import balance
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sides import in_words, side, sides
from analysis.diagnosis.tables import balance as table
from cdpr8.rigfile import Excitation
from cdpr8.rigfile.schema import CellPlace
from model import ActiveEffect

SLOW = Excitation(motion_s=8.0, **STILL)
RUBBING = ActiveEffect("pulley_coulomb", {"coulomb_n": (0.3, 0.3, 0, 0, 0, 0, 0, 0)})


def recorded(
    folder: Path,
    *effects: ActiveEffect,
    cell: CellPlace = CellPlace.PLATFORM,
    moved: Excitation = SLOW,
) -> Recording:
    return by_model(folder / "run", list(effects), moved, cell=cell)


def told(recording: Recording) -> dict[str, Any]:
    found = side(balance(recording))
    assert found is not None
    return {one["residual"]: one["sees"] for one in found["residuals"]} | {"means": found["means"]}


def located(recording: Recording) -> list[dict[str, Any]]:
    return [{"run": recording.run.name, "sigmas": 50.0}]


def test_nothing_is_said_of_a_clean_run(tmp_path: Path) -> None:
    clean = recorded(tmp_path)
    assert side(balance(clean)) is None
    assert sides([clean], located(clean)) == []


def test_nothing_is_said_where_nothing_was_located(tmp_path: Path) -> None:
    assert sides([recorded(tmp_path, RUBBING)], []) == []


def test_nothing_is_said_where_the_camera_is_too_slow(tmp_path: Path) -> None:
    fast = Excitation(motion_s=4.0, frequency_hz=7.5, **STILL)
    run = recorded(tmp_path, RUBBING, moved=fast)
    assert sides([run], located(run)) == []


def test_friction_behind_the_cell_is_between_frame_and_cell(tmp_path: Path) -> None:
    found = told(recorded(tmp_path, RUBBING))
    assert (found["cables"], found["platform"]) == ("yes", "no")
    assert found["means"].startswith("Cables 1 and 2 pull otherwise")
    assert "between frame and force cell" in found["means"]
    assert "unless" not in found["means"]


def test_friction_before_the_cell_is_not_in_the_cables(tmp_path: Path) -> None:
    found = told(recorded(tmp_path, RUBBING, cell=CellPlace.BASE))
    assert found["cables"] != "yes"
    assert found["platform"] == "yes"
    assert "between force cells and platform" in found["means"]


def test_a_wrong_gain_is_in_the_cell(tmp_path: Path) -> None:
    wrong = ActiveEffect("cell_gain", {"gain_share": (0.2, 0, 0, 0, 0, 0, 0, 0)})
    found = told(recorded(tmp_path, wrong))
    assert (found["cables"], found["platform"]) == ("yes", "yes")
    assert found["means"].startswith("Cable 1 pulls otherwise")
    assert "in the cell itself" in found["means"]


def test_a_late_camera_is_not_told_from_damping(tmp_path: Path) -> None:
    found = told(recorded(tmp_path, ActiveEffect("camera_latency", {"latency_s": 0.01})))
    assert "ahead of the measured elongation" in found["means"]
    assert "a late camera or damping of the cables" in found["means"]


def test_late_cells_are_told_from_a_late_camera(tmp_path: Path) -> None:
    found = told(recorded(tmp_path, ActiveEffect("cell_lag", {"lag_s": 0.01})))
    assert "behind the measured elongation: late force cells" in found["means"]


def test_a_wrong_scale_of_the_camera_is_one_share_in_all(tmp_path: Path) -> None:
    wide = ActiveEffect("camera_gain", {"gain_share": 0.2})
    assert "one share of k ΔL" in told(recorded(tmp_path, wide))["means"]


def test_a_table_and_a_sentence_tell_it(tmp_path: Path) -> None:
    run = recorded(tmp_path, RUBBING)
    found = sides([run], located(run))
    said = {"balance": found}
    rows = table(said).rows
    assert [row[1] for row in rows] == ["yes", "no", "yes"]
    assert rows[0][2] == "1 and 2"
    assert in_words(said) == found[0]["means"]
    both = {"balance": [*found, {**found[0], "run": "second", "means": "Another."}]}
    assert in_words(both).endswith("second: Another.")
    assert table(both).rows[3][0] == "second"
    assert table({}).rows == ()
    assert in_words({}) == ""


@pytest.mark.parametrize("verdict", ["none", "explained"])
def test_an_agreeing_run_has_no_side(verdict: str) -> None:
    assert in_words({"verdict": verdict, "balance": []}) == ""
