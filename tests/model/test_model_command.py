import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cdpr8.terminal import run_app
from model.command import app

QUICK = ["simulate", "--rest", "0.2", "--motion", "1", "--ramp", "0.2"]


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run_app(app, arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_the_paper_case_prints_the_papers_figures(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "simulate", "--paper")
    assert code == 0
    assert "2.03" in next(line for line in out.splitlines() if "max |pitch|" in line)
    assert [word for word in ("7.61", "6.25") if word in out] == ["7.61", "6.25"]
    assert "ok: every cable taut" in out


def test_without_excitation_effect_the_pitch_is_the_commanded_one(
    capsys: pytest.CaptureFixture[str],
) -> None:
    code, out, _ = run(capsys, "simulate", "--paper", "--no-excitation-effect", "--json")
    summary = json.loads(out)["summary"]
    assert code == 0
    assert f"{summary['max_pitch_deg']:.2f}" == "2.00"
    assert max(summary["cable_amplitude_mm"]) == 0.0


def test_options_change_the_motion(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(
        capsys, *QUICK, "--axis", "roll", "--amplitude", "1", "--frequency", "4", "--json"
    )
    answer = json.loads(out)
    excitation = answer["provenance"]["excitation"]
    assert code == 0
    assert answer["steady_window_s"] == pytest.approx([0.4, 1.0])
    assert (excitation["axis"], excitation["frequency_hz"]) == ("roll", 4.0)
    assert answer["summary"]["max_roll_deg"] == pytest.approx(1.0, abs=0.05)
    assert answer["summary"]["max_pitch_deg"] < 0.1


def test_the_series_is_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    out_file = tmp_path / "run.csv"
    code, out, _ = run(capsys, *QUICK, "--rate", "100", "--out", str(out_file))
    frame = pd.read_csv(out_file)
    assert code == 0
    assert "141 rows written" in out
    assert frame["t_s"].to_numpy() == pytest.approx(np.arange(141) / 100.0)
    assert frame["pitch_deg"].abs().max() == pytest.approx(2.0, abs=0.1)


def test_a_check_that_fails_is_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    good, out, _ = run(capsys, *QUICK, "--check")
    assert good == 0
    assert out.count("ok: ") == 3
    coarse = ["--rate", "25", "--step", "0.04", "--method", "rk4"]
    bad, _, err = run(capsys, *QUICK, *coarse, "--check")
    assert bad == 1
    assert "halving the step" in err


def test_a_slack_cable_is_told_and_is_no_failure(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, *QUICK, "--amplitude", "6", "--json")
    outcome = json.loads(out)["outcome"]
    assert code == 0
    assert outcome["status"] == "slack"
    assert outcome["cable"] in range(1, 9)


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["--frequency", "-1"], 2, "frequency_hz -1.0"),
        (["--motion", "1", "--ramp", "0.8"], 2, "two ramps"),
        (["--out", "series.xlsx"], 2, "ending in .csv"),
        (["--out", "no/such/folder/run.csv"], 2, "no/such/folder"),
        (["--rate", "0"], 2, "above 0"),
        (["--step", "0"], 2, "above 0"),
        (["--rig", "nowhere.toml"], 3, "nowhere.toml"),
        (["--method", "euler"], 2, "rk4"),
    ],
)
def test_a_bad_input_gets_one_message(
    capsys: pytest.CaptureFixture[str], arguments: list[str], code: int, says: str
) -> None:
    found, _, err = run(capsys, "simulate", *arguments)
    assert found == code
    assert says in err
    assert "Traceback" not in err


def test_a_wrong_rig_file_is_refused(capsys: pytest.CaptureFixture[str], rig_file: Path) -> None:
    rig_file.write_text(rig_file.read_text().replace("mass_kg = 0.470878", "mass_kg = -0.470878"))
    code, _, err = run(capsys, "simulate", "--rig", str(rig_file))
    assert code == 3
    assert "mass_kg" in err


@pytest.mark.parametrize("arguments", [[], ["simulate"]])
def test_every_help_has_an_example(
    capsys: pytest.CaptureFixture[str], arguments: list[str]
) -> None:
    code, out, _ = run(capsys, *arguments, "--help")
    assert code == 0
    assert "Example: model simulate" in out
