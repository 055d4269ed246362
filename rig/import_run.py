"""Writing a run folder from another program's video and table."""

import hashlib
import uuid
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from cdpr8.provenance import versions
from cdpr8.rigfile import Rig
from cdpr8.runfolder import (
    CameraStart,
    ClockAnchor,
    EventKind,
    FrameFlag,
    RunWriter,
    StartRecord,
    StopRecord,
    read_video,
)
from cdpr8.runfolder.video import Image
from rig.command_columns import Command
from rig.foreign import Array, ClockMap, ColumnMap, conversions, forces_n, times_s
from rig.foreign_table import ForeignTable


@dataclass(frozen=True)
class ImportedCommand:
    """A winch controller's log that another program wrote.

    Attributes
    ----------
    rows
        What it says, in its order.
    clock
        From its time to the tensions' table's.
    description
        Its name and columns, for start.json.
    """

    rows: Sequence[Command]
    clock: ClockMap
    description: str


def import_run(
    folder: Path,
    rig: Rig,
    rig_text: str,
    rig_file: str,
    table: ForeignTable,
    columns: ColumnMap,
    where: str,
    *,
    video: Path | None = None,
    clock: ClockMap | None = None,
    taps: tuple[tuple[float, float], ...] = (),
    made: datetime | None = None,
    beside_rig: Mapping[str, bytes] | None = None,
    command: ImportedCommand | None = None,
) -> StopRecord:
    """Write a run: tensions at the table's times, frames at theirs on the table's clock.

    The run's time 0 is the table's first row. Digits stay empty: the table holds newtons. When the
    motion started is not known.

    Parameters
    ----------
    folder
        Must not exist or be empty.
    rig, rig_text, rig_file
        The machine, its file's text and name.
    table, columns, where
        The tensions, which columns they are, and the file's name. What the table says of its
        units is believed; where it says nothing they are s and N.
    video
        Copied frame by frame, losslessly; None for tensions only.
    clock
        From the video's time to the table's.
    taps
        Events seen in both, as (table, video): noted as such.
    made
        When it was recorded; None takes now.
    beside_rig
        Files that the rig file names, for the run folder: `cdpr8.rigfile.files_beside`.
    command
        The winch controller's log, None where there is none.
    """
    clock = clock or ClockMap()
    times = times_s(table, columns.time, where)
    forces = {cable: forces_n(table, key, where) for cable, key in columns.cables.items()}
    times, forces = _timed(times, forces)
    origin_s = float(times[0])
    frames = None if video is None else _frames(video, rig.camera.fps if rig.camera else 25.0)
    first = None if frames is None else next(frames)
    wall = made or datetime.now(UTC)
    start = StartRecord(
        id=str(uuid.uuid4()),
        simulated=False,
        rig_file=rig_file,
        rig_sha256=hashlib.sha256(rig_text.encode("utf-8")).hexdigest(),
        excitation=rig.excitation,
        motion_start_known=False,
        camera=None if first is None or video is None else _camera(rig, video, first[0]),
        clock_anchor=ClockAnchor(t_s=0.0, wall=wall),
        import_map=f"{where}: {columns.time} -> time, "
        + ", ".join(f"{key} -> cable {cable}" for cable, key in columns.cables.items())
        + "".join(f"; {words}" for words in conversions(table, columns, where))
        + f"; video: {clock.offset_s:+.6f} s, rate {clock.rate:.9f}",
        command_log=None if command is None else command.description,
        versions=versions(),
    )
    writer = RunWriter(folder, start, rig_text, beside_rig)
    samples = dict.fromkeys(range(1, 9), 0)
    for row, t_s in enumerate(times):
        for cable, force in forces.items():
            if np.isfinite(force[row]):
                writer.tension.append(
                    {
                        "t_s": float(t_s) - origin_s,
                        "cable": cable,
                        "digits": None,
                        "tension_n": float(force[row]),
                        "status": 0,
                    }
                )
                samples[cable] += 1
    if command is not None and writer.command is not None:
        for each in command.rows:
            log_s = float("nan") if each.log_s is None else each.log_s
            t_s = command.clock.to_table_s(log_s) - origin_s
            writer.command.append({"t_s": t_s, "cable": each.cable, **each.values, "log_s": log_s})
    for table_s, _ in taps:
        writer.event(table_s - origin_s, EventKind.SYNC_TAP, "seen in the table and the video")
    count = 0
    before: Image | None = None
    while first is not None and frames is not None:
        image, video_s = first
        repeated = before is not None and np.array_equal(image, before)
        flags = FrameFlag.REPEATED if repeated else FrameFlag(0)
        writer.write_frame(image, clock.to_table_s(video_s) - origin_s, int(flags))
        before, count = image, count + 1
        first = next(frames, None)
    end_s = float(times[-1]) - origin_s
    stop = StopRecord(
        reason="duration",
        t_s=round(end_s, 6),
        samples=samples,
        frames=count,
        clock_anchor=ClockAnchor(
            t_s=round(end_s, 6), wall=datetime.fromtimestamp(wall.timestamp() + end_s, UTC)
        ),
    )
    writer.stop(stop)
    return stop


def _timed(times: Array, forces: dict[int, Array]) -> tuple[Array, dict[int, Array]]:
    """The rows that have a time."""
    timed = np.isfinite(times)
    return times[timed], {cable: force[timed] for cable, force in forces.items()}


def _frames(video: Path, fps: float) -> Iterator[tuple[Image, float]]:
    """Pictures with their times; where the file has none, at the rig file's rate."""
    for number, (image, video_s) in enumerate(read_video(video)):
        yield image, number / fps if video_s is None else video_s


def _camera(rig: Rig, video: Path, image: Image) -> CameraStart:
    return CameraStart(
        source=str(video),
        fps=rig.camera.fps if rig.camera else 25.0,
        exposure_s=rig.camera.exposure_s if rig.camera else 0.0,
        width_px=image.shape[1],
        height_px=image.shape[0],
    )
