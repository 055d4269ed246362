import sys
from pathlib import Path

import pytest

from cdpr8.rigfile import Rig, load_rig, packaged_rig_path

# pytest imports test modules by path; the stand-ins beside them are imported by name.
sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def rig() -> Rig:
    return load_rig(packaged_rig_path())
