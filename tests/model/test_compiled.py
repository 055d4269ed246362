"""Imports stay light, and the disk cache can never serve another kernel."""

import subprocess
import sys
from pathlib import Path

import pytest

from model import compiled


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
    (compiled.cache_folder() / "kernel.integrate-1.nbc").touch()
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
