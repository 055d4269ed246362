"""A run to poses of the platform in O-XYZ: its frames tracked, the camera and plate as mounted."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Rig
from cdpr8.runfolder.read import Run
from cdpr8.runfolder.tables import POSE, FrameFlag
from cdpr8.runfolder.video import read_video
from vision.camera_model import CameraModel
from vision.frame_times import flags_of_late_frames
from vision.motion_clock import flag_jumps_of_motion
from vision.mounting import mounting_of
from vision.plate import Plate
from vision.refine import Refinement
from vision.self_calibration import PlateView, calibrate_plate, spread_out
from vision.sequence import TimedSighting, at_rows_of_plate, settled
from vision.tables import Row, as_frame, common_cells, platform_cells
from vision.tracker import Sighting, Tracker
from vision.watched import watch
from vision.zero import with_camera_from_rest, with_camera_from_still

if TYPE_CHECKING:
    import pandas as pd

CALIBRATION_FRAMES = 60
"""Frames, evenly over a run, from which its plate is calibrated."""


@dataclass(frozen=True)
class _Still:
    """A still run, tracked."""

    run: Run
    seen: list[TimedSighting]


def track_run(
    run: Run,
    *,
    rig: Rig | None = None,
    refinement: Refinement | None = None,
    zero: "Run | Literal['rest'] | None" = None,
    self_calibrate: bool = False,
    row_delay_s: float | None = None,
    step: Callable[[], None] | None = None,
    notes: list[str] | None = None,
    workers: int = 1,
) -> "pd.DataFrame":
    """Pose of the platform in every frame of a run.

    Parameters
    ----------
    run
        The run; its own rig file says how camera and plate are mounted.
    rig
        Another rig to take instead.
    refinement
        What poses are fitted to; None takes the pixels.
    zero
        What shows the platform at X = 0: the frames of this run before its motion (``"rest"``), or
        a still run of the same camera and plate; None takes the camera's stated pose, or the rest
        where none is stated.
    self_calibrate
        Find where the plate's markers really are, from this run, and track again with that.
    row_delay_s
        Rolling shutter: from one row to the next; stamps are those of the middle row, and times in
        the table become those of the plate's own. None takes the rig file's.
    step
        Called once a frame.
    notes
        Takes what a user must know.
    workers
        Processes.

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
    notes = [] if notes is None else notes
    camera, plate = camera_and_plate(run, rig)
    if self_calibrate:
        plate = _calibrated(run, plate, camera, refinement, notes)
    seen = _seen_in(run, Tracker(camera, plate, refinement), step, notes, workers)
    still = None
    if isinstance(zero, Run):
        tracker = Tracker(camera, plate, refinement)
        still = _Still(zero, _seen_in(zero, tracker, None, notes))
    machine = rig or run.rig
    if row_delay_s is None:
        row_delay_s = machine.camera.row_delay_s if machine.camera else 0.0
    return _platform_poses(run, seen, camera, plate, machine, still or zero, row_delay_s, notes)


def camera_and_plate(run: Run, rig: Rig | None = None) -> tuple[CameraModel, Plate]:
    """Camera and plate of a run, or of another rig.

    Raises
    ------
    DataError
        The run has no video, or the rig no camera or no plate.
    """
    rig = rig or run.rig
    if run.video is None:
        raise DataError("the run has no video.mkv", where=str(run.folder))
    if rig.camera is None or rig.plate is None or isinstance(rig.camera.intrinsics, str):
        raise DataError(
            "the run's rig has no [camera] or no [plate]",
            where=str(run.folder / "rig.toml"),
            remedy="name a rig file that has both with --rig",
        )
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    return camera, Plate.from_rig(rig.plate)


def poses_from_sightings(
    run: Run,
    sightings: Sequence[Sighting],
    tracker: Tracker,
    camera: CameraModel,
    plate: Plate,
    *,
    rig: Rig | None = None,
    notes: list[str],
) -> "pd.DataFrame":
    """The table of a run whose frames were tracked as they came.

    Parameters
    ----------
    run
        The run, complete.
    sightings
        Of its frames, from the first.
    tracker
        What saw them.
    camera, plate
        As it was made with.
    rig
        Another rig than the run's own.
    notes
        Takes what a user must know.
    """
    assert run.video is not None
    table = run.frames
    if len(table) != len(sightings):
        notes.append(
            f"video.mkv gave {len(sightings)} frames and frames.csv has {len(table)} rows: the "
            f"{min(len(table), len(sightings))} that both have are kept"
        )
    rows = zip(table["frame"], table["t_s"], table["flags"], strict=True)
    seen = [
        TimedSighting(int(frame), float(t_s), FrameFlag(int(flags)), sighting)
        for (frame, t_s, flags), sighting in zip(rows, sightings, strict=False)
    ]
    seen = settled(seen, tracker, run.video)
    return _platform_poses(run, seen, camera, plate, rig or run.rig, None, 0.0, notes)


def _platform_poses(
    run: Run,
    seen: list[TimedSighting],
    camera: CameraModel,
    plate: Plate,
    rig: Rig,
    zero: "_Still | Run | Literal['rest'] | None",
    row_delay_s: float,
    notes: list[str],
) -> "pd.DataFrame":
    """Sightings of the plate to a table of the platform's poses."""
    assert rig.camera is not None
    interval = 1.0 / (run.start.camera.fps if run.start.camera else rig.camera.fps)
    late = flags_of_late_frames([one.t_s for one in seen], interval)
    seen = [
        replace(one, flags=one.flags | dropped) for one, dropped in zip(seen, late, strict=True)
    ]
    if row_delay_s:
        seen = at_rows_of_plate(seen, plate, camera, row_delay_s)
    mounting = mounting_of(rig)
    if isinstance(zero, _Still):
        mounting = with_camera_from_still(zero.run, mounting, zero.seen, notes)
    elif zero == "rest" or rig.camera.pose is None:
        mounting = with_camera_from_rest(run, mounting, seen, rig.camera.exposure_s, notes)
    rows: list[Row] = []
    for one in seen:
        row = common_cells(one.frame, one.t_s, one.sighting, one.flags)
        if one.sighting.estimate is not None:
            row.update(platform_cells(mounting.platform(one.sighting.estimate.pose)))
        rows.append(row)
    poses = as_frame(rows, POSE)
    flag_jumps_of_motion(poses, f"{run.start.excitation.axis}_deg", notes)
    return poses


def _seen_in(
    run: Run,
    tracker: Tracker,
    step: Callable[[], None] | None,
    notes: list[str],
    workers: int = 1,
) -> list[TimedSighting]:
    """Every frame of a run, the branches chosen with all frames known."""
    assert run.video is not None
    table = run.frames
    rows = list(zip(table["frame"], table["t_s"], table["flags"], strict=True))
    watched = watch(run.video, tracker, len(rows) or None, workers, step)
    if not rows:
        notes.append("frames.csv has no rows: times are those of video.mkv, rounded to 1 ms")
        nowhere = float("nan")
        rows = [
            (number, nowhere if stamp is None else stamp, 0)
            for number, stamp in enumerate(watched.stamps)
        ]
    elif watched.count != len(rows):
        notes.append(
            f"video.mkv has {watched.count} whole frames and frames.csv {len(rows)} rows (an "
            f"interrupted run?): the {min(watched.count, len(rows))} that both have are tracked"
        )
    seen = [
        TimedSighting(int(frame), float(t_s), FrameFlag(int(flags)), sighting)
        for (frame, t_s, flags), sighting in zip(rows, watched.sightings, strict=False)
    ]
    return settled(seen, tracker, run.video)


def _calibrated(
    run: Run,
    plate: Plate,
    camera: CameraModel,
    refinement: Refinement | None,
    notes: list[str],
) -> Plate:
    """The plate with its markers where a run shows them."""
    assert run.video is not None
    tracker = Tracker(camera, plate, refinement)
    views: list[PlateView] = []
    wanted = set(spread_out(max(len(run.frames), 1), CALIBRATION_FRAMES))
    for number, (image, _) in enumerate(read_video(run.video)):
        if number not in wanted and len(run.frames):
            continue
        camera.check_size(image, str(run.video))
        sighting = tracker.see(image).sightings[0]
        estimate = sighting.estimate
        if estimate is not None and not sighting.flags:
            views.append(PlateView(image, sighting.ids, estimate.pose))
    found = calibrate_plate(plate, views, camera)
    if found is None:
        raise DataError(
            f"the plate cannot be calibrated from {len(views)} good frames",
            where=str(run.video),
            allowed="a run with at least 5 frames that show the plate and carry no flag",
            remedy="track without --self-calibrate, or take a run with the plate in full view",
        )
    notes.append(found.sentence())
    return found.plate
