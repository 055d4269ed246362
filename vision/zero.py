"""Where the camera stands, found from frames that show the platform at X = 0.

Those are a still run of the same camera and plate, or the rest of a run before its motion.
"""

from cdpr8.errors import DataError
from cdpr8.runfolder.read import Run
from vision.mounting import Mounting
from vision.sequence import TimedSighting


def with_camera_from_still(
    run: Run, mounting: Mounting, seen: list[TimedSighting], notes: list[str]
) -> Mounting:
    """The mounting with the camera where a still run puts it.

    Parameters
    ----------
    run
        The platform at X = 0 throughout.
    mounting
        As the rig file states it.
    seen
        Of the run's frames.
    notes
        Takes what a user must know.
    """
    poses = [one.sighting.estimate.pose for one in seen if one.sighting.estimate is not None]
    notes.append(f"zero is the mean of {len(poses)} frames of {run.folder.name}")
    return mounting.with_camera_seeing_rest(poses)


def with_camera_from_rest(
    run: Run, mounting: Mounting, seen: list[TimedSighting], exposure_s: float, notes: list[str]
) -> Mounting:
    """The mounting with the camera where a run's frames before its motion put it.

    Parameters
    ----------
    run
        At rest, the platform at X = 0, until its motion starts.
    mounting
        As the rig file states it.
    seen
        Of the run's frames.
    exposure_s
        How long a frame is exposed, s; its time is the middle of that.
    notes
        Takes what a user must know.

    Raises
    ------
    DataError
        No frame at rest has a pose, or when the motion started is not known.
    """
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
