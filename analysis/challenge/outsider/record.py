"""A run folder of what happened: cells polled or streaming, a camera whose stamps jitter, noise."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from pathlib import Path
from uuid import UUID

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.camera import SOUND_CAMERA, CameraFault, see
from analysis.challenge.outsider.cells import SOUND_CELLS, CellFault, read_cells
from analysis.challenge.outsider.plant import Course
from cdpr8.provenance import versions
from cdpr8.rigfile import Excitation
from cdpr8.runfolder import (
    POSE_AXES,
    ClockAnchor,
    EventKind,
    Node,
    RunWriter,
    StartRecord,
    StopRecord,
    TableWriter,
)
from cdpr8.runfolder.tables import POSE

Array = NDArray[np.float64]

FIRST_S = 1e-3
LAST_S = 0.02
"""Sampling begins and ends this long after and before the run's clock."""

POLLED_OUTPUT_HZ = 1200.0
STREAM_HZ = 600.0
STREAM_JITTER_S = 3e-4
STREAM_RATE_SHARE = 1e-5
"""By which each amplifier's quartz is off."""
REQUEST_SCATTER_S = 2e-5
LOST_SHARE = 0.002
"""Of answers of a polled bus that do not come."""

FRAMES_LESS_S = 0.4
"""No frame comes in the last part of a run: late and lost ones must still have something to see."""

TO_DEGREES = np.array([1.0, 1.0, 1.0, *np.rad2deg(np.ones(3))])
EPOCH = datetime(2026, 3, 2, 9, tzinfo=UTC)


@dataclass(frozen=True)
class Faults:
    """Of cells and camera."""

    cell: CellFault = SOUND_CELLS
    camera: CameraFault = SOUND_CAMERA


@dataclass(frozen=True)
class Sensing:
    """How a run is measured where nothing is wrong.

    Parameters
    ----------
    streaming
        Whether amplifiers send unasked; else they are asked in turn.
    slot_s
        From one request of a polled bus to the next, s.
    tension_noise_n
        Of each amplifier, shape (8,), N.
    digit_n
        Step of the written tension, N.
    frame_hz, frame_jitter_s
        Of the camera; the jitter is in no record.
    pose_sigma
        Shape (6,), m and rad.
    sampling_stated, noise_stated
        Whether the run says how uncertain its instants are, and the rig file how noisy its cells.
    """

    streaming: bool
    slot_s: float
    tension_noise_n: Array
    digit_n: float
    frame_hz: float
    frame_jitter_s: float
    pose_sigma: Array
    sampling_stated: bool
    noise_stated: bool

    @property
    def poll_hz(self) -> float:
        """Samples a second of each cable."""
        return STREAM_HZ if self.streaming else 1.0 / (8.0 * self.slot_s)

    @property
    def instant_scatter_s(self) -> float:
        """Width of the interval in which a value was really taken, s."""
        return STREAM_JITTER_S if self.streaming else 1.0 / POLLED_OUTPUT_HZ

    @classmethod
    def drawn(cls, generator: np.random.Generator) -> "Sensing":
        """As laboratories are: 5 to 10 mN, 0.02 to 0.1 mm, 0.005 to 0.02 deg."""
        angles = [
            generator.uniform(*limits) for limits in ((8e-3, 0.02), (5e-3, 0.015), (8e-3, 0.02))
        ]
        return cls(
            streaming=bool(generator.uniform() < 0.25),
            slot_s=float(generator.uniform(9.5e-4, 9.9e-4)),
            tension_noise_n=np.full(8, generator.uniform(5e-3, 1e-2)),
            digit_n=float(generator.choice([50.0 / 2.56e6, 1e-3, 2e-3])),
            frame_hz=16.0,
            frame_jitter_s=float(generator.uniform(1e-4, 3e-4)),
            pose_sigma=np.array([*generator.uniform(2e-5, 1e-4, 3), *np.radians(angles)]),
            sampling_stated=bool(generator.uniform() < 2.0 / 3.0),
            noise_stated=bool(generator.uniform() < 2.0 / 3.0),
        )


@dataclass(frozen=True)
class Measured:
    """A run as recorded, and what it would be without noise.

    Parameters
    ----------
    tension_t_s, tension_n
        Shape (n, 8): each cable has instants of its own.
    lost
        Which of them never came, shape (n, 8).
    pose_t_s, pose
        Shapes (m,) and (m, 6); m and rad.
    covariance
        As stated, of each pose, shape (m, 6, 6).
    """

    tension_t_s: Array
    tension_n: Array
    lost: NDArray[np.bool_]
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
    """Read cells and camera; instants and noise depend on the seed alone, not on what happened.

    Parameters
    ----------
    course
        What happened.
    sensing
        How it is measured.
    faults
        Of cells and camera.
    seed
        Of instants and noise.
    noise
        False leaves it out, at the same instants.
    """
    from scipy.interpolate import CubicSpline

    fresh = np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)
    times, frames, noises = (np.random.default_rng(child) for child in fresh.spawn(3))
    end_s = float(course.t_s[-1])
    written_s, lost = _instants(sensing, end_s, times)
    width_s = sensing.instant_scatter_s
    taken_s = np.clip(written_s + width_s * times.uniform(-0.5, 0.5, written_s.shape), 0.0, end_s)
    cells = read_cells(course.t_s, course.tension_n, faults.cell)
    channels = [CubicSpline(course.t_s, cells[:, i])(taken_s[:, i]) for i in range(8)]
    tension_n = np.stack(channels, axis=1)
    period_s = 1.0 / sensing.frame_hz
    first_s = frames.uniform(0.0025, 0.0625)
    frame = np.arange(int((end_s - FRAMES_LESS_S) / period_s))
    stamp_s = np.asarray(first_s + period_s * frame, dtype=float)
    jitter_s = sensing.frame_jitter_s * frames.standard_normal(len(stamp_s))
    pose = see(course.t_s, course.pose, stamp_s, jitter_s, period_s, faults.camera)
    if noise:
        drawn = sensing.tension_noise_n * noises.standard_normal(tension_n.shape)
        tension_n = np.round((tension_n + drawn) / sensing.digit_n) * sensing.digit_n
        pose = pose + sensing.pose_sigma * noises.standard_normal(pose.shape)
    covariance = np.tile(np.diag(sensing.pose_sigma**2), (len(stamp_s), 1, 1))
    return Measured(written_s, tension_n, lost, stamp_s, pose, covariance)


def _instants(
    sensing: Sensing, end_s: float, generator: np.random.Generator
) -> tuple[Array, NDArray[np.bool_]]:
    """Written instants of each cable, and which answers are lost; shape (n, 8)."""
    if sensing.streaming:
        rounds = int((end_s - LAST_S) * STREAM_HZ)
        quartz = 1.0 + STREAM_RATE_SHARE * generator.standard_normal(8)
        since = np.arange(rounds)[:, None] / STREAM_HZ * quartz
        written_s = FIRST_S + generator.uniform(0.0, 1.0 / STREAM_HZ, 8) + since
        return np.round(written_s, 6), np.zeros(written_s.shape, dtype=bool)
    rounds = int((end_s - LAST_S) / (8.0 * sensing.slot_s))
    turn = np.arange(8 * rounds).reshape(rounds, 8)
    scatter = generator.uniform(0.0, REQUEST_SCATTER_S, turn.shape)
    lost = generator.uniform(size=turn.shape) < LOST_SHARE
    return np.round(FIRST_S + sensing.slot_s * turn + scatter, 6), lost


def write(
    folder: Path,
    name: str,
    rig_text: str,
    excitation: Excitation,
    sensing: Sensing,
    measured: Measured,
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
    sensing, measured
        How it was measured, and what came of it.
    """
    end_s = excitation.duration_s
    with RunWriter(folder, _start(name, rig_text, excitation, sensing), rig_text) as writer:
        writer.event(excitation.start_s, EventKind.MOTION_START, "")
        writer.event(excitation.end_s, EventKind.MOTION_END, "")
        _write_tensions(writer.tension, sensing, measured)
        for frame, t_s in enumerate(measured.pose_t_s.tolist()):
            writer.frames.append({"frame": frame, "t_s": t_s, "flags": 0})
        came = (~measured.lost).sum(axis=0).tolist()
        writer.stop(
            StopRecord(
                reason="duration",
                t_s=end_s,
                samples=dict(enumerate(came, start=1)),
                frames=len(measured.pose_t_s),
                clock_anchor=ClockAnchor(t_s=end_s, wall=EPOCH + timedelta(seconds=end_s)),
            )
        )
    _write_poses(folder, measured)


def _start(name: str, rig_text: str, excitation: Excitation, sensing: Sensing) -> StartRecord:
    scatter_s = sensing.instant_scatter_s / np.sqrt(12.0) if sensing.sampling_stated else None
    nodes = tuple(
        Node(cable=i, address=i, identity=f"OUTSIDER,CELL,{i}", sampling_sigma_s=scatter_s)
        for i in range(1, 9)
    )
    return StartRecord(
        id=str(UUID(bytes=sha256(name.encode()).digest()[:16])),
        simulated=True,
        reconstruction=f"challenge case {name}: made by the outsider's plant, not measured; "
        "what it conceals, if anything, is sealed",
        rig_file="rig.toml",
        rig_sha256=sha256(rig_text.encode()).hexdigest(),
        excitation=excitation,
        motion_start_known=True,
        nodes=nodes,
        sweep="streaming" if sensing.streaming else "polled",
        clock_anchor=ClockAnchor(t_s=0.0, wall=EPOCH),
        versions={key: value for key, value in versions().items() if key in ("cdpr8", "python")},
    )


def _write_tensions(table: TableWriter, sensing: Sensing, measured: Measured) -> None:
    came = np.argwhere(~measured.lost)
    instants = measured.tension_t_s[~measured.lost]
    digits = np.rint(measured.tension_n[~measured.lost] / sensing.digit_n).astype(int)
    for row in np.lexsort((came[:, 1], instants)).tolist():
        table.append(
            {
                "t_s": float(instants[row]),
                "cable": int(came[row, 1]) + 1,
                "digits": int(digits[row]),
                "tension_n": float(digits[row] * sensing.digit_n),
                "status": 0,
            }
        )


def _write_poses(folder: Path, measured: Measured) -> None:
    table = TableWriter(folder, POSE)
    sigmas = np.sqrt(np.diagonal(measured.covariance, axis1=1, axis2=2)) * TO_DEGREES
    for frame, t_s in enumerate(measured.pose_t_s.tolist()):
        row: dict[str, float | int] = {"frame": frame, "t_s": t_s, "markers": 4, "flags": 0}
        values = (measured.pose[frame] * TO_DEGREES).tolist()
        for axis, value, sigma in zip(POSE_AXES, values, sigmas[frame].tolist(), strict=True):
            row |= {axis: value, f"sigma_{axis}": sigma}
        table.append(row)
    table.close()
