"""Runs written by the run-folder writer from plain numbers, with known truth."""

import sys
from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from cdpr8.rigfile import Excitation, load_rig, packaged_rig_path
from cdpr8.runfolder import (
    POSE_AXES,
    ClockAnchor,
    Run,
    RunWriter,
    StartRecord,
    StopRecord,
    TableWriter,
    load_run,
)
from cdpr8.runfolder.tables import POSE
from rig.simulated.plant import PlatformTrajectory, simulate_platform

# pytest imports test modules by path; the stand-ins beside them are imported by name.
sys.path.insert(0, str(Path(__file__).parent))

EXCITATION = Excitation(motion_s=6.0)
ANGLE_NOISE_DEG = 0.004
TENSION_NOISE_N = 0.005

MakeRun = Callable[..., Run]


@pytest.fixture(scope="session")
def frictionless() -> PlatformTrajectory:
    return simulate_platform(load_rig(packaged_rig_path()), EXCITATION, np.zeros(8))


@pytest.fixture(scope="session")
def rubbing() -> PlatformTrajectory:
    return simulate_platform(load_rig(packaged_rig_path()), EXCITATION, np.full(8, 0.3))


@pytest.fixture(scope="session")
def make_run_in() -> MakeRun:
    """Write a run into `run` in a folder and load it; keywords are those of `write_run`."""
    return lambda folder, truth, **options: write_run(folder / "run", truth, **options)


@pytest.fixture
def make_run(make_run_in: MakeRun, tmp_path: Path) -> MakeRun:
    """Write a run into tmp_path/run and load it."""
    return partial(make_run_in, tmp_path)


def write_run(
    folder: Path,
    truth: PlatformTrajectory,
    *,
    pose: bool = True,
    start_known: bool = True,
    moved_s: float = 0.0,
    excitation: Excitation = EXCITATION,
    seed: int = 7,
    cables: tuple[int, ...] = tuple(range(1, 9)),
    until_s: float = 1e9,
) -> Run:
    """Sample a trajectory as bus and camera would: cables in turn, frames at 16 fps."""
    generator = np.random.default_rng(seed)
    anchor = ClockAnchor(t_s=0.0, wall=datetime(2026, 1, 1, tzinfo=UTC))
    start = StartRecord(
        id=f"test-{seed}",
        simulated=True,
        rig_file="rig.toml",
        rig_sha256="",
        excitation=excitation,
        motion_start_known=start_known,
        clock_anchor=anchor,
    )
    end = min(float(truth.t_s[-1]), until_s)
    with RunWriter(folder, start, packaged_rig_path().read_text()) as run:
        for n, t_s in enumerate(np.arange(0.002, end, 1 / 1000)):
            cable = n % 8 + 1
            if cable in cables:
                noise = TENSION_NOISE_N * generator.standard_normal()
                value = float(truth.tension_at(cable, t_s - moved_s)) + noise
                run.tension.append(
                    {"t_s": t_s, "cable": cable, "digits": 0, "tension_n": value, "status": 0}
                )
        run.stop(StopRecord(reason="duration", t_s=end, samples={}, frames=0, clock_anchor=anchor))
    if pose:
        write_poses(folder, truth, generator, np.arange(0.03, end, 1 / 16), moved_s)
    return load_run(folder)


def write_poses(
    folder: Path,
    truth: PlatformTrajectory,
    generator: np.random.Generator,
    times: NDArray[np.float64],
    moved_s: float,
) -> None:
    table = TableWriter(folder, POSE)
    values = truth.pose_at(times - moved_s)
    values[:, 3:] = np.rad2deg(values[:, 3:])
    values[:, 3:] += ANGLE_NOISE_DEG * generator.standard_normal((len(times), 3))
    for n, (t_s, row) in enumerate(zip(times, values, strict=True)):
        cells = dict(zip(POSE_AXES, map(float, row), strict=True))
        table.append({"frame": n, "t_s": t_s, "markers": 4, "flags": 0, **cells})
    table.close()
