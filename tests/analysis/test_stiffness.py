"""`analysis stiffness` on runs whose stiffnesses are known."""

import json
from pathlib import Path

import numpy as np
import pytest
from recorded_by import STILL, by_model, by_plant

from analysis.command import app
from analysis.compare import compare
from analysis.stiffness import Stiffnesses, stiffnesses
from analysis.stiffness_file import write_rig
from cdpr8.errors import DataError
from cdpr8.rigfile import Excitation, load_rig
from cdpr8.terminal import run_app
from model import ActiveEffect

SLOW = Excitation(motion_s=8.0, **STILL)


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> Stiffnesses:
    folder = tmp_path_factory.mktemp("runs") / "clean"
    return stiffnesses([by_plant(folder, 3, SLOW, off=False)[0]])


def test_a_clean_run_gives_the_rigs_values_within_their_sigma(clean: Stiffnesses) -> None:
    assert len(clean.cables) == 8
    for one in clean.cables:
        assert one.told
        assert abs(one.value - one.rig_value) < 3.5 * one.parts["noise"]
        assert abs(one.value - one.rig_value) < one.sigma
        assert 0.005 < one.sigma / one.value < 0.05
    assert not any(text.startswith(("cable", "all tensions")) for text in clean.warnings)


def test_the_sigma_holds_noise_geometry_calibration_and_timing(clean: Stiffnesses) -> None:
    for one in clean.cables:
        assert one.sigma == pytest.approx(np.linalg.norm(list(one.parts.values())))
        assert all(part > 0.0 for part in one.parts.values())


def test_the_rig_file_names_the_run_so_that_compare_warns(
    clean: Stiffnesses, tmp_path: Path
) -> None:
    run = clean.recordings[0].run
    rig = load_rig(write_rig(clean, run.folder / "rig.toml", tmp_path / "stiffness.toml"))
    for one, cable in zip(clean.cables, rig.cable, strict=True):
        row = cable.stiffness_n_per_m
        assert row.value == pytest.approx(one.value, abs=1e-3)
        assert row.sigma == pytest.approx(one.sigma, abs=1e-3)
        assert row.source.startswith(f"analysis stiffness {run.name}")
    found = compare(run, run.pose, rig)
    assert any("fitted to this same run" in text for text in found.warnings)


@pytest.mark.long
def test_a_true_machine_off_by_its_sigmas_is_within_the_stated_sigma(tmp_path: Path) -> None:
    assert _rms(_off(tmp_path, range(3))) < 1.6


@pytest.mark.slow
def test_the_stated_sigma_is_calibrated(tmp_path: Path) -> None:
    off = _off(tmp_path, range(20))
    assert 0.75 < _rms(off) < 1.15
    assert np.mean(np.abs(off) > 2.0) < 0.10
    noise = _off(tmp_path / "noise", range(20), off=False)
    assert 0.85 < _rms(noise) < 1.15


def _off(folder: Path, seeds: range, *, off: bool = True) -> np.ndarray:
    """Distances from the true stiffnesses, in sigmas: of all, or of the noise alone."""
    found = []
    for seed in seeds:
        changes = {
            "axis": ("pitch", "roll", "yaw")[seed % 3],
            "frequency_hz": (2.06, 1.0)[seed % 2],
        }
        excitation = SLOW.model_copy(update=changes)
        run, offset = by_plant(folder / f"run{seed}", seed, excitation, off=off)
        for one in stiffnesses([run]).cables:
            true = one.rig_value * (1.0 + offset.stiffness_share[one.cable - 1])
            if one.told:
                found.append((one.value - true) / (one.sigma if off else one.parts["noise"]))
    return np.array(found)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_friction_is_told_with_its_force(tmp_path: Path) -> None:
    forces = (0.3, 0.3, 0, 0, 0, 0, 0, 0)
    rubbing = ActiveEffect("pulley_coulomb", {"coulomb_n": forces, "presliding_m": 2e-5})
    found = stiffnesses([by_model(tmp_path / "run", [rubbing], SLOW)])
    assert [one.cable for one in found.cables if one.bias.rubs] == [1, 2]
    for one in found.cables[:2]:
        assert one.bias.friction_n == pytest.approx(0.3, abs=0.05)
        assert one.bias.quadrature_n == pytest.approx(4 * 0.3 / np.pi, abs=0.03)
    assert any(text.startswith("cable 1, 2: friction") for text in found.warnings)


def test_a_late_camera_is_told_as_one_lag_of_all(tmp_path: Path) -> None:
    late = ActiveEffect("camera_latency", {"latency_s": 0.02})
    found = stiffnesses([by_model(tmp_path / "run", [late], SLOW)])
    assert found.lag_s == pytest.approx(0.02, abs=1e-3)
    assert any("alike" in text and "read low by 3" in text for text in found.warnings)
    assert not any(one.bias.rubs for one in found.cables)


@pytest.mark.long
def test_runs_of_two_rates_tell_friction_from_damping(tmp_path: Path) -> None:
    effects = [ActiveEffect("cable_viscous", {"viscous_n_s_per_m": 4.0})]
    quick = SLOW.model_copy(update={"frequency_hz": 3.5})
    runs = [by_model(tmp_path / "a", effects, SLOW), by_model(tmp_path / "b", effects, quick)]
    for one in stiffnesses(runs).cables:
        assert one.bias.viscous_n_s_per_m == pytest.approx(4.0, rel=0.15)
        assert abs(one.bias.constant_n or 0.0) < 0.05


def test_a_cable_that_hardly_moves_keeps_its_value(tmp_path: Path) -> None:
    found = stiffnesses([by_model(tmp_path / "run", [], SLOW.model_copy(update={"axis": "yaw"}))])
    still = [one for one in found.cables if not one.told]
    assert {3, 4} <= {one.cable for one in still}
    assert any("moves too little" in text for text in found.warnings)
    own = found.recordings[0].run.folder / "rig.toml"
    rig = load_rig(write_rig(found, own, tmp_path / "stiffness.toml"))
    for one in still:
        row = rig.cable[one.cable - 1].stiffness_n_per_m
        assert (row.value, row.sigma) == (one.rig_value, one.rig_sigma)


def test_a_run_without_motion_or_too_quick_for_its_camera_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="no steady motion"):
        stiffnesses(
            [by_model(tmp_path / "still", [], SLOW.model_copy(update={"amplitude_deg": 0.0}))]
        )
    with pytest.raises(DataError, match="poses a second"):
        stiffnesses(
            [by_model(tmp_path / "quick", [], SLOW.model_copy(update={"frequency_hz": 9.0}))]
        )


def test_the_command_writes_the_file_and_strict_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    by_model(tmp_path / "slow", [], SLOW)
    assert run_app(app, ["stiffness", str(tmp_path / "slow"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert set(said["cables"]) == {str(i) for i in range(1, 9)}
    assert load_rig(tmp_path / "slow" / "results" / "stiffness.toml").cable
    assert run_app(app, ["stiffness", str(tmp_path / "slow")]) == 0
    assert "cable stiffnesses" in capsys.readouterr().out
