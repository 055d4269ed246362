"""`analysis compare`: the paper's Section 5 on runs whose truth is known."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from analysis.command import app
from analysis.compare import compare
from analysis.comparison_figures import write_figures
from analysis.comparison_table import as_dictionary, verdict
from analysis.tracking import poses_of
from cdpr8.errors import DataError
from cdpr8.rigfile import Excitation, load_rig
from cdpr8.runfolder import Run
from cdpr8.terminal import run_app
from rig.simulated.plant import PlatformTrajectory

MakeRun = Callable[..., Run]


def test_a_machine_like_the_model_differs_by_no_more_than_noise(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    run = make_run(frictionless)
    comparison = compare(run, poses_of(run))
    assert [q.measured.name for q in comparison.quantities if q.exceeds_noise] == []
    assert verdict(comparison).startswith("No difference exceeds")
    assert all(q.relative_error < 0.01 for q in comparison.quantities)


def test_friction_is_a_difference_beyond_noise(
    make_run: MakeRun, rubbing: PlatformTrajectory
) -> None:
    run = make_run(rubbing)
    comparison = compare(run, poses_of(run))
    assert comparison.angle.exceeds_noise
    truth = np.abs(np.rad2deg(rubbing.pose[:, 4])).max()
    assert comparison.angle.measured_amplitude == pytest.approx(truth, abs=0.02)
    assert comparison.angle.relative_error == pytest.approx(
        abs(comparison.angle.difference) / comparison.angle.measured_amplitude
    )


def test_noise_is_taken_from_rest(make_run: MakeRun, frictionless: PlatformTrajectory) -> None:
    run = make_run(frictionless)
    comparison = compare(run, poses_of(run))
    assert comparison.angle.measured.noise_known
    assert comparison.angle.measured.noise == pytest.approx(0.004, rel=0.5)
    assert comparison.tensions[3].measured.noise == pytest.approx(0.005, rel=0.25)


def test_an_unknown_start_is_found(make_run: MakeRun, frictionless: PlatformTrajectory) -> None:
    run = make_run(frictionless, start_known=False, moved_s=0.7365)
    comparison = compare(run, poses_of(run))
    assert comparison.start_shift_s == pytest.approx(0.7365, abs=0.002)
    assert any("found from cable" in warning for warning in comparison.warnings)
    assert abs(comparison.angle.delay_s) < 0.003


def test_a_dead_cable_is_left_out_and_the_others_compared(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    run = make_run(frictionless, cables=(1, 2, 3, 5, 6, 7, 8))
    assert list(compare(run, poses_of(run)).tensions) == [1, 2, 3, 5, 6, 7, 8]


def test_an_interrupted_run_is_used_as_far_as_it_goes(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    run = make_run(frictionless, until_s=5.0)
    comparison = compare(run, poses_of(run))
    assert comparison.window_s[1] < 5.0
    assert comparison.angle.relative_error < 0.01


def test_too_short_a_motion_is_refused(make_run: MakeRun, frictionless: PlatformTrajectory) -> None:
    run = make_run(frictionless, until_s=2.0)
    with pytest.raises(DataError, match="periods of steady motion"):
        compare(run, poses_of(run))


def test_a_run_without_motion_is_refused(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    still = Excitation(motion_s=6.0, amplitude_deg=0.0)
    run = make_run(frictionless, excitation=still)
    with pytest.raises(DataError, match="no motion"):
        compare(run, poses_of(run))


def test_a_run_without_pose_and_video_says_so(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    run = make_run(frictionless, pose=False)
    with pytest.raises(DataError, match=r"neither pose\.csv nor video\.mkv"):
        poses_of(run)


def test_stiffness_from_the_same_run_is_warned_about(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    run = make_run(frictionless)
    rig = load_rig()
    fitted = rig.cable[2].stiffness_n_per_m.model_copy(
        update={"source": "analysis stiffness test-7"}
    )
    cables = list(rig.cable)
    cables[2] = cables[2].model_copy(update={"stiffness_n_per_m": fitted})
    changed = rig.model_copy(update={"cable": tuple(cables)})
    warnings = compare(run, poses_of(run), changed).warnings
    assert any("cable 3 was fitted to this same run" in warning for warning in warnings)


def test_another_rig_moves_the_plant_and_not_the_drive(
    make_run: MakeRun, frictionless: PlatformTrajectory
) -> None:
    run = make_run(frictionless)
    stiffer = run.rig.model_copy(
        update={
            "cable": tuple(
                cable.model_copy(
                    update={
                        "stiffness_n_per_m": cable.stiffness_n_per_m.model_copy(
                            update={"value": 1.1 * cable.stiffness_n_per_m.value}
                        )
                    }
                )
                for cable in run.rig.cable
            )
        }
    )
    comparison = compare(run, poses_of(run), stiffer)
    own = compare(run, poses_of(run))
    # A drive made anew for the stiffer plant would bring the same amplitude back.
    ratio = comparison.angle.simulated_sine.amplitude / own.angle.simulated_sine.amplitude
    assert ratio == pytest.approx(1 / 1.1, rel=0.03)


def test_the_command_writes_json_and_figures(
    make_run: MakeRun,
    tmp_path: Path,
    frictionless: PlatformTrajectory,
    capsys: pytest.CaptureFixture[str],
) -> None:
    make_run(frictionless)
    assert run_app(app, ["compare", str(tmp_path / "run"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    written = json.loads((tmp_path / "run" / "results" / "compare.json").read_text())
    assert told == written
    assert set(told["tension"]) == {str(c) for c in range(1, 9)}
    figures = sorted(path.name for path in (tmp_path / "run" / "results").glob("*.svg"))
    assert figures == [
        "compare_all.svg",
        "compare_pitch.svg",
        "compare_spectra.svg",
        "compare_tension_1.svg",
        "compare_tension_7.svg",
    ]


def test_a_missing_run_is_bad_data(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["compare", "no_such_run"]) == 3
    assert "no run 'no_such_run'" in capsys.readouterr().err


def test_figures_and_dictionary_agree(
    make_run: MakeRun, tmp_path: Path, rubbing: PlatformTrajectory
) -> None:
    run = make_run(rubbing)
    comparison = compare(run, poses_of(run))
    dictionary = as_dictionary(comparison)
    assert dictionary["angle"]["relative_error_percent"] == pytest.approx(
        100 * comparison.angle.relative_error
    )
    assert all(path.stat().st_size > 5000 for path in write_figures(comparison, tmp_path / "out"))
