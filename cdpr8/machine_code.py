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
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path


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


@contextmanager
def kept_in(folder: Path | None) -> Iterator[None]:
    """Functions that are made ``njit(cache=True)`` meanwhile are kept in this folder."""
    import numba

    with _ONE_AT_A_TIME:
        before = numba.config.CACHE_DIR
        try:
            numba.config.CACHE_DIR = str(folder or "")
            yield
        finally:
            numba.config.CACHE_DIR = before
