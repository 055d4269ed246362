"""Imports stay light, and the disk cache can never serve another kernel."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import ActiveEffect, compiled, simulate


def test_the_package_and_its_command_start_without_the_heavy_libraries() -> None:
    code = (
        "import sys, model, model.command\n"
        "heavy = {'numba', 'numpy', 'scipy', 'pandas', 'matplotlib', 'pydantic'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert answer.stdout.strip() == "[]"


def test_compiling_is_announced_where_nothing_is_cached(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    monkeypatch.setattr(compiled, "compiled", lambda name: None)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    compiled.integrator(said.append)
    assert said == [compiled.COMPILING]
    (compiled.cache_folder() / "runge_kutta.integrate-1.nbc").touch()
    compiled.integrator(said.append)
    assert len(said) == 1


def test_a_change_of_any_compiled_source_asks_for_another_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from model import cable

    before = compiled.fingerprint()
    changed = tmp_path / "cable.py"
    changed.write_text(Path(str(cable.__file__)).read_text().replace("4.0", "5.0"))
    monkeypatch.setattr(cable, "__file__", str(changed))
    assert compiled.fingerprint() != before


def test_a_read_only_home_costs_the_cache_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked = tmp_path / "a file where the folder should be"
    blocked.write_text("")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked))
    assert compiled.cache_folder() is None


def test_one_process_serves_each_configuration_its_own_kernel(rig: Rig) -> None:
    motion = Excitation(rest_s=0.0, motion_s=0.3, ramp_s=0.1)
    damped = [ActiveEffect("cable_viscous")]
    with_state = [ActiveEffect("cable_relaxation")]
    configurations = [
        {"effects": ()},
        {"effects": damped},
        {"effects": with_state},
        {"effects": (), "drive": "winch"},
        {"effects": damped, "drive": "winch"},
    ]
    first = [simulate(rig, motion, **how).tension_n for how in configurations]
    # The other way round, after all of them are compiled: nobody gets what another asked for.
    again = [simulate(rig, motion, **how).tension_n for how in reversed(configurations)]
    for one, other in zip(first, reversed(again), strict=True):
        assert np.array_equal(one, other)
    for number, one in enumerate(first):
        for other in first[:number]:
            assert np.abs(one - other).max() > 1e-6


def test_another_lane_width_asks_for_another_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from model.library import lanes

    before = compiled.fingerprint()
    changed = tmp_path / "lanes.py"
    text = Path(str(lanes.__file__)).read_text()
    assert "LANES = 16" in text
    changed.write_text(text.replace("LANES = 16", "LANES = 32"))
    monkeypatch.setattr(lanes, "__file__", str(changed))
    assert compiled.fingerprint() != before
