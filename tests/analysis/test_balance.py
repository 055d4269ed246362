"""The three residuals: which side each thing is seen on."""

from pathlib import Path

import numpy as np
import pytest
from recorded_by import STILL, by_model

from analysis.diagnosis.balance import Balance, balance
from cdpr8.rigfile import Excitation
from cdpr8.rigfile.schema import CellPlace
from model import ActiveEffect

SLOW = Excitation(motion_s=8.0, **STILL)
RUBBING = ActiveEffect("pulley_coulomb", {"coulomb_n": (0.3, 0.3, 0, 0, 0, 0, 0, 0)})


def of(folder: Path, *effects: ActiveEffect, cell: CellPlace = CellPlace.PLATFORM) -> Balance:
    return balance(by_model(folder / "run", list(effects), SLOW, cell=cell))


def test_a_clean_run_balances(tmp_path: Path) -> None:
    found = of(tmp_path)
    assert [one.seen for one in (found.cables, found.platform, found.inner)] == [(), (), ()]
    assert found.cables.series.shape == (8, len(found.phase_s))


def test_friction_behind_the_cell_is_seen_in_its_cables_alone(tmp_path: Path) -> None:
    found = of(tmp_path, RUBBING)
    assert found.cables.seen == ("cable 1", "cable 2")
    assert not found.platform.seen
    assert found.inner.seen
    # 4 F / pi, in quadrature.
    assert np.abs(found.cables.amplitude[:2, 0]) == pytest.approx(4 * 0.3 / np.pi, abs=0.03)


def test_friction_between_cell_and_platform_is_seen_in_the_wrench_alone(tmp_path: Path) -> None:
    found = of(tmp_path, RUBBING, cell=CellPlace.BASE)
    assert not found.cables.seen
    # Cables 1 and 2 mirror each other: along Y, and about X and Z, they cancel.
    assert set(found.platform.seen) == {"force x", "force z", "moment y"}


def test_a_late_camera_is_seen_in_all_cables(tmp_path: Path) -> None:
    found = of(tmp_path, ActiveEffect("camera_latency", {"latency_s": 0.01}))
    assert len(found.cables.seen) == 8


def test_inner_directions_make_no_wrench(tmp_path: Path) -> None:
    found = of(tmp_path)
    assert found.inner_directions.T @ found.inner_directions == pytest.approx(np.eye(2))
