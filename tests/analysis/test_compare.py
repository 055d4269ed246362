"""`analysis compare`: the paper's Section 5 on runs whose truth is known."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from analysis.command import app
from analysis.compare import Comparison, compare
from analysis.comparison_table import as_dictionary, verdict
from analysis.tracking import poses_of
from cdpr8.errors import DataError
from cdpr8.rigfile import Excitation, load_rig
from cdpr8.runfolder import Run
from cdpr8.terminal import run_app
from rig.simulated.plant import PlatformTrajectory

MakeRun = Callable[..., Run]


@pytest.fixture(scope="module")
def clean(
    make_run_in: MakeRun,
    frictionless: PlatformTrajectory,
    tmp_path_factory: pytest.TempPathFactory,
) -> Run:
    """Only read."""
    return make_run_in(tmp_path_factory.mktemp("clean"), frictionless)


@pytest.fixture(scope="module")
def of_clean(clean: Run) -> Comparison:
    return compare(clean, poses_of(clean))


@pytest.fixture(scope="module")
def of_rubbing(
    make_run_in: MakeRun, rubbing: PlatformTrajectory, tmp_path_factory: pytest.TempPathFactory
) -> Comparison:
    run = make_run_in(tmp_path_factory.mktemp("rubbing"), rubbing)
    return compare(run, poses_of(run))


def test_a_machine_like_the_model_differs_by_no_more_than_noise(of_clean: Comparison) -> None:
    comparison = of_clean
    assert [q.measured.name for q in comparison.quantities if q.exceeds_noise] == []
    assert verdict(comparison).startswith("No difference exceeds")
    assert all(q.relative_error < 0.01 for q in comparison.quantities)


def test_friction_is_a_difference_beyond_noise(
    of_rubbing: Comparison, rubbing: PlatformTrajectory
) -> None:
    comparison = of_rubbing
    assert comparison.angle.exceeds_noise
    truth = np.abs(np.rad2deg(rubbing.pose[:, 4])).max()
    assert comparison.angle.measured_amplitude == pytest.approx(truth, abs=0.02)
    assert comparison.angle.relative_error == pytest.approx(
        abs(comparison.angle.difference) / comparison.angle.measured_amplitude
    )


def test_noise_is_taken_from_rest(of_clean: Comparison) -> None:
    assert of_clean.angle.measured.noise_known
    assert of_clean.angle.measured.noise == pytest.approx(0.004, rel=0.5)
    assert of_clean.tensions[3].measured.noise == pytest.approx(0.005, rel=0.25)


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


def test_stiffness_from_the_same_run_is_warned_about(clean: Run) -> None:
    rig = load_rig()
    fitted = rig.cable[2].stiffness_n_per_m.model_copy(
        update={"source": "analysis stiffness test-7"}
    )
    cables = list(rig.cable)
    cables[2] = cables[2].model_copy(update={"stiffness_n_per_m": fitted})
    changed = rig.model_copy(update={"cable": tuple(cables)})
    warnings = compare(clean, poses_of(clean), changed).warnings
    assert any("cable 3 was fitted to this same run" in warning for warning in warnings)


def test_another_rig_moves_the_plant_and_not_the_drive(clean: Run, of_clean: Comparison) -> None:
    stiffer = clean.rig.model_copy(
        update={
            "cable": tuple(
                cable.model_copy(
                    update={
                        "stiffness_n_per_m": cable.stiffness_n_per_m.model_copy(
                            update={"value": 1.1 * cable.stiffness_n_per_m.value}
                        )
                    }
                )
                for cable in clean.rig.cable
            )
        }
    )
    comparison = compare(clean, poses_of(clean), stiffer)
    # A drive made anew for the stiffer plant would bring the same amplitude back.
    ratio = comparison.angle.simulated_sine.amplitude / of_clean.angle.simulated_sine.amplitude
    assert ratio == pytest.approx(1 / 1.1, rel=0.03)


def test_the_command_writes_json_and_figures(
    clean: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(clean.folder, tmp_path / "run")
    assert run_app(app, ["compare", str(tmp_path / "run"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    written = json.loads((tmp_path / "run" / "results" / "compare.json").read_text())
    assert told == written
    assert set(told["tension"]) == {str(c) for c in range(1, 9)}
    for ending in ("svg", "png"):
        figures = sorted((tmp_path / "run" / "results").glob(f"*.{ending}"))
        assert [path.stem for path in figures] == [
            "compare_all",
            "compare_pitch",
            "compare_spectra",
            "compare_tension_1",
            "compare_tension_7",
        ]
        assert all(path.stat().st_size > 5000 for path in figures)


def test_a_missing_run_is_bad_data(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["compare", "no_such_run"]) == 3
    assert "no run 'no_such_run'" in capsys.readouterr().err


def test_the_dictionary_says_what_the_comparison_says(of_rubbing: Comparison) -> None:
    dictionary = as_dictionary(of_rubbing)
    assert dictionary["angle"]["relative_error_percent"] == pytest.approx(
        100 * of_rubbing.angle.relative_error
    )
