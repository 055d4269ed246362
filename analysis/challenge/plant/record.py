"""A run folder of what happened: a polled bus, a camera that jitters, noise."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from itertools import combinations
from pathlib import Path
from uuid import UUID

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.plant import Course
from analysis.challenge.plant.sensors import Faults, read_cells, see
from cdpr8.provenance import versions
from cdpr8.rigfile import Excitation
from cdpr8.runfolder import (
    POSE_AXES,
    ClockAnchor,
    EventKind,
    RunWriter,
    StartRecord,
    StopRecord,
    TableWriter,
)
from cdpr8.runfolder.tables import POSE

Array = NDArray[np.float64]

DIGITS_PER_N = 51200.0
"""One digit of an amplifier with a 50 N cell."""

TO_DEGREES = np.array([1.0, 1.0, 1.0, *np.rad2deg(np.ones(3))])

EPOCH = datetime(2026, 1, 1, tzinfo=UTC)


@dataclass(frozen=True)
class Sensing:
    """How a run is measured where nothing is wrong.

    Parameters
    ----------
    poll_hz
        Samples a second of each cable; the cables are asked in turn.
    poll_jitter_s
        Scatter of a sampling time, known to the record.
    tension_noise_n
        Of each amplifier, shape (8,), N.
    frame_hz, frame_jitter_s
        Of the camera; the jitter is known to the record.
    pose_covariance
        Shape (6, 6), m and rad.
    pose_spread
        By how much a frame's noise differs from the next's, in its logarithm.
    """

    poll_hz: float
    poll_jitter_s: float
    tension_noise_n: Array
    frame_hz: float
    frame_jitter_s: float
    pose_covariance: Array
    pose_spread: float

    @classmethod
    def drawn(cls, generator: np.random.Generator) -> "Sensing":
        """As laboratories are: 25 to 1200 Hz a cable, 2 to 20 mN, 0.003 to 0.03 deg."""
        fast = generator.uniform() < 0.08
        poll_hz = 1200.0 if fast else float(np.exp(generator.uniform(*np.log([25.0, 400.0]))))
        noise = np.exp(generator.uniform(*np.log([2e-3, 2e-2])))
        angle = np.deg2rad(np.exp(generator.uniform(*np.log([3e-3, 3e-2]))))
        place = np.exp(generator.uniform(*np.log([2e-5, 2e-4])))
        sigma = np.array([place] * 3 + [angle] * 3) * np.exp(0.3 * generator.standard_normal(6))
        mix = np.eye(6) + 0.35 * generator.standard_normal((6, 6))
        mixed = mix @ mix.T
        scale = sigma / np.sqrt(np.diag(mixed))
        return cls(
            poll_hz=poll_hz,
            poll_jitter_s=0.02 / poll_hz,
            tension_noise_n=noise * np.exp(0.15 * generator.standard_normal(8)),
            frame_hz=16.0,
            frame_jitter_s=float(generator.uniform(0.0, 8e-4)),
            pose_covariance=mixed * np.outer(scale, scale),
            pose_spread=0.1,
        )


@dataclass(frozen=True)
class Measured:
    """A run as recorded, and what it would be without noise.

    Parameters
    ----------
    tension_t_s, tension_n
        Shape (n, 8): each cable has times of its own.
    pose_t_s, pose
        Shapes (m,) and (m, 6); m and rad.
    covariance
        Of each pose, shape (m, 6, 6).
    """

    tension_t_s: Array
    tension_n: Array
    pose_t_s: Array
    pose: Array
    covariance: Array


def measure(
    course: Course,
    sensing: Sensing,
    faults: Faults,
    seed: np.random.SeedSequence,
    *,
    noise: bool = True,
) -> Measured:
    """Read cells and camera; times and noise depend on the seed alone, not on what happened.

    Parameters
    ----------
    course
        What happened.
    sensing
        How it is measured.
    faults
        Of cells and camera.
    seed
        Of times and noise.
    noise
        False leaves it out, at the same times.
    """
    times, frames, noises = (np.random.default_rng(child) for child in _children(seed))
    end_s = float(course.t_s[-1])
    period_s = 1.0 / sensing.poll_hz
    rounds = int(end_s / period_s)
    turn = (np.arange(rounds)[:, None] + np.arange(8) / 8.0) * period_s
    tension_t_s = turn + sensing.poll_jitter_s * times.uniform(0.0, 1.0, turn.shape)
    cells = read_cells(course.t_s, course.tension_n, faults.cell)
    tension_n = np.stack(
        [np.interp(tension_t_s[:, i], course.t_s, cells[:, i]) for i in range(8)], axis=1
    )
    first_s = frames.uniform(0.0, 1.0 / sensing.frame_hz)
    regular = first_s + np.arange(int((end_s - first_s) * sensing.frame_hz)) / sensing.frame_hz
    stamp_s = regular + sensing.frame_jitter_s * frames.standard_normal(len(regular))
    wander = frames.standard_normal(len(regular))
    pose = see(course.t_s, course.pose, stamp_s, faults.camera, wander)
    spread = np.exp(2.0 * sensing.pose_spread * frames.standard_normal(len(regular)))
    covariance = spread[:, None, None] * sensing.pose_covariance
    if noise:
        tension_n = tension_n + sensing.tension_noise_n * noises.standard_normal(tension_n.shape)
        root = np.linalg.cholesky(sensing.pose_covariance)
        drawn = noises.standard_normal(pose.shape) @ root.T
        pose = pose + np.sqrt(spread)[:, None] * drawn
    return Measured(tension_t_s, tension_n, stamp_s, pose, covariance)


def _children(seed: np.random.SeedSequence) -> list[np.random.SeedSequence]:
    """Three children that are the same each time they are asked for."""
    fresh = np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)
    return fresh.spawn(3)


def write(
    folder: Path, name: str, rig_text: str, excitation: Excitation, measured: Measured
) -> None:
    """Write a run folder without a video: its poses are there already.

    Parameters
    ----------
    folder
        Where.
    name
        Of the case and run: its identity.
    rig_text
        The rig file.
    excitation
        The motion asked for.
    measured
        Cells and camera.
    """
    digest = sha256(rig_text.encode()).hexdigest()
    end_s = excitation.duration_s
    start = StartRecord(
        id=str(UUID(bytes=sha256(name.encode()).digest()[:16])),
        simulated=True,
        reconstruction=f"challenge case {name}: made by an independent plant, not measured; "
        "what it conceals, if anything, is sealed",
        rig_file="rig.toml",
        rig_sha256=digest,
        excitation=excitation,
        motion_start_known=True,
        clock_anchor=ClockAnchor(t_s=0.0, wall=EPOCH),
        versions={key: value for key, value in versions().items() if key in ("cdpr8", "python")},
    )
    with RunWriter(folder, start, rig_text) as writer:
        begins = f"{excitation.axis} {excitation.amplitude_deg:g} deg at "
        begins += f"{excitation.frequency_hz:g} Hz"
        writer.event(excitation.start_s, EventKind.MOTION_START, begins)
        writer.event(excitation.end_s, EventKind.MOTION_END, "")
        _write_tensions(writer.tension, measured)
        for frame, t_s in enumerate(measured.pose_t_s.tolist()):
            writer.frames.append({"frame": frame, "t_s": t_s, "flags": 0})
        samples = {cable: len(measured.tension_n) for cable in range(1, 9)}
        writer.stop(
            StopRecord(
                reason="duration",
                t_s=end_s,
                samples=samples,
                frames=len(measured.pose_t_s),
                clock_anchor=ClockAnchor(t_s=end_s, wall=EPOCH + timedelta(seconds=end_s)),
            )
        )
    _write_poses(folder, measured)


def _write_tensions(table: TableWriter, measured: Measured) -> None:
    digits = np.rint(measured.tension_n * DIGITS_PER_N).astype(int)
    tension_n = (digits / DIGITS_PER_N).tolist()
    rows = digits.tolist()
    for n, times in enumerate(measured.tension_t_s.tolist()):
        for i in range(8):
            table.append(
                {
                    "t_s": times[i],
                    "cable": i + 1,
                    "digits": rows[n][i],
                    "tension_n": tension_n[n][i],
                    "status": 0,
                }
            )


def _write_poses(folder: Path, measured: Measured) -> None:
    table = TableWriter(folder, POSE)
    pose = (measured.pose * TO_DEGREES).tolist()
    short = [name.rsplit("_", 1)[0] for name in POSE_AXES]
    for frame, t_s in enumerate(measured.pose_t_s.tolist()):
        covariance = measured.covariance[frame]
        sigma = np.sqrt(np.diag(covariance))
        row: dict[str, float | int] = {"frame": frame, "t_s": t_s, "markers": 4, "flags": 0}
        row |= dict(zip(POSE_AXES, pose[frame], strict=True))
        shown = (sigma * TO_DEGREES).tolist()
        row |= {f"sigma_{name}": value for name, value in zip(POSE_AXES, shown, strict=True)}
        for a, b in combinations(range(6), 2):
            row[f"corr_{short[a]}_{short[b]}"] = float(covariance[a, b] / (sigma[a] * sigma[b]))
        table.append(row)
    table.close()
