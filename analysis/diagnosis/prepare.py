"""From run folders to recordings: loading, tracking where needed, and finding the start."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from analysis.align import find_start_shift
from analysis.diagnosis.one_thread import one_thread_each
from analysis.diagnosis.onset import excitation_of, moved_by
from analysis.diagnosis.recording import Recording, recording
from analysis.series import measured_cables, measured_tension
from analysis.tracking import poses_of
from cdpr8.errors import DataError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, load_run
from model import simulate


def prepare(
    folders: Sequence[Path],
    *,
    rig: Rig | None = None,
    step: Callable[[], None] | None = None,
    workers: int = 1,
) -> tuple[Recording, ...]:
    """Load runs of one machine.

    Parameters
    ----------
    folders
        Run folders.
    rig
        The machine, where it is not the runs' own: each run keeps its own pretensions.
    step
        Called once a frame that is tracked.
    workers
        Processes.

    Raises
    ------
    DataError
        A run has nothing usable, or two have the same name.
    """
    return prepare_runs(runs_of_one_machine(folders), rig=rig, step=step, workers=workers)


def prepare_runs(
    runs: Sequence[Run],
    *,
    rig: Rig | None = None,
    step: Callable[[], None] | None = None,
    workers: int = 1,
) -> tuple[Recording, ...]:
    """As `prepare`, of runs that are loaded."""
    with one_thread_each():
        return tuple(_prepare(run, rig, step, workers) for run in runs)


def runs_of_one_machine(folders: Sequence[Path]) -> list[Run]:
    """Load runs of which each has a name of its own.

    Parameters
    ----------
    folders
        Run folders.

    Raises
    ------
    DataError
        A run has nothing usable, or two have the same name.
    """
    runs = [load_run(folder) for folder in folders]
    names = [run.name for run in runs]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if not doubled:
        return runs
    if len({run.folder.resolve() for run in runs}) < len(runs):
        raise DataError(
            f"the run {', '.join(doubled)} is named twice",
            allowed="each run once",
            remedy="more runs of the machine, not more of one run, make a campaign",
        )
    raise DataError(
        f"two runs are called {', '.join(doubled)}",
        allowed="folders of different names",
        remedy="rename one: what is found is told by the run's name",
    )


def _prepare(run: Run, rig: Rig | None, step: Callable[[], None] | None, workers: int) -> Recording:
    if rig is not None:
        run = replace(run, rig=_with_pretensions_of(run.rig, rig))
    notes: list[str] = []
    try:
        pose = poses_of(run, notes, step, workers)
    except DataError:
        pose = None
    shift = 0.0
    if not run.start.motion_start_known and run.start.excitation.amplitude_deg > 0.0:
        shift = _shift(run)
        notes.append(
            f"the run does not say when its motion started: found {shift:+.3f} s from "
            "what it says; what is late in pose and tensions alike cannot be told"
        )
    made = recording(run, pose, shift)
    excitation, moved = excitation_of(made)
    if moved:
        made = recording(moved_by(run, excitation), pose, shift)
        notes += moved
    return replace(made, notes=(*run.notes, *notes, *made.notes))


def _with_pretensions_of(own: Rig, rig: Rig) -> Rig:
    cables = tuple(
        cable.model_copy(update={"pretension_n": mine.pretension_n})
        for cable, mine in zip(rig.cable, own.cable, strict=True)
    )
    return rig.model_copy(update={"cable": cables})


def _shift(run: Run) -> float:
    """How much later than the run says its motion started, from its largest tension."""
    simulation = simulate(run.rig, run.start.excitation)
    series = [measured_tension(run, cable) for cable in measured_cables(run)]
    largest = max(series, key=lambda one: float(one.value.std()))
    cable = int(largest.name.split()[-1])
    varies = np.asarray(simulation.tension_variation_n[:, cable - 1])
    return find_start_shift(simulation.t_s, varies, largest)
