"""`diagnose_runs`: from run folders to a diagnosis, its statement and an improved rig file."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.diagnosis.improve import write_improved
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.one_thread import one_thread_each
from analysis.diagnosis.prepare import prepare
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.statement import statement
from analysis.engine.diagnosis import Diagnosis, Stage, diagnose
from analysis.engine.finder import Tell
from cdpr8.errors import RigFileError
from cdpr8.rigfile import Rig

RESULT = "diagnose.json"

NOT_IMPROVED = (
    "there is no improved rig file: the fit has come to numbers that no rig file may hold "
    "({where}: {what}), which speaks against what is named"
)


SHOWN = (
    "no improved rig file is written: samples show what is named, and the simulation does not "
    "follow them with it either"
)


@dataclass(frozen=True)
class RunDiagnosis:
    """A diagnosis of runs.

    Attributes
    ----------
    machine
        The runs as a system, as far as they count.
    diagnosis
        What the engine found.
    statement
        The same as the JSON of design, section 6.
    improved
        Where the improved rig file was written; None: there was nothing to improve.
    """

    machine: RecordedMachine
    diagnosis: Diagnosis
    statement: dict[str, Any]
    improved: Path | None

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """The runs."""
        return self.machine.recordings


def diagnose_recordings(
    recordings: Sequence[Recording],
    *,
    results: Path | None = None,
    effects: Sequence[str] | None = None,
    stop_after: Stage | None = None,
    workers: int = 2,
    tell: Tell | None = None,
) -> RunDiagnosis:
    """Diagnose runs of one machine.

    Parameters
    ----------
    recordings
        The runs.
    results
        Folder that takes `diagnose.json` and `improved.toml`; None: nothing is written.
    effects
        Names of the effects to consider; None: all.
    stop_after
        See `analysis.engine.diagnose`.
    workers
        Processes.
    tell
        Told of progress.
    """
    with one_thread_each():
        machine = RecordedMachine(recordings, effects, workers).with_strings()
        diagnosis = diagnose(machine, stop_after=stop_after, tell=tell)
    if diagnosis.system.bundles is not machine.bundles:
        machine = machine.looked_at_in(diagnosis.system.bundles)
    if diagnosis.system.nuisances is not machine.nuisances:
        machine = machine.known_as(diagnosis.system.nuisances)
    said = statement(machine, diagnosis)
    improved = None
    if results is not None:
        results.mkdir(parents=True, exist_ok=True)
        judgement = diagnosis.judgement
        if judgement is not None and judgement.shown:
            said["notes"].append(SHOWN)
        elif judgement is not None and judgement.causes:
            try:
                improved = write_improved(machine, diagnosis, results / "improved.toml")
                said["improved_rig"] = str(improved)
            except RigFileError as error:
                said["notes"].append(NOT_IMPROVED.format(where=error.where, what=error.what))
        (results / RESULT).write_text(json.dumps(said, indent=1) + "\n", encoding="utf-8")
    return RunDiagnosis(machine, diagnosis, said, improved)


def diagnose_runs(
    folders: Sequence[Path],
    *,
    results: Path | None = None,
    seed: int = 0,
    rig: Rig | None = None,
    workers: int = 2,
    look_ahead: bool = False,
) -> dict[str, Any]:
    """Diagnose run folders of one machine.

    Parameters
    ----------
    folders
        Run folders.
    results
        Folder that takes what is written; None: nothing is.
    seed
        Unused so far: nothing here is drawn.
    rig
        The machine, where it is not the runs' own.
    workers
        Processes.
    look_ahead
        Whether to simulate what could be recorded next, where the verdict is ambiguous: some
        seconds more.

    Returns
    -------
    dict
        The JSON of design, section 6.
    """
    del seed
    found = diagnose_recordings(prepare(folders, rig=rig), results=results, workers=workers)
    if look_ahead:
        from analysis.diagnosis.experiments import next_experiment, survey

        ambiguous = found.diagnosis.verdict == "ambiguous"
        looked = survey(found.machine, found.diagnosis, workers) if ambiguous else None
        found.statement["next_experiment"] = next_experiment(
            found.machine, found.diagnosis, looked, results
        )
    return found.statement
