import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig
from cdpr8.terminal import run_app
from model import simulate
from model.command import app
from model.jobs import Job
from model.summary import summarise
from model.sweep import Plan, by_frequency, sweep
from model.sweep.amplitudes import AMPLITUDES, start
from model.sweep.figures import cable_figure, platform_figure
from model.sweep.paper import EXCITATION, FREQUENCIES_HZ, Runs
from model.sweep.plan import grid
from model.sweep.report import Line, compare
from model.sweep.statistics import median_by_step, table

BRIEF = Excitation(rest_s=0.1, motion_s=1.0, ramp_s=0.2)


def test_a_row_holds_the_amplitudes_of_its_simulation(rig: Rig) -> None:
    (_, row), *_ = sweep(rig, Plan(BRIEF, (9.0,)))
    run = simulate(rig, BRIEF.model_copy(update={"frequency_hz": 9.0}))
    summary = summarise(run)
    deviation = (run.pose - run.commanded_pose)[run.steady]
    assert summary is not None
    assert row["max_pitch_deg"] == pytest.approx(summary.max_pitch_deg, rel=1e-8)
    assert row["rotation_deg"] == pytest.approx(summary.rotation_deg, rel=1e-8)
    assert row["cable_mm"] == pytest.approx(max(summary.cable_amplitude_mm), rel=1e-8)
    assert row["tension_7_n"] == pytest.approx(summary.tension_variation_n[6], rel=1e-8)
    assert row["displacement_mm"] == pytest.approx(1e3 * np.abs(deviation[:, :3]).max(), rel=1e-8)
    assert row["displacement_mm"] <= row["distance_mm"]
    assert row["status"] == "ok"


def test_amplitudes_are_of_the_deviation_and_not_of_the_motion(rig: Rig) -> None:
    (_, row), *_ = sweep(rig, Plan(BRIEF, (4.0,)))
    assert row["max_pitch_deg"] > 1.9
    assert row["rotation_deg"] < 0.1


def test_repetitions_change_offsets_and_step_a_little_and_the_first_changes_nothing(
    rig: Rig,
) -> None:
    plan = Plan(BRIEF, (4.0,), repetitions=4, spread=0.1, seed=5)
    rows = table(sweep(rig, plan))
    assert rows["repetition"].tolist() == [0, 1, 2, 3]
    # Half the step or less: steps meet whole rows, 3 ms gives way to 1 ms.
    steps = rows["step_s"].to_numpy()
    assert steps[0] == steps[2] >= 2.0 * steps[1] > 0
    assert steps[1] == steps[3]
    own, changed = (start(plan, k, Job(k, {}, 5).generator()) for k in (0, 2))
    assert own.cable_offset_m == BRIEF.cable_offset_m
    share = np.array(changed.cable_offset_m) / BRIEF.cable_offset_m
    assert len(set(share)) == 8
    assert np.abs(share - 1).max() <= 0.1
    assert changed.platform_offset_m[1:] == (0.0, 0.0)
    assert changed.platform_offset_m[0] != own.platform_offset_m[0]


def test_runs_that_fail_are_rows_with_a_status_and_are_counted_not_averaged(rig: Rig) -> None:
    cable = rig.cable[2]
    gaining = cable.damping_1_per_s.model_copy(update={"value": -300.0})
    faulty = rig.model_copy(
        update={
            "cable": (
                *rig.cable[:2],
                cable.model_copy(update={"damping_1_per_s": gaining}),
                *rig.cable[3:],
            )
        }
    )
    rows = table(sweep(faulty, Plan(BRIEF, (3.0, 4.0))))
    assert rows["status"].tolist() == ["blow_up", "blow_up"]
    assert (rows["what"] != "").all()
    assert (rows["when_s"] > BRIEF.rest_s).all()
    assert rows[list(AMPLITUDES)].isna().all(axis=None)
    statistics = by_frequency(rows)
    assert statistics["blow_up"].tolist() == [1, 1]
    assert statistics["cable_mm_median"].isna().all()


def test_a_slack_cable_is_a_status_with_its_amplitudes(rig: Rig) -> None:
    far = BRIEF.model_copy(update={"amplitude_deg": 6.0})
    rows = table(sweep(rig, Plan(far, (2.06,))))
    assert rows["status"].tolist() == ["slack"]
    assert rows["min_tension_n"].tolist() == [0.0]
    assert rows["max_pitch_deg"].iloc[0] > 5.0


def test_statistics_are_median_and_range_by_frequency() -> None:
    values = {2.0: [1.0, 5.0, 3.0], 1.0: [7.0, 9.0, 8.0]}
    rows = [
        (
            number,
            {"frequency_hz": frequency, "repetition": k, "status": "ok"}
            | dict.fromkeys(AMPLITUDES, value),
        )
        for number, (frequency, k, value) in enumerate(
            (frequency, k, value)
            for frequency, several in values.items()
            for k, value in enumerate(several)
        )
    ]
    found = by_frequency(table(rows[::-1]))
    assert found["frequency_hz"].tolist() == [1.0, 2.0]
    assert found["cable_3_mm"].tolist() == [7.0, 1.0]
    assert found["cable_3_mm_median"].tolist() == [8.0, 3.0]
    assert found["cable_3_mm_low"].tolist() == [7.0, 1.0]
    assert found["cable_3_mm_high"].tolist() == [9.0, 5.0]
    assert found["ok"].tolist() == [3, 3]


def test_the_step_is_judged_by_the_medians_with_and_without_halving() -> None:
    runs = pd.DataFrame(
        {
            "frequency_hz": [10.0] * 6 + [14.0],
            "repetition": [0, 1, 2, 3, 4, 5, 0],
            "cable_mm": [1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 99.0],
        }
    )
    assert median_by_step(runs, 10.0, "cable_mm") == (2.0, 20.0)


@pytest.mark.parametrize(
    "wrong",
    [{"frequencies_hz": ()}, {"repetitions": 0}, {"spread": 1.0}, {"frequencies_hz": (0.0,)}],
)
def test_a_plan_that_cannot_be_is_refused(wrong: dict) -> None:
    with pytest.raises(UsageError):
        Plan(**({"excitation": BRIEF, "frequencies_hz": (2.0,)} | wrong))


def test_a_grid_has_its_ends_and_even_steps() -> None:
    assert grid(2.0, 3.0, 5) == (2.0, 2.25, 2.5, 2.75, 3.0)
    assert {10.0, 14.0, 2.06, 20.0} <= set(FREQUENCIES_HZ)
    for ends in ((3.0, 2.0, 5), (0.0, 2.0, 5), (1.0, 2.0, 1)):
        with pytest.raises(UsageError, match="Hz"):
            grid(*ends)


@pytest.fixture(scope="module")
def published_statistics() -> pd.DataFrame:
    """A machine that gives every published figure and is still elsewhere."""
    values = {
        "displacement_mm": (0.1, 33.10, 32.19),
        "rotation_deg": (0.03, 5.04, 7.76),
        "max_pitch_deg": (2.03, 5.0, 7.80),
        "cable_mm": (0.1, 95.87, 127.30),
        "cable_5_mm": (0.1, 90.0, 90.0),
        "tension_1_n": (7.61, 8.0, 8.0),
        "tension_7_n": (6.25, 8.0, 8.0),
    }
    columns: dict[str, object] = {"frequency_hz": FREQUENCIES_HZ, "runs": 3, "ok": 3}
    for name in AMPLITUDES:
        quiet, *peaks = values.get(name, (0.1, 50.0, 60.0))
        at_peak = dict(zip((10.0, 14.0), peaks, strict=True))
        column = [at_peak.get(frequency, quiet) for frequency in FREQUENCIES_HZ]
        columns |= {name + suffix: column for suffix in ("", "_median", "_low", "_high")}
    return pd.DataFrame(columns | {"slack": 0, "blow_up": 0})


@pytest.fixture(scope="module")
def still_runs(rig: Rig) -> Runs:
    return Runs({}, {2.06: simulate(rig, EXCITATION, excitation_effect=False)})


def lines_of(statistics: pd.DataFrame, runs: Runs) -> dict[str, Line]:
    return {line.what: line for line in compare(statistics, runs)}


def test_the_page_calls_met_what_is_as_published(
    published_statistics: pd.DataFrame, still_runs: Runs
) -> None:
    lines = lines_of(published_statistics, still_runs)
    assert all(line.met for line in lines.values())
    assert lines["largest cable amplitude at 14 Hz, mm"].ratio == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("column", "frequency_hz", "value", "what"),
    [
        ("cable_mm_median", 14.0, 150.0, "largest cable amplitude at 14 Hz, mm"),
        ("rotation_deg_median", 10.0, 4.5, "rotation at 10 Hz, deg"),
        ("cable_mm_median", 5.25, 25.0, "largest cable amplitude, 2.06 Hz to below 8 Hz, mm"),
        ("displacement_mm_median", 18.0, 3.0, "displacement, 17 to 20 Hz, mm"),
        ("tension_1_n", 2.06, 7.62, "max \\|T_1 - T_01\\| at 2.06 Hz, N"),
        ("cable_5_mm_median", 10.0, 0.5, "amplitude of cable 5 at 10 Hz, mm"),
    ],
)
def test_the_page_says_plainly_what_is_missed(
    published_statistics: pd.DataFrame,
    still_runs: Runs,
    column: str,
    frequency_hz: float,
    value: float,
    what: str,
) -> None:
    changed = published_statistics.copy()
    changed.loc[changed["frequency_hz"] == frequency_hz, column] = value
    missed = [line.what for line in compare(changed, still_runs) if not line.met]
    assert missed == [what]


def test_the_figures_show_the_medians(published_statistics: pd.DataFrame) -> None:
    platform = platform_figure(published_statistics, {"displacement_mm": [(10.0, 33.1)]})
    line = platform.axes[0].lines[0]
    assert line.get_ydata() == pytest.approx(published_statistics["displacement_mm_median"])
    cables = cable_figure(published_statistics, {})
    labels = [text.get_text() for axis in cables.axes for text in axis.get_legend().get_texts()]
    assert labels == [f"cable {number}" for number in (1, 2, 6, 7, 3, 4, 5, 8)]


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run_app(app, ["sweep", *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_the_command_writes_tables_and_figures_and_goes_on_when_asked_again(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    ask = ["--from", "3", "--to", "4", "--points", "3", "--motion", "1.2", "--repetitions", "2"]
    ask += ["--out", str(tmp_path)]
    code, out, _ = run(capsys, *ask)
    first = (tmp_path / "runs.csv").read_bytes()
    written = sorted(path.name for path in tmp_path.iterdir())
    assert code == 0
    assert "3.5" in out
    assert written == [
        "amplitudes.csv", "runs.csv", "runs.jsonl", "sweep_fig4.png", "sweep_fig5.png"
    ]  # fmt: skip
    rows = (tmp_path / "runs.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "runs.jsonl").write_text("".join(rows[:3]) + rows[3][:20])
    again, out, _ = run(capsys, *ask, "--figures", "none", "--json")
    answer = json.loads(out)
    assert again == 0
    assert (tmp_path / "runs.csv").read_bytes() == first
    assert [row["frequency_hz"] for row in answer["frequencies"]] == [3.0, 3.5, 4.0]
    assert answer["plan"]["seed"] == 0
    other, _, err = run(capsys, *ask, "--seed", "1")
    assert other == 3
    assert "seed 0, here 1" in err


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["--from", "5", "--to", "2"], 2, "0 < first"),
        (["--amplitude", "-1"], 2, "amplitude_deg -1.0"),
        (["--paper", "--points", "3"], 2, "own frequencies"),
        (["--report", "page.md"], 2, "with --paper"),
        (["--rig", "nowhere.toml"], 3, "nowhere.toml"),
        (["--workers", "0"], 2, "at least 1 worker"),
        (["--scheduler", "nonsense://x"], 2, "tcp://host:8786"),
    ],
)
def test_a_bad_input_gets_one_message(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    arguments: list[str],
    code: int,
    says: str,
) -> None:
    found, _, err = run(capsys, *arguments, "--out", str(tmp_path))
    assert found == code
    assert says in err
    assert "Traceback" not in err


@pytest.mark.slow
def test_the_papers_section_4_in_one_command(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code, _, _ = run(capsys, "--paper", "--repetitions", "2", "--out", str(tmp_path))
    page = (tmp_path / "paper.md").read_text()
    assert code == 0
    for number in range(4, 10):
        assert f"figures/paper_fig{number}.png" in page
        assert (tmp_path / "figures" / f"paper_fig{number}.png").stat().st_size > 5000
    met = next(
        line for line in page.splitlines() if line.startswith("| max \\|pitch\\| at 2.06 Hz,")
    )
    assert "| 2.03 | 2.03 |" in met
