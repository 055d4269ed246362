import os
import sys
from pathlib import Path

import cv2
import pytest

from cdpr8.rigfile import load_rig, packaged_rig_path
from cdpr8.rigfile.schema import Rig

# pytest imports test modules by path; what they share is imported by name.
sys.path.insert(0, str(Path(__file__).parent))

from takes import Take, film


@pytest.fixture(scope="session")
def packaged() -> Rig:
    return load_rig(packaged_rig_path())


@pytest.fixture(scope="session")
def packaged_text() -> str:
    return packaged_rig_path().read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def take(packaged) -> Take:
    """Five seconds of the packaged rig."""
    return film(packaged, 80)


@pytest.fixture(scope="session")
def data() -> Path:
    """Other people's recordings."""
    beside = Path(__file__).parents[3] / "shared" / "data"
    folder = Path(os.environ.get("CDPR_DATA", beside)) / "vision" / "aruco_single_video"
    if not (folder / "video.avi").is_file():
        pytest.skip(f"no video in {folder}: set CDPR_DATA to the folder of recordings")
    return folder


@pytest.fixture(autouse=True, scope="session")
def _one_thread():
    """Several tests at once on few cores: OpenCV's own threads only get in the way."""
    cv2.setNumThreads(1)
