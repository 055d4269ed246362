"""Processes that work beside this one: what takes long here is mostly Python's own."""

import math
import os
import pickle
import signal
import threading
import time
import warnings
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor, Future
from functools import lru_cache
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, ClassVar, Generic, Protocol, TypeVar
from weakref import finalize

from threadpoolctl import threadpool_limits

Work = TypeVar("Work")
Done = TypeVar("Done")
Work_contra = TypeVar("Work_contra", contravariant=True)
Done_co = TypeVar("Done_co", covariant=True)

USUAL = 2
"""Processes of a command that is not told how many."""

IDLE_S = 60.0
"""A process that had nothing to do for so long ends."""

GROWS_BYTES = 2_000_000_000
"""One that has grown by more than this since it started is replaced (loky's own limit: 300 MB)."""

LOOK_S = 2.0
"""So often a copy looks whether the process that asked is still there."""

FEW = 30
"""Work is done in this process until so much was done, unless others are there for another crew: to
start them takes seconds."""

AWAKE_S = 0.5 * IDLE_S
"""Those that had something to do so recently are still there."""

_LOADED: set[str] = set()
"""Of a copy: the files it was made from."""


class Worker(Protocol[Work_contra, Done_co]):
    """What does the work; its copy in another process does the same."""

    def do(self, work: Work_contra) -> Done_co:
        """One piece of work."""
        ...


class Crew(Generic[Work, Done]):
    """A worker and its copies in other processes.

    Parameters
    ----------
    worker
        Is copied when the others are first wanted: what it is must not change after that.
    processes
        With this one.
    long
        Each piece of work takes longer than a process needs to start: the others begin at once.
    """

    answered_s: ClassVar[float] = -math.inf
    """When others last answered any crew, on the monotonic clock."""

    def __init__(self, worker: Worker[Work, Done], processes: int, *, long: bool = False) -> None:
        self._worker = worker
        self._others = processes - 1
        self._long = long
        self._seen = 0
        self._path: Path | None = None
        self._ready: list[Future[Any]] = []

    def do(self, work: Sequence[Work]) -> list[Done]:
        """All of the work, in its order.

        What each piece comes to does not depend on who does it.
        """
        self._seen += len(work)
        mine, theirs = self._stripes(work)
        away: list[Future[list[Done]]] = [
            self._executor().submit(_do, str(self._path), [work[i] for i in one]) for one in theirs
        ]
        found: dict[int, Done] = {i: self._worker.do(work[i]) for i in mine}
        for stripe, future in zip(theirs, away, strict=True):
            try:
                done = future.result()
            except BrokenExecutor:
                # A process that the system ended takes nothing with it: its part is done here.
                self._others = 0
                done = [self._worker.do(work[i]) for i in stripe]
            else:
                Crew.answered_s = time.monotonic()
            found.update(zip(stripe, done, strict=True))
        return [found[i] for i in range(len(work))]

    def _stripes(self, work: Sequence[Work]) -> tuple[range, list[range]]:
        """Which pieces this process does, and the others: none, until they are ready."""
        processes, count = self._others + 1, len(work)
        awake = self._long or time.monotonic() - Crew.answered_s < AWAKE_S
        if processes == 1 or count < 2 or (self._seen < FEW and not awake):
            return range(count), []
        if self._path is None:
            self._copy()
            if not awake:
                self._start(work[0])
        if not all(one.done() for one in self._ready):
            return range(count), []
        if any(one.exception() is not None for one in self._ready):
            self._others = 0
            return range(count), []
        first, *others = (range(i, count, processes) for i in range(processes))
        return first, [one for one in others if one]

    def _copy(self) -> None:
        """Leave the worker where the others find it."""
        with NamedTemporaryFile(prefix="cdpr8-", suffix=".pickle", delete=False) as file:
            pickle.dump(self._worker, file)
        self._path = Path(file.name)
        finalize(self, self._path.unlink, missing_ok=True)

    def _start(self, work: Work) -> None:
        """Start the others, each with a piece of work that is only to make it ready."""
        executor = self._executor()
        self._ready = [executor.submit(_do, str(self._path), [work]) for _ in range(self._others)]

    def _executor(self) -> Any:
        # What others load is no leak: to replace them for that costs the seconds they are to save.
        os.environ.setdefault("LOKY_MAX_MEMORY_LEAK_SIZE", str(GROWS_BYTES))
        from loky import get_reusable_executor

        # One that has grown too much is replaced, which nobody has to know.
        warnings.filterwarnings("ignore", message="A worker was restarted", category=UserWarning)
        return get_reusable_executor(max_workers=self._others, timeout=IDLE_S, initializer=_serve)


def _serve() -> None:
    """Ctrl-C is for the process that asked; where that was killed, this one ends too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if os.name == "posix":
        threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()


def _end_with(asker: int) -> None:
    """What a killed process could not clear away goes too."""
    while os.getppid() == asker:
        time.sleep(LOOK_S)
    for path in tuple(_LOADED):
        Path(path).unlink(missing_ok=True)
    os._exit(1)


@lru_cache(maxsize=2)
def _worker_at(path: str) -> Worker[Any, Any]:
    with open(path, "rb") as file:
        worker: Worker[Any, Any] = pickle.load(file)
    _LOADED.add(path)
    # What is loaded by now has its threads: the processes are the parallelism.
    threadpool_limits(1)
    return worker


def _do(path: str, work: Sequence[Any]) -> list[Any]:
    worker = _worker_at(path)
    return [worker.do(one) for one in work]
