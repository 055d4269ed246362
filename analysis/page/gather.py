"""What the page shows: results that are there, and those that have to be made first."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.diagnosis.pictures import Pictures
from analysis.diagnosis.results import Result, read, write
from cdpr8.rigfile import load_rig
from cdpr8.runfolder import Run, load_run, results_folder

BEFORE, AFTER = "compare.json", "compare_improved.json"


@dataclass(frozen=True)
class Material:
    """All that the page shows.

    Attributes
    ----------
    name
        Of the run.
    statement
        Of the diagnosis.
    pictures
        Its arrays; None: no figures of the run.
    before, after
        The paper's Section 5 with the run's own rig file, and with the improved one; None: there is
        none.
    made
        What had to be made for the page, in words.
    """

    name: str
    statement: dict[str, Any]
    pictures: Pictures | None
    before: dict[str, Any] | None
    after: dict[str, Any] | None
    made: tuple[str, ...]


def gather(folder: Path, *, workers: int, say: Callable[[str], None]) -> Material:
    """Read what is there of a run, and make what is missing.

    Parameters
    ----------
    folder
        Of the run.
    workers
        Threads, where it must be diagnosed.
    say
        Told of what is made.
    """
    run = load_run(folder)
    results = results_folder(folder)
    made: list[str] = []
    result = read(results)
    if result is None or not _complete(result, run):
        say(f"{results} holds no diagnosis of {run.name} with its figures: diagnosing it now")
        result = _diagnose(folder, results, workers)
        made.append("the diagnosis")
    improved = results / "improved.toml"
    before = _stored(results / BEFORE, run)
    after = _stored(results / AFTER, run)
    if improved.is_file() and after is not None and _older(results / AFTER, improved):
        after = None
    wanted = improved.is_file() and bool(result.statement["improved_rig"])
    if before is None or (wanted and after is None):
        say(f"comparing {run.name} with its simulation")
        before, after = _compare(run, results, improved if wanted else None)
        made.append("the comparison")
    return Material(
        run.name, result.statement, result.pictures, before, after if wanted else None, tuple(made)
    )


def _complete(result: Result, run: Run) -> bool:
    """Whether it is of this run, and has all that the page shows."""
    said = result.statement
    runs = said.get("provenance", {}).get("runs", [])
    return (
        result.pictures is not None
        and "words" in said
        and said["verdict"] != "not asked"
        and any(one["id"] == run.start.id for one in runs)
    )


def _diagnose(folder: Path, results: Path, workers: int) -> Result:
    from analysis.diagnose_command import run_diagnosis
    from analysis.diagnosis.prepare import prepare
    from model import compile_solver

    compile_solver()
    result = run_diagnosis(prepare([folder]), results, workers=workers)
    write(result, results)
    return result


def _stored(path: Path, run: Run) -> dict[str, Any] | None:
    """A comparison of this run; None: there is none that can be read."""
    try:
        stored: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    # A comparison with another rig file was stored by somebody who asked for that one.
    own = path.name == AFTER or stored.get("rig") in ("None", "rig.toml of the run")
    return stored if stored.get("run_id") == run.start.id and own else None


def _older(path: Path, other: Path) -> bool:
    return path.stat().st_mtime < other.stat().st_mtime


def _compare(
    run: Run, results: Path, improved: Path | None
) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """The paper's Section 5 before and after; None where the run has nothing to compare."""
    from analysis.compare import compare
    from analysis.comparison_table import as_dictionary
    from analysis.tracking import poses_of
    from cdpr8.errors import DataError
    from model import compile_solver

    compile_solver()
    try:
        poses = poses_of(run)
        before = as_dictionary(compare(run, poses))
        after = None
        if improved is not None:
            rig = load_rig(improved)
            after = as_dictionary(compare(run, poses, rig, rig_name=str(improved)))
    except DataError:
        return None, None
    results.mkdir(parents=True, exist_ok=True)
    for name, found in ((BEFORE, before), (AFTER, after)):
        if found is not None:
            (results / name).write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return before, after
