"""Tracking a run that is still being recorded: poses as they come, the whole table at the end."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Rig
from cdpr8.runfolder.read import load_run
from cdpr8.runfolder.tables import FrameFlag
from vision.growing_video import PATIENCE_S, read_growing
from vision.mounting import Mounting, PlatformPose, mounting_of
from vision.refine import Refinement
from vision.tracked_run import camera_and_plate, poses_from_sightings
from vision.tracker import Sighting, Tracker

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class LiveFrame:
    """One frame as soon as it is tracked.

    Attributes
    ----------
    frame
        Its number in the video.
    t_s
        The container's time of it, s; None where it has none.
    sighting
        What was seen.
    pose
        The platform's pose; relative to the first frame where the camera's pose is not stated.
    """

    frame: int
    t_s: float | None
    sighting: Sighting
    pose: PlatformPose | None

    def sentence(self) -> str:
        """One line for the terminal: pitch as it comes."""
        time = f"{self.t_s:9.3f} s" if self.t_s is not None else f"frame {self.frame:6d}"
        if self.pose is None:
            return f"{time}  no pose ({self.sighting.markers} markers)"
        pitch = np.rad2deg(self.pose.values[4])
        sigma = np.rad2deg(np.sqrt(self.pose.covariance[4, 4]))
        names = [
            flag.name.lower() for flag in FrameFlag if flag in self.sighting.flags and flag.name
        ]
        odd = f"  {', '.join(names).replace('_', ' ')}" if names else ""
        return f"{time}  pitch {pitch:+8.4f} deg  sigma {sigma:.4f}{odd}"


def follow_run(
    folder: Path,
    *,
    rig: Rig | None = None,
    refinement: Refinement | None = None,
    show: Callable[[LiveFrame], None] | None = None,
    notes: list[str] | None = None,
    patience_s: float = PATIENCE_S,
) -> "pd.DataFrame":
    """Track a run while it is recorded, and return the table of the whole.

    Parameters
    ----------
    folder
        The run's folder; start.json must be there.
    rig
        Another rig than the run's own.
    refinement
        What poses are fitted to; None takes the pixels.
    show
        Called with each frame as it comes.
    notes
        Takes what a user must know.
    patience_s
        After so long without a byte and without stop.json the run counts as interrupted.

    Returns
    -------
    DataFrame
        As `vision.track_run`: branches are chosen anew with all frames known.

    Raises
    ------
    DataError
        As `vision.track_run`; or no frame comes.
    """
    notes = [] if notes is None else notes
    run = load_run(folder)
    camera, plate = camera_and_plate(run, rig)
    tracker = Tracker(camera, plate, refinement)
    mounting: Mounting | None = mounting_of(rig or run.rig)
    known = (rig or run.rig).camera
    if known is not None and known.pose is None:
        mounting = None  # the first frame with a pose will be zero
    sightings: list[Sighting] = []
    video = folder / "video.mkv"
    stop = folder / "stop.json"
    for image, t_s in read_growing(video, stop.is_file, patience_s=patience_s):
        camera.check_size(image, str(video))
        sighting = tracker.see(image).sightings[0]
        sightings.append(sighting)
        pose = None
        if sighting.estimate is not None:
            if mounting is None:
                seen = [sighting.estimate.pose]
                mounting = mounting_of(rig or run.rig).with_camera_seeing_rest(seen)
            pose = mounting.platform(sighting.estimate.pose)
        if show:
            show(LiveFrame(len(sightings) - 1, t_s, sighting, pose))
    if not sightings:
        raise DataError("no frame came", where=str(video))
    run = load_run(folder)
    notes += run.notes
    return poses_from_sightings(run, sightings, tracker, camera, plate, rig=rig, notes=notes)
