import sys
from pathlib import Path

import pytest

from cdpr8.rigfile import Rig, load_rig, packaged_rig_path

# pytest imports test modules by path; the stand-ins beside them are imported by name.
sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def rig() -> Rig:
    return load_rig(packaged_rig_path())


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The test's own folder, made the one that commands start in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
