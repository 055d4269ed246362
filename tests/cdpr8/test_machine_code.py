"""What several processes want compiled, one of them compiles."""

import subprocess
import sys
from pathlib import Path

import pytest

WANTS = """
import sys
from pathlib import Path
from cdpr8.machine_code import kept

def half(value):
    return 0.5 * value

half = kept(half, Path(sys.argv[1]))
print("ready", flush=True)
sys.stdin.readline()
assert half(3.0) == 1.5
print(sum(half.stats.cache_misses.values()), sum(half.stats.cache_hits.values()))
"""


def test_one_of_three_processes_compiles_and_the_others_load(tmp_path: Path) -> None:
    script = tmp_path / "wants.py"
    script.write_text(WANTS)
    folder = tmp_path / "kept"
    folder.mkdir()
    three = [
        subprocess.Popen(
            [sys.executable, str(script), str(folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )
        for _ in range(3)
    ]  # fmt: skip
    for one in three:
        assert one.stdout is not None
        assert one.stdout.readline() == "ready\n"
    for one in three:
        assert one.stdin is not None
        one.stdin.write("\n")
        one.stdin.flush()
    said = sorted(one.communicate(timeout=60)[0].split() for one in three)
    assert said == [["0", "1"], ["0", "1"], ["1", "0"]]


def test_one_that_hangs_is_not_waited_for_for_ever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from filelock import FileLock

    from cdpr8 import machine_code

    def half(value: float) -> float:
        return 0.5 * value

    monkeypatch.setattr(machine_code, "PATIENCE_S", 0.1)
    made = machine_code.kept(half, tmp_path)
    with FileLock(tmp_path / f"{half.__module__}.half.lock"):
        assert made(3.0) == 1.5


def test_what_cannot_be_compiled_leaves_no_lock(tmp_path: Path) -> None:
    from numba.core.errors import TypingError

    from cdpr8.machine_code import kept

    def bad(value: float) -> float:
        return value + nowhere  # type: ignore[name-defined]  # noqa: F821

    made = kept(bad, tmp_path)
    for _ in range(2):
        with pytest.raises(TypingError):
            made(1.0)
