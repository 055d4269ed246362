"""The machine code on disk is of the kernels as they are."""

import ast
import shutil
from pathlib import Path

import pytest

from vision import compiled

VISION = Path(compiled.__file__).parent


def imported(source: Path) -> set[str]:
    """Modules of `vision` that a module imports, as file names."""
    found = ast.walk(ast.parse(source.read_text()))
    names = [each.module or "" for each in found if isinstance(each, ast.ImportFrom)]
    return {f"{name.removeprefix('vision.')}.py" for name in names if name.startswith("vision.")}


def test_the_fingerprint_covers_every_kernel_and_what_it_imports() -> None:
    kernels = {path for path in VISION.glob("*.py") if "compiled.py" in imported(path)}
    assert len(kernels) == 4
    needed = {path.name for path in kernels}.union(*(imported(path) for path in kernels))
    assert needed == set(compiled.SOURCES)


@pytest.mark.parametrize("source", compiled.SOURCES)
def test_a_change_of_any_source_asks_for_another_cache(
    source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    for name in compiled.SOURCES:
        shutil.copy(VISION / name, tmp_path)
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    folder = compiled.cache_folder.__wrapped__
    before = folder()
    (tmp_path / source).write_text((tmp_path / source).read_text() + "\n# changed\n")
    assert before is not None
    assert folder() != before
