"""What commands load: runs of one machine, tracked where there are no poses yet."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cdpr8.terminal import note, progress

if TYPE_CHECKING:
    from analysis.diagnosis.recording import Recording
    from cdpr8.rigfile import Rig


def load_recordings(
    folders: Sequence[Path], rig: "Rig | None", workers: int = 1
) -> "tuple[Recording, ...]":
    """Load runs with progress shown, and say which of them are tracked.

    Parameters and errors are those of `analysis.diagnosis.prepare.prepare`.
    """
    from analysis.diagnosis.prepare import prepare_runs, runs_of_one_machine

    runs = runs_of_one_machine(folders)
    untracked = [run for run in runs if run.pose is None and run.video is not None]
    for run in untracked:
        note(f"{run.name} has no pose.csv: tracking its video")
    with progress("tracking", sum(len(run.frames) for run in untracked) or None) as step:
        return prepare_runs(runs, rig=rig, step=step, workers=workers)
