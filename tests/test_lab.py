"""The first command on a fresh machine: which Python `./lab` makes its environment with."""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
SHIM = "#!/bin/sh\necho 'pyenv: command not found' >&2\nexit 127\n"
"""What a version manager puts on the path for a version that it has not got."""


def _lab(tmp_path: Path, **commands: str) -> subprocess.CompletedProcess[str]:
    """Run `./lab true` in a fresh folder, on a path that has these commands and no uv."""
    for name in ("lab", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path)
    path = tmp_path / "path"
    path.mkdir()
    for name in ("sh", "dirname", "cat", "cksum", "sed", "rm"):
        found = shutil.which(name)
        assert found is not None
        (path / name).symlink_to(found)
    for name, text in commands.items():
        (path / name).write_text(text)
        (path / name).chmod(0o755)
    command = [str(tmp_path / "lab"), "true"]
    return subprocess.run(
        command, env={"PATH": str(path)}, capture_output=True, text=True, check=False
    )


def test_a_shim_without_its_python_is_passed_over(tmp_path: Path) -> None:
    works = f'#!/bin/sh\n[ "$1" = -m ] && exit 1\nexec {sys.executable} "$@"\n'
    found = _lab(tmp_path, **{"python3.13": SHIM, "python3.12": SHIM, "python3.11": works})
    assert found.returncode == 4
    assert "error: python3.11 cannot make a virtual environment" in found.stderr


def test_without_python_it_says_what_to_install(tmp_path: Path) -> None:
    found = _lab(tmp_path, **{"python3.13": SHIM, "python3": SHIM})
    assert found.returncode == 4
    assert "error: no Python 3.11 or later found" in found.stderr
    assert "apt-get install python3" in found.stderr
