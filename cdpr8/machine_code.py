"""Machine code that numba compiled, kept on disk so that a machine compiles it once.

numba's own cache looks at the file of the compiled function only, and would go on serving it after
a change in a file whose functions it calls. So the cache folder is named by a fingerprint of
everything that shapes the machine code: the sources, numba, Python and the processor.
"""

import hashlib
import os
import platform as computer
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

PATIENCE_S = 300.0
"""No longer is another process waited for, which may hang: to compile twice is only slower."""


def fingerprint(sources: Iterable[str]) -> str:
    """Names all that shapes the machine code: change any of it, and the name is another.

    Parameters
    ----------
    sources
        Texts of all that is compiled together, or frozen into it.
    """
    import llvmlite
    import numba
    import numpy as np

    parts = [numba.__version__, llvmlite.__version__, np.__version__, computer.python_version()]
    parts += [computer.machine(), _processor(), *sources]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]


def _processor() -> str:
    """The processor's name and features: machine code for one may not run on another."""
    from llvmlite import binding

    return f"{binding.get_host_cpu_name()} {binding.get_host_cpu_features().flatten()}"


def cache_folder(name: str) -> Path | None:
    """Where machine code of this name is kept; None where nothing can be written.

    Parameters
    ----------
    name
        What it is, with its fingerprint.
    """
    user = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    root = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(user) / "cdpr8" / "numba")
    folder = root / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return None
    return folder


_ONE_AT_A_TIME = threading.RLock()
"""numba has one folder for all: a thread that puts it back early makes another write its machine
code to where the user stands."""


def kept(function: Callable[..., Any], folder: Path | None, **options: Any) -> Any:
    """A function that numba compiles at its first call, or loads from a folder.

    Of processes that want the same machine code one compiles it; the others wait and load it.

    Parameters
    ----------
    function
        What is compiled.
    folder
        Where its machine code is kept; None: nowhere.
    options
        Of `numba.njit`.
    """
    import numba

    with _ONE_AT_A_TIME:
        before = numba.config.CACHE_DIR
        try:
            numba.config.CACHE_DIR = str(folder or "")
            with _wide_vectors():
                made = numba.njit(cache=folder is not None, **options)(function)
        finally:
            numba.config.CACHE_DIR = before
    if folder is not None:
        _by_one_process(made, folder / f"{function.__module__}.{function.__name__}.lock")
    return made


@contextmanager
def _wide_vectors() -> Iterator[None]:
    """While numba is asked for the first time: vectors of 512 bit where the processor has them.

    LLVM takes half of that on many, for their clocks' sake: sixteen simulations side by side then
    take 1.6 times as long. numba makes its target once in a process. What the user says of it
    (NUMBA_CPU_NAME, NUMBA_CPU_FEATURES), and a target that stands, are left as they are.
    """
    import numba
    from llvmlite import binding

    config = numba.config
    if config.CPU_NAME is not None or config.CPU_FEATURES is not None:
        yield
        return
    features = binding.get_host_cpu_features()
    if features.get("avx512f") and config.ENABLE_AVX:
        config.CPU_FEATURES = f"{features.flatten()},-prefer-256-bit"
    try:
        yield
    finally:
        config.CPU_FEATURES = None


def _by_one_process(made: Any, path: Path) -> None:
    """Let a process compile what no other compiles meanwhile."""
    from numba.core.compiler_lock import global_compiler_lock

    compile_it = made.compile

    def alone(signature: Any) -> Any:
        # numba's own lock first, always: two threads that took them in either order would wait
        # for each other.
        with global_compiler_lock, _alone(path):
            return compile_it(signature)

    made.compile = alone


@contextmanager
def _alone(path: Path) -> Iterator[None]:
    """While no other process is here; where a file cannot be locked, with others."""
    from filelock import FileLock

    lock = FileLock(path)
    with suppress(OSError, NotImplementedError):
        lock.acquire(timeout=PATIENCE_S)
    try:
        yield
    finally:
        lock.release()
