from pathlib import Path

import pytest

from cdpr8.rigfile import Excitation, Rig, load_rig, packaged_rig_path
from model import Simulation, simulate


@pytest.fixture(scope="session")
def rig() -> Rig:
    """The packaged CDPR-8, whatever rig.toml lies about."""
    return load_rig(packaged_rig_path())


@pytest.fixture(scope="session")
def paper() -> Excitation:
    """Section 4: 10 s from the state X*, X*', with X_p0 = X_w0 = 0.1 mm."""
    return Excitation(
        axis="pitch",
        amplitude_deg=2.0,
        frequency_hz=2.06,
        rest_s=0.0,
        motion_s=10.0,
        ramp_s=0.0,
        platform_offset_m=(1e-4, 0.0, 0.0),
        cable_offset_m=1e-4,
    )


@pytest.fixture(scope="session")
def paper_run(rig: Rig, paper: Excitation) -> Simulation:
    return simulate(rig, paper)


@pytest.fixture
def rig_file(tmp_path: Path) -> Path:
    """A copy of the packaged rig file that a test may spoil."""
    path = tmp_path / "rig.toml"
    path.write_text(packaged_rig_path().read_text())
    return path
