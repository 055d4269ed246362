"""What all frames of a video show, put right with all of them known.

A tracker sees one frame after the other. Once the last is seen, a board that does not fit is
refused, the branches of the poses are chosen anew, and a rolling shutter is corrected for.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from cdpr8.runfolder.tables import FrameFlag
from vision.board_fit import check_board_fits
from vision.branches import choose_branches
from vision.camera_model import CameraModel
from vision.plate import Plate
from vision.rolling_shutter import delay_of, without_skew
from vision.tracker import Sighting, Tracker, flags_of


@dataclass(frozen=True)
class TimedSighting:
    """What was seen, and in which frame.

    Attributes
    ----------
    frame
        Its number.
    t_s
        Its time, s.
    flags
        What concerns the frame, not what is seen in it.
    sighting
        What was seen.
    """

    frame: int
    t_s: float
    flags: FrameFlag
    sighting: Sighting


def settled(seen: list[TimedSighting], tracker: Tracker, path: Path) -> list[TimedSighting]:
    """The same with each plate's branches chosen anew, now that all frames are known.

    Parameters
    ----------
    seen
        Of all frames.
    tracker
        What saw them.
    path
        The video, for messages.

    Raises
    ------
    DataError
        The video shows nothing of the board, or the board does not fit it.
    """
    frames = len({one.frame for one in seen})
    board = tracker.board
    sightings = [one.sighting for one in seen]
    check_board_fits(sightings, frames, tracker.ids_seen, path, board.dictionary, board.ids)
    return _with_branches_of_all(seen)


def at_rows_of_plate(
    seen: list[TimedSighting], plate: Plate, camera: CameraModel, row_delay_s: float
) -> list[TimedSighting]:
    """Times and poses of a rolling shutter put right.

    Parameters
    ----------
    seen
        Of all frames, timed by the middle row.
    plate, camera
        What was seen, and by which camera.
    row_delay_s
        From one row to the next, s.
    """
    moved = list(seen)
    posed = [
        (place, one, one.sighting.estimate)
        for place, one in enumerate(seen)
        if one.sighting.estimate is not None
    ]
    poses = [estimate.pose for _, _, estimate in posed]
    times = [
        one.t_s + delay_of(plate, pose, camera, row_delay_s)
        for (_, one, _), pose in zip(posed, poses, strict=True)
    ]
    straight = without_skew(times, poses, plate, camera, row_delay_s)
    for (place, one, estimate), t_s, pose in zip(posed, times, straight, strict=True):
        sighting = replace(one.sighting, estimate=replace(estimate, pose=pose))
        moved[place] = replace(one, t_s=t_s, sighting=sighting)
    return moved


def _with_branches_of_all(seen: list[TimedSighting]) -> list[TimedSighting]:
    chosen = list(seen)
    for marker in {one.sighting.marker for one in seen}:
        places = [
            (place, one, one.sighting.estimate)
            for place, one in enumerate(seen)
            if one.sighting.marker == marker and one.sighting.estimate is not None
        ]
        estimates = choose_branches(
            [one.frame for _, one, _ in places], [estimate for _, _, estimate in places]
        )
        for (place, one, before), estimate in zip(places, estimates, strict=True):
            flags = (one.sighting.flags & ~flags_of(before)) | flags_of(estimate)
            sighting = replace(one.sighting, estimate=estimate, flags=flags)
            chosen[place] = replace(one, sighting=sighting)
    return chosen
