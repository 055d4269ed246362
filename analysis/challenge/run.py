"""`analysis challenge run`: every case diagnosed blind; the seal stays shut."""

import time
import traceback
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from analysis.challenge.seal import DIGEST, read_index
from model.jobs import HERE, Job, Row, Where, read_rows, run_jobs

ANSWERS = "answers.jsonl"
REPORTS = "diagnosis"

Diagnose = Callable[..., dict[str, Any]]


def run(
    folder: Path,
    *,
    where: Where = HERE,
    seed: int = 0,
    again: bool = False,
    diagnose: Diagnose | None = None,
    step: Callable[[], None] = lambda: None,
) -> int:
    """Diagnose every case; cases done before are not done again.

    Parameters
    ----------
    folder
        Of the challenge.
    where
        Where to run.
    seed
        Of the diagnosis.
    again
        Forget the answers there are.
    diagnose
        Takes the folders of a case's runs, `results` and `seed`, and returns the diagnosis;
        default: `analysis.diagnosis.diagnose_runs`.
    step
        Called after each case.

    Returns
    -------
    int
        How many cases ended in an error.
    """
    if diagnose is None:
        # A toolkit that cannot diagnose fails here, not in every case.
        _diagnosis()
    index = read_index(folder)
    answers = folder / ANSWERS
    if again:
        answers.unlink(missing_ok=True)
    published = (folder / DIGEST).read_text(encoding="utf-8").split()[0]
    jobs = [{"case": name, "runs": case["runs"]} for name, case in index["cases"].items()]
    failed = 0
    for _, row in run_jobs(
        partial(_diagnose_block, folder, diagnose),
        jobs,
        seed=seed,
        identity={"challenge": published},
        results=answers,
        where=where,
        block=1,
    ):
        failed += row["error"] is not None
        step()
    return failed


def answers_of(folder: Path) -> dict[str, Row]:
    """The rows of the answer file so far: case -> answer, error and seconds."""
    path = folder / ANSWERS
    if not path.exists():
        return {}
    return {row["case"]: row for _, row in read_rows(path)}


def _diagnose_block(folder: Path, diagnose: Diagnose | None, jobs: Sequence[Job]) -> list[Row]:
    return [_diagnose_case(folder, diagnose, job) for job in jobs]


def _diagnose_case(folder: Path, diagnose: Diagnose | None, job: Job) -> Row:
    """One case; whatever goes wrong in it is its answer, and the others go on."""
    case = str(job.values["case"])
    results = folder / REPORTS / case
    results.mkdir(parents=True, exist_ok=True)
    started = time.monotonic()
    answer, error = None, None
    try:
        folders = [folder / case / name for name in job.values["runs"]]
        answer = plain((diagnose or _diagnosis())(folders, results=results, seed=job.seed))
    except Exception as fault:  # a crash is a result of the challenge, not its end
        error = f"{type(fault).__name__}: {fault}"
        (results / "crash.txt").write_text(traceback.format_exc(), encoding="utf-8")
    return {
        "case": case,
        "answer": answer,
        "error": error,
        "seconds": round(time.monotonic() - started, 2),
    }


def _diagnosis() -> Diagnose:
    """The tool's own."""
    from analysis.diagnosis import diagnose_runs

    found: Diagnose = diagnose_runs
    return found


def plain(value: Any) -> Any:
    """A value as strict JSON holds it: arrays as lists, numbers that are none as null."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not abs(value) < float("inf"):
        return None
    if isinstance(value, Path):
        return str(value)
    return value
