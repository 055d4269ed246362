"""Many independent jobs: through joblib, on this computer or a Dask cluster, resumed after a kill.

The door is `run_jobs`. Work is done in blocks, reduced to rows where it is done, and only rows
travel. A row is a flat dictionary that JSON can hold; a job that fails in an expected way is a row
with a status.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import IO, Any, TypeAlias

import numpy as np

from cdpr8.errors import DataError, UsageError

Row: TypeAlias = dict[str, Any]

FORMAT = "cdpr8 jobs 1"

BLOCK = 16
"""Jobs done together: the lanes of one call of a lane kernel."""

SCHEDULER_WAIT_S = 10.0


@dataclass(frozen=True)
class Job:
    """One job.

    Parameters
    ----------
    number
        Its place in the list, from 0.
    values
        What it is about.
    seed
        The one seed of all jobs.
    """

    number: int
    values: Mapping[str, Any]
    seed: int

    def generator(self) -> np.random.Generator:
        """Its own random numbers: of the child ``SeedSequence(seed).spawn(...)[number]``."""
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(self.number,)))


Work: TypeAlias = Callable[[Sequence[Job]], list[Row]]
"""What does a block of jobs: a row for each. It is pickled, so a function of a module, or a
``functools.partial`` of one."""


@dataclass(frozen=True)
class Where:
    """Where jobs run.

    Parameters
    ----------
    workers
        Processes on this computer; 1 runs in this one, -1 takes one for each core.
    scheduler
        Address of a Dask scheduler, "tcp://host:8786"; its workers are used instead.
    """

    workers: int = 1
    scheduler: str | None = None


HERE = Where()


def run_jobs(
    work: Work,
    jobs: Sequence[Mapping[str, Any]],
    *,
    seed: int,
    identity: Mapping[str, Any],
    results: Path | None = None,
    where: Where = HERE,
    block: int = BLOCK,
) -> Iterator[tuple[int, Row]]:
    """Do jobs and yield their rows as they come.

    Parameters
    ----------
    work
        Does a block of jobs.
    jobs
        What each job is about.
    seed
        Each job draws from its own child of this seed, wherever it runs.
    identity
        What, beside seed and number of jobs, decides the rows: rig, options, version. It is
        written down, and a file of anything else is refused.
    results
        Rows are appended to this file as they come. Where it exists, its rows are yielded first
        and their jobs are not done again; a last line torn by a kill is dropped.
    where
        Where to run.
    block
        Jobs given to a worker at a time.

    Yields
    ------
    tuple of int and dict
        Number of a job and its row, in no particular order. Nothing is held here.

    Raises
    ------
    DataError
        `results` belongs to other jobs.
    UsageError
        No scheduler answers.
    """
    if block < 1 or where.workers == 0 or where.workers < -1:
        raise UsageError(
            f"{where.workers} workers, blocks of {block} jobs",
            allowed="at least 1 worker, or -1 for one a core; blocks of at least 1",
        )
    header = _header(seed, identity, len(jobs))
    done = np.zeros(len(jobs), dtype=bool)
    with ExitStack() as stack:
        file = None
        if results is not None:
            file = stack.enter_context(_opened(results, header))
            for number, row in _rows(file):
                if 0 <= number < done.size and not done[number]:
                    done[number] = True
                    yield number, row
        left = (Job(n, jobs[n], seed) for n in np.flatnonzero(~done).tolist())
        for part in _parts(work, left, where, block, stack):
            if file is not None:
                file.writelines(_line({"number": n, "row": row}) for n, row in part)
                file.flush()
            yield from part


def read_rows(results: Path) -> Iterator[tuple[int, Row]]:
    """Rows of a result file as far as they are whole, one at a time."""
    with results.open("rb") as file:
        file.readline()
        yield from _rows(file)


def _header(seed: int, identity: Mapping[str, Any], count: int) -> dict[str, Any]:
    header = {"format": FORMAT, "seed": seed, "jobs": count, "identity": dict(identity)}
    # As it will be read: tuples become lists.
    return dict(json.loads(json.dumps(header)))


def _line(value: object) -> bytes:
    return json.dumps(value, allow_nan=False).encode() + b"\n"


def _opened(path: Path, header: dict[str, Any]) -> IO[bytes]:
    """The result file, its torn last line cut off, set behind its header."""
    file = path.open("r+b" if path.exists() else "w+b")
    try:
        _cut_torn_line(file)
        first = file.readline()
        if not first:
            file.write(_line(header))
            file.flush()
            return file
        found = _parsed(first)
        if found != header:
            raise DataError(
                f"holds the results of other jobs: {_difference(found, header)}",
                where=str(path),
                remedy="go on with the same rig, options and seed, or write to another place",
            )
    except BaseException:
        file.close()
        raise
    return file


def _cut_torn_line(file: IO[bytes]) -> None:
    """Drop what follows the last end of line, looking from the end."""
    end = file.seek(0, 2)
    at = end
    while at > 0:
        step = min(65536, at)
        at = file.seek(at - step)
        newline = file.read(step).rfind(b"\n")
        if newline >= 0:
            at += newline + 1
            break
    if at < end:
        file.truncate(at)
    file.seek(0)


def _rows(file: IO[bytes]) -> Iterator[tuple[int, Row]]:
    for line in file:
        if not line.endswith(b"\n"):
            return
        entry = _parsed(line)
        if not isinstance(entry.get("number"), int) or not isinstance(entry.get("row"), dict):
            raise DataError(f"holds a line that is no result: {line[:60]!r}", where=str(file.name))
        yield entry["number"], entry["row"]


def _parsed(line: bytes) -> dict[str, Any]:
    try:
        value = json.loads(line)
    except ValueError:
        return {}
    return value if isinstance(value, dict) else {}


def _difference(found: Mapping[str, Any], wanted: Mapping[str, Any]) -> str:
    if found.get("format") != wanted["format"]:
        return f"format {found.get('format')!r}, here {wanted['format']!r}"
    for key in ("seed", "jobs"):
        if found.get(key) != wanted[key]:
            return f"{key} {found.get(key)}, here {wanted[key]}"
    theirs, ours = found.get("identity", {}), wanted["identity"]
    keys = sorted(key for key in {*theirs, *ours} if theirs.get(key) != ours.get(key))
    return f"{', '.join(keys)} differ" if keys else "the headers differ"


def _parts(
    work: Work, jobs: Iterator[Job], where: Where, block: int, stack: ExitStack
) -> Iterator[list[tuple[int, Row]]]:
    """Numbers and rows, block by block, as they come."""
    blocks = iter(lambda: list(islice(jobs, block)), [])
    if where.workers == 1 and where.scheduler is None:
        yield from (_done(work, part) for part in blocks)
        return
    import joblib

    if where.scheduler is not None:
        stack.enter_context(_cluster(where.scheduler))
        parallel = joblib.Parallel(return_as="generator_unordered")
    else:
        # One thread each: the processes are the parallelism.
        stack.enter_context(joblib.parallel_config(backend="loky", inner_max_num_threads=1))
        parallel = joblib.Parallel(n_jobs=where.workers, return_as="generator_unordered")
    yield from parallel(joblib.delayed(_done)(work, part) for part in blocks)


def _done(work: Work, block: Sequence[Job]) -> list[tuple[int, Row]]:
    """Runs where the work is done."""
    rows = work(block)
    return [(job.number, row) for job, row in zip(block, rows, strict=True)]


def _cluster(address: str) -> AbstractContextManager[object]:
    """Make joblib use a Dask cluster; closes the connection at the end."""
    try:
        from distributed import Client
    except ImportError:
        raise UsageError(
            "--scheduler needs Dask, which is not installed", remedy="pip install 'cdpr8[cluster]'"
        ) from None
    import joblib

    stack = ExitStack()
    try:
        client = stack.enter_context(
            Client(address, timeout=SCHEDULER_WAIT_S, set_as_default=False)
        )
        client.wait_for_workers(1, timeout=SCHEDULER_WAIT_S)
    except (OSError, ValueError) as error:
        stack.close()
        raise UsageError(
            f"no Dask scheduler with a worker answers at {address!r}: {error}",
            allowed="an address like tcp://host:8786",
            remedy="start one with `dask scheduler`, and workers with `dask worker ADDRESS`",
        ) from None
    stack.enter_context(joblib.parallel_config(backend="dask", client=client))
    return stack
