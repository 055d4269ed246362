"""Video to poses.

Of the platform where a run tells how camera and plate are mounted, else of the plate in the camera
frame.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Rig
from cdpr8.runfolder.read import Run
from cdpr8.runfolder.tables import POSE, FrameFlag
from cdpr8.runfolder.video import read_video
from vision.board_fit import check_board_fits
from vision.camera_model import CameraModel
from vision.frame_times import flags_of_late_frames, note_if_cut, usual_interval
from vision.mounting import Mounting, mounting_of
from vision.plate import Plate, Singles
from vision.tables import (
    VIDEO_POSE,
    Row,
    as_frame,
    common_cells,
    plate_cells,
    platform_cells,
)
from vision.tracker import Sighting, Tracker

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class _Seen:
    frame: int
    t_s: float
    flags: FrameFlag
    sighting: Sighting


def track_run(
    run: Run,
    *,
    rig: Rig | None = None,
    step: Callable[[], None] | None = None,
    notes: list[str] | None = None,
) -> "pd.DataFrame":
    """Pose of the platform in every frame of a run.

    Parameters
    ----------
    run
        The run; its own rig file says how camera and plate are mounted.
    rig
        Another rig to take instead.
    step
        Called once a frame.
    notes
        Takes what a user must know.

    Returns
    -------
    DataFrame
        The columns of `cdpr8.runfolder.tables.POSE`, one row a frame; NaN where no pose.

    Raises
    ------
    DataError
        The run has no video, no camera or no plate; the video does not fit them; no marker of the
        plate is in any frame; or the camera's pose is neither stated nor to be had from a rest.
    """
    rig, notes = rig or run.rig, [] if notes is None else notes
    if run.video is None:
        raise DataError("the run has no video.mkv", where=str(run.folder))
    if rig.camera is None or rig.plate is None or isinstance(rig.camera.intrinsics, str):
        raise DataError(
            "the run's rig has no [camera] or no [plate]",
            where=str(run.folder / "rig.toml"),
            remedy="name a rig file that has both with --rig",
        )
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    tracker = Tracker(camera, Plate.from_rig(rig.plate))
    seen = [
        _Seen(frame, t_s, flags, sighting)
        for (frame, t_s, flags), sighting in _frames(run, tracker, camera, step, notes)
    ]
    _check_fit(seen, tracker, run.video)
    mounting = mounting_of(rig)
    if rig.camera.pose is None:
        mounting = _with_camera_from_rest(run, mounting, seen, rig.camera.exposure_s, notes)
    interval = 1.0 / (run.start.camera.fps if run.start.camera else rig.camera.fps)
    late = flags_of_late_frames([one.t_s for one in seen], interval)
    rows: list[Row] = []
    for one, dropped in zip(seen, late, strict=True):
        row = common_cells(one.frame, one.t_s, one.sighting, one.flags | dropped)
        if one.sighting.estimate is not None:
            row.update(platform_cells(mounting.platform(one.sighting.estimate.pose)))
        rows.append(row)
    return as_frame(rows, POSE)


def track_video(
    path: Path,
    camera: CameraModel,
    board: Plate | Singles,
    *,
    fps: float | None = None,
    step: Callable[[], None] | None = None,
    notes: list[str] | None = None,
) -> "pd.DataFrame":
    """Pose of a plate, or of independent markers, in the camera frame in every frame of a video.

    Parameters
    ----------
    path
        Any video.
    camera
        The camera that took it.
    board
        What to look for.
    fps
        Frame rate to take for times where the container has none.
    step
        Called once a frame.
    notes
        Takes what a user must know.

    Returns
    -------
    DataFrame
        The columns of `vision.tables.VIDEO_POSE`: one row a frame, or one row a frame and marker
        where markers are independent; NaN where no pose.

    Raises
    ------
    DataError
        The file is no video, is of another size than the camera's, or shows no marker of the board.
    """
    notes = [] if notes is None else notes
    tracker = Tracker(camera, board)
    seen: list[_Seen] = []
    times: list[float] = []
    for number, (image, stamp) in enumerate(read_video(path)):
        camera.check_size(image, str(path))
        made_up = number / fps if fps else float("nan")
        times.append(made_up if stamp is None else stamp)
        seen += [
            _Seen(number, times[-1], FrameFlag(0), sighting)
            for sighting in tracker.see(image).sightings
        ]
        if step:
            step()
    _check_fit(seen, tracker, path)
    interval = usual_interval(times, notes, given=fps is not None)
    note_if_cut(path, times, interval, notes)
    late = flags_of_late_frames(times, interval)
    rows: list[Row] = []
    for one in seen:
        row = common_cells(one.frame, one.t_s, one.sighting, one.flags | late[one.frame])
        row["marker"] = one.sighting.marker
        if one.sighting.estimate is not None:
            row.update(plate_cells(one.sighting.estimate.pose))
        rows.append(row)
    return as_frame(rows, VIDEO_POSE)


def _frames(
    run: Run,
    tracker: Tracker,
    camera: CameraModel,
    step: Callable[[], None] | None,
    notes: list[str],
) -> Iterator[tuple[tuple[int, float, FrameFlag], Sighting]]:
    """What frames.csv says of each frame that it and the video both have, and what is seen."""
    assert run.video is not None
    table = run.frames
    rows = list(zip(table["frame"], table["t_s"], table["flags"], strict=True))
    stamped = len(rows) > 0
    count = 0
    for image, stamp in read_video(run.video):
        camera.check_size(image, str(run.video))
        count += 1
        if stamped and count > len(rows):
            continue
        if stamped:
            frame, t_s, flags = rows[count - 1]
        else:
            frame, t_s, flags = count - 1, float("nan") if stamp is None else stamp, 0
        yield (
            (int(frame), float(t_s), FrameFlag(int(flags))),
            tracker.see(image).sightings[0],
        )
        if step:
            step()
    if not stamped:
        notes.append("frames.csv has no rows: times are those of video.mkv, rounded to 1 ms")
    elif count != len(rows):
        notes.append(
            f"video.mkv has {count} whole frames and frames.csv {len(rows)} rows (an interrupted "
            f"run?): the {min(count, len(rows))} that both have are tracked"
        )


def _with_camera_from_rest(
    run: Run, mounting: Mounting, seen: list[_Seen], exposure_s: float, notes: list[str]
) -> Mounting:
    start_s = run.start.excitation.start_s
    rest = [
        one.sighting.estimate.pose
        for one in seen
        if one.sighting.estimate is not None and one.t_s + exposure_s / 2.0 < start_s
    ]
    if not run.start.motion_start_known or not rest:
        why = (
            f"no frame with a pose before the motion starts at {start_s} s"
            if run.start.motion_start_known
            else "when the motion started is not known"
        )
        raise DataError(
            f"where the camera stands is not stated, and cannot be had from the rest: {why}",
            where=f"{run.folder / 'rig.toml'}, [camera.pose]",
            allowed="[camera.pose], or frames at rest before the motion (excitation.rest_s)",
            remedy="add position_m and look_at_m of the camera, or record with a rest",
        )
    notes.append(
        f"the camera's pose is taken from the {len(rest)} frames at rest: the pose there is zero"
    )
    return mounting.with_camera_seeing_rest(rest)


def _check_fit(seen: list[_Seen], tracker: Tracker, path: Path) -> None:
    frames = len({one.frame for one in seen})
    board = tracker.board
    sightings = [one.sighting for one in seen]
    check_board_fits(sightings, frames, tracker.ids_seen, path, board.dictionary, board.ids)
