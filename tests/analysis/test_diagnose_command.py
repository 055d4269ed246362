"""`analysis diagnose` and `analysis report` at the command line."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from diagnosis_stand_ins import result

from analysis.command import app
from analysis.diagnosis.results import write
from analysis.diagnosis.schema import statement_schema
from cdpr8.rigfile import Excitation, load_rig, packaged_rig_path
from cdpr8.runfolder import Run, load_run
from cdpr8.terminal import run_app
from rig.simulated.plant import simulate_platform

MakeRun = Callable[..., Run]

SHORT = Excitation(motion_s=3.5, rest_s=0.5)

Printed = Callable[[], tuple[str, str]]


@pytest.fixture(scope="module")
def recorded(make_run_in: MakeRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    truth = simulate_platform(load_rig(packaged_rig_path()), SHORT, np.full(8, 0.3))
    return make_run_in(tmp_path_factory.mktemp("recorded"), truth, excitation=SHORT).folder


@pytest.fixture
def rubbing_run(recorded: Path, tmp_path: Path) -> Run:
    """A copy, into which results may be written."""
    return load_run(shutil.copytree(recorded, tmp_path / "run"))


@pytest.mark.parametrize(
    ("arguments", "code", "wanted"),
    [
        (["run99"], 3, "no run 'run99'"),
        (["run01", "--effects", "gremlins"], 2, "no effect is called gremlins"),
        (["run01", "--effects", ","], 2, "no effect is called"),
        (["run01", "run01"], 3, "is named twice"),
        (["run01", "--stop-after", "lunch"], 2, "lunch"),
    ],
    ids=["no run", "no effect", "no name", "twice", "no stage"],
)
def test_bad_input_gets_one_message(
    arguments: list[str], code: int, wanted: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app(app, ["diagnose", *arguments]) == code
    told = capsys.readouterr().err
    assert wanted in told
    assert "Traceback" not in told


def test_it_stops_after_locating(rubbing_run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["diagnose", str(rubbing_run.folder), "--stop-after", "locate", "--workers", "1"]
    assert run_app(app, [*asked, "--json", "--no-figures"]) == 0
    said = json.loads(capsys.readouterr().out)
    jsonschema.validate(said, statement_schema())
    assert said["verdict"] == "not asked"
    assert said["causes"] == []
    # Friction at the pulleys shows at the drive's own frequency, in cables and in the angle.
    first = {one["channel"] for one in said["located"] if one["line"] == 1.0}
    assert any(channel.startswith("tension") for channel in first)
    assert all(one["sigmas"] > 3.0 for one in said["located"])
    assert {"tap", "command_log"} == set(said["missing"])
    folder = rubbing_run.folder / "results"
    assert json.loads((folder / "diagnose.json").read_text()) == said
    assert not list(folder.glob("*.png"))


def test_a_report_is_made_of_what_is_there(
    rubbing_run: Run, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = result()
    made.statement["provenance"]["runs"][0]["id"] = rubbing_run.start.id
    made.statement["improved_rig"] = None
    write(made, rubbing_run.folder / "results")
    monkeypatch.setattr("analysis.page.gather._diagnose", None)
    monkeypatch.setattr("analysis.page.page.drawings", lambda *_: [])
    assert run_app(app, ["report", str(rubbing_run.folder)]) == 0
    page = rubbing_run.folder / "results" / "report.html"
    printed = capsys.readouterr()
    assert printed.out.strip() == str(page)
    assert "comparing run with its simulation" in printed.err
    text = page.read_text(encoding="utf-8")
    assert "The paper&#x27;s Section 5" in text
    assert "Made for this page: the comparison" in text
    # The second time nothing has to be made.
    assert run_app(app, ["report", str(rubbing_run.folder), "--out", str(page)]) == 0
    assert capsys.readouterr().err == ""


def test_a_diagnosis_of_another_run_is_not_reported_as_this_ones(
    rubbing_run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    from analysis.page import gather as module

    write(result(), rubbing_run.folder / "results")
    monkeypatch.setattr(module, "_diagnose", lambda *_: result())
    told: list[str] = []
    module.gather(rubbing_run.folder, workers=1, say=told.append)
    assert "holds no diagnosis of run" in told[0]


def test_help_has_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("diagnose", "report", "compare"):
        assert run_app(app, [command, "--help"]) == 0
        assert f"Example: analysis {command} run01" in capsys.readouterr().out


def test_the_schema_holds_the_keys_of_the_design() -> None:
    wanted = {"verdict", "causes", "remains", "fit", "next_experiment", "improved_rig"}
    assert set(statement_schema()["required"]) == wanted


def test_packaged_runs_leave_results_where_one_stands(tmp_path: Path) -> None:
    from cdpr8.runfolder import find_run, results_folder

    assert results_folder(find_run("run01")) == Path("results") / "run01"
