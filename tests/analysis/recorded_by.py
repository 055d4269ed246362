"""Runs made for tests: by the challenge's independent plant, or by the model with noise added."""

from pathlib import Path

import numpy as np

from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.plant.machine import Offset
from analysis.challenge.plant.record import Measured, Sensing, write
from analysis.challenge.rig_text import rig_text
from analysis.challenge.rigs import cdpr8
from analysis.challenge.truth import drawn_offset
from analysis.diagnosis.prepare import prepare
from analysis.diagnosis.recording import Recording
from cdpr8.rigfile import Excitation, Rig
from cdpr8.rigfile.schema import CellPlace
from model import ActiveEffect, observe, simulate

STILL = {"platform_offset_m": (0.0, 0.0, 0.0), "cable_offset_m": 0.0}


def by_plant(
    folder: Path, seed: int, excitation: Excitation, *, off: bool
) -> tuple[Recording, Offset]:
    """A run of the independent plant with no effect; `off`: its machine is off by its sigmas."""
    generator = np.random.default_rng(seed)
    rig = cdpr8().model_copy(update={"excitation": excitation})
    offset = drawn_offset(rig, generator) if off else Offset.none()
    run = PlannedRun(rig, np.random.SeedSequence(seed))
    case = Case("clean", "single", (run,), Sensing.drawn(generator), offset)
    write(folder, f"clean {seed}", rig_text(rig), excitation, case.made(run))
    return prepare([folder])[0], offset


def by_model(
    folder: Path,
    effects: list[ActiveEffect],
    excitation: Excitation,
    *,
    cell: CellPlace = CellPlace.PLATFORM,
    seed: int = 1,
    rig: Rig | None = None,
) -> Recording:
    """A run of the model itself with effects and noise: cables polled in turn at 120 Hz."""
    rig = cdpr8() if rig is None else rig
    cables = tuple(one.model_copy(update={"cell": cell}) for one in rig.cable)
    rig = rig.model_copy(update={"excitation": excitation, "cable": cables})
    generator = np.random.default_rng(seed)
    end_s = excitation.duration_s - 0.01
    times = np.arange(0.001, end_s, 1 / 120)[:, None] + np.arange(8) / 960
    frames = np.arange(0.01, end_s, 1 / 16)
    seen = observe(
        simulate(rig, excitation, effects=effects), effects, tension_t_s=times, pose_t_s=frames
    )
    sigma = np.array([2e-5] * 3 + [1e-4] * 3)
    tension = seen.tension_n + 0.005 * generator.standard_normal(seen.tension_n.shape)
    pose = seen.pose + sigma * generator.standard_normal(seen.pose.shape)
    covariance = np.tile(np.diag(sigma**2), (len(frames), 1, 1))
    measured = Measured(times, tension, frames, pose, covariance)
    write(folder, f"model {folder.name}", rig_text(rig), excitation, measured)
    return prepare([folder])[0]
