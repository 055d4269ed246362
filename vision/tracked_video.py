"""Any video to poses of a plate, or of independent markers, in the camera frame."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from cdpr8.runfolder.tables import FrameFlag
from cdpr8.runfolder.video import read_video
from vision.camera_model import CameraModel
from vision.frame_times import flags_of_late_frames, note_if_cut, usual_interval
from vision.plate import Plate, Singles
from vision.refine import Refinement
from vision.sequence import TimedSighting, settled
from vision.tables import VIDEO_POSE, Row, as_frame, common_cells, plate_cells
from vision.tracker import Tracker

if TYPE_CHECKING:
    import pandas as pd


def track_video(
    path: Path,
    camera: CameraModel,
    board: Plate | Singles,
    *,
    fps: float | None = None,
    refinement: Refinement | None = None,
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
    refinement
        What poses are fitted to; None takes the pixels for a plate, corners for single markers.
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
    tracker = Tracker(camera, board, refinement)
    seen: list[TimedSighting] = []
    times: list[float] = []
    for number, (image, stamp) in enumerate(read_video(path)):
        camera.check_size(image, str(path))
        made_up = number / fps if fps else float("nan")
        times.append(made_up if stamp is None else stamp)
        seen += [
            TimedSighting(number, times[-1], FrameFlag(0), sighting)
            for sighting in tracker.see(image).sightings
        ]
        if step:
            step()
    seen = settled(seen, tracker, path)
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
