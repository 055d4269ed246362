"""run01, the packaged reconstruction: friction at the pulleys, named, sized and switched on."""

import json
import re
from pathlib import Path

import jsonschema
import pytest

from analysis.compare import compare
from analysis.diagnose_command import run_diagnosis
from analysis.diagnosis.figures import write_figures
from analysis.diagnosis.policies import FRICTIONS
from analysis.diagnosis.prepare import prepare
from analysis.diagnosis.results import Result, write
from analysis.diagnosis.schema import statement_schema
from analysis.diagnosis.words import friction_of_cables
from analysis.tracking import poses_of
from cdpr8.rigfile import load_rig
from cdpr8.runfolder import load_run, sample_data_folder

pytestmark = pytest.mark.slow

RUN = sample_data_folder() / "run01"


def true_friction() -> dict[int, float]:
    """As sample_data/README.md tells it."""
    text = (sample_data_folder() / "README.md").read_text().split("Friction that made it")[1]
    found = {}
    for cables, value in re.findall(r"cables ([\d, and\n]+?) (0\.\d+)", text):
        found |= {int(cable): float(value) for cable in re.findall(r"\d+", cables)}
    assert sorted(found) == list(range(1, 9))
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("results")


@pytest.fixture(scope="module")
def found(folder: Path) -> Result:
    result = run_diagnosis(prepare([RUN]), folder)
    write(result, folder)
    return result


def test_friction_at_the_pulleys_is_named(found: Result) -> None:
    causes = found.statement["causes"]
    named = {one["effect"] for one in causes}
    assert named & set(FRICTIONS)
    assert found.statement["verdict"] in ("explained", "ambiguous")
    for one in causes:
        rivals = {one["effect"], *one["indistinguishable_from"]}
        assert rivals & set(FRICTIONS), f"{rivals} beside friction"
        assert one["where"]["side"] == "plant"


def test_it_is_between_frame_and_force_cells(found: Result) -> None:
    (told,) = found.statement["balance"]
    sees = {one["residual"]: one["sees"] for one in told["residuals"]}
    assert sees == {"cables": "yes", "platform": "no", "inner": "yes"}
    assert "between frame and force cell" in told["means"]


def test_every_cables_friction_is_what_made_it(found: Result) -> None:
    sized = friction_of_cables(found.statement)
    for cable, true in true_friction().items():
        assert sized.get(cable, 0.0) == pytest.approx(true, rel=0.15), f"cable {cable}"


def test_the_three_comparisons_of_the_paper_agree_with_the_improved_rig(
    found: Result, folder: Path
) -> None:
    run = load_run(RUN)
    rig = load_rig(folder / "improved.toml")
    after = compare(run, poses_of(run), rig, rig_name="improved.toml")
    for quantity in (after.angle, after.tensions[1], after.tensions[7]):
        assert quantity.relative_error < 0.007, quantity.measured.name


def test_it_fits_better_on_data_it_did_not_use(found: Result) -> None:
    fit = found.statement["fit"]
    for kind, before in fit["before"]["held_out"].items():
        assert fit["after"]["held_out"][kind] < 0.5 * before


def test_the_papers_guesses_are_answered(found: Result) -> None:
    told = found.statement["paper_guesses"]
    assert told["camera_rate"]["simulated_deg"] == pytest.approx(2.03, abs=0.01)
    assert told["camera_rate"]["recorded_deg"] == pytest.approx(1.92, abs=0.01)
    assert 0.0 < told["camera_rate"]["share"] < 0.3
    assert told["frequency_content"]["before"] > 20.0
    assert told["frequency_content"]["after"] < 1.5


def test_the_json_has_the_keys_of_the_design(found: Result, folder: Path) -> None:
    stored = json.loads((folder / "diagnose.json").read_text())
    jsonschema.validate(stored, statement_schema())
    assert set(stored) >= {"verdict", "causes", "remains", "fit", "next_experiment", "improved_rig"}


def test_its_figures_are_drawn(found: Result, folder: Path) -> None:
    assert found.pictures is not None
    written = write_figures(found.statement, found.pictures, folder)
    assert {
        "diagnose_story.png",
        "diagnose_map.png",
        "diagnose_loops.png",
        "diagnose_ranking.svg",
    } <= {path.name for path in written}
