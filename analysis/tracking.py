"""The poses of a run: those that stand in it, or tracked now from its video."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from cdpr8.errors import DataError
from cdpr8.runfolder import Run

if TYPE_CHECKING:
    import pandas as pd


def poses_of(
    run: Run,
    notes: list[str] | None = None,
    step: Callable[[], None] | None = None,
    workers: int = 1,
) -> "pd.DataFrame":
    """Columns of pose.csv for a run.

    Parameters
    ----------
    run
        The run.
    notes
        Takes what a user must know, where the video is tracked.
    step
        Called once a frame that is tracked.
    workers
        Processes.

    Raises
    ------
    DataError
        The run has neither poses nor a video.
    """
    if run.pose is not None:
        if notes is not None and len(run.pose) < len(run.frames):
            notes.append(f"pose.csv covers {len(run.pose)} of {len(run.frames)} frames")
        return run.pose
    if run.video is None:
        raise DataError(
            "the run has neither pose.csv nor video.mkv, so there is no angle to compare",
            where=str(run.folder),
            remedy="record with a camera, or add a pose.csv (see docs/run-folder.md)",
        )
    from vision import track_run

    return track_run(run, notes=notes, step=step, workers=workers)
