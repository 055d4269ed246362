"""The poses of a run: those that stand in it, or tracked now from its video."""

from typing import TYPE_CHECKING

from cdpr8.errors import DataError
from cdpr8.runfolder import Run
from cdpr8.terminal import note

if TYPE_CHECKING:
    import pandas as pd


def poses_of(run: Run) -> "pd.DataFrame":
    """Columns of pose.csv for a run.

    Raises
    ------
    DataError
        The run has neither poses nor a video.
    """
    if run.pose is not None:
        return run.pose
    if run.video is None:
        raise DataError(
            "the run has neither pose.csv nor video.mkv, so there is no angle to compare",
            where=str(run.folder),
            remedy="record with a camera, or add a pose.csv (see docs/run-folder.md)",
        )
    from vision import track_run

    note(f"{run.name} has no pose.csv: tracking its video")
    return track_run(run)
