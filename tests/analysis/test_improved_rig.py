"""`improved.toml`: numbers where the fit has them, whatever it has made of them."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analysis.diagnosis.improve import write_improved
from analysis.diagnosis.nuisances import Meaning
from analysis.diagnosis.trim import Trim
from analysis.engine.system import Nuisance, Point
from cdpr8.errors import RigFileError
from cdpr8.rigfile import load_rig, packaged_rig_path
from model import simulate

PRETENSIONS = tuple(Meaning("pretension", "pretension_offset_n", cable) for cable in range(1, 9))


def moved(
    tmp_path: Path,
    offsets_n: list[float],
    mass_share: float,
    stiffness_share: float = 0.0,
    of: tuple[Meaning, ...] = PRETENSIONS,
) -> Path:
    """An improved rig file of pretensions, a mass and cable 8's stiffness that a fit has moved."""
    text = packaged_rig_path().read_text(encoding="utf-8")
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    run = SimpleNamespace(folder=tmp_path, name="run01")
    rig = load_rig(tmp_path / "rig.toml")
    stiffness = Meaning("stiffness", "stiffness_share", 8)
    meanings = (*of, Meaning("mass", "mass_share"), stiffness)
    nuisances = [Nuisance(one.effect, 1.0, "") for one in meanings]
    machine: Any = SimpleNamespace(
        recordings=[SimpleNamespace(run=run, rig=rig)],
        nuisances=nuisances,
        meanings=meanings,
        trim=Trim(meanings, nuisances, lambda *_: np.zeros(8)),
    )
    found = SimpleNamespace(nuisance=np.array([*offsets_n, mass_share, stiffness_share]))
    chosen = SimpleNamespace(weighed=found, point=Point(found.nuisance))
    judgement = SimpleNamespace(causes=(), chosen=chosen)
    diagnosis: Any = SimpleNamespace(
        judgement=judgement, calibrated=SimpleNamespace(rotation=np.eye(len(meanings)))
    )
    return write_improved(machine, diagnosis, tmp_path / "improved.toml")


def test_pretensions_that_carry_the_weight_are_numbers_of_the_rig_file(tmp_path: Path) -> None:
    before = load_rig()
    rig = load_rig(moved(tmp_path, [1e-3] * 8, 0.0))
    assert rig.cable[0].pretension_n.value == pytest.approx(
        before.cable[0].pretension_n.value + 1e-3
    )
    assert not rig.physics


def test_what_is_off_in_all_runs_and_in_the_first_is_in_its_rig_file(tmp_path: Path) -> None:
    every = tuple(replace(one, record=-1) for one in PRETENSIONS)
    runs = tuple(replace(one, record=run) for run in (0, 1) for one in PRETENSIONS)
    rig = load_rig(moved(tmp_path, [1e-3] * 8 + [2e-3] * 8 + [5e-3] * 8, 0.0, of=(*every, *runs)))
    assert rig.cable[0].pretension_n.value == pytest.approx(
        load_rig().cable[0].pretension_n.value + 3e-3
    )


def test_strings_are_numbers_of_the_rig_file(tmp_path: Path) -> None:
    strings = (Meaning("string", "density_share", 2), Meaning("string", "loss_share", 3))
    rig, before = load_rig(moved(tmp_path, [0.07, -1.5], 0.0, of=strings)), load_rig()
    cable, was = rig.cable[1].line_density_kg_per_m, before.cable[1].line_density_kg_per_m
    assert cable.value == pytest.approx(1.07 * was.value)
    # A fit may stray to less than none.
    assert 0.0 < rig.cable[2].damping_1_per_s.value < 0.1 * before.cable[2].damping_1_per_s.value


def test_pretensions_that_carry_no_weight_are_what_was_simulated(tmp_path: Path) -> None:
    before, offsets = load_rig(), [3.0, 0.0, -1.0, 0.0, 2.0, 0.0, 0.0, 0.0]
    rig = load_rig(moved(tmp_path, offsets, 0.2))
    assert rig.cable[0].pretension_n.value == before.cable[0].pretension_n.value
    assert rig.physics["pretension"]["pretension_offset_n"] == offsets
    assert rig.physics["mass"]["mass_share"] == 0.2
    # It is a machine: it comes to rest elsewhere, and moves.
    assert np.isfinite(simulate(rig).tension_n).all()


def test_numbers_that_no_rig_file_may_hold_leave_none(tmp_path: Path) -> None:
    with pytest.raises(RigFileError, match="stiffness_n_per_m: value -"):
        moved(tmp_path, [0.0] * 8, 0.0, -1.03)
    assert not (tmp_path / "improved.toml").exists()
