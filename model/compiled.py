"""The kernel compiled by numba, kept on disk so that a machine compiles it once.

numba's own cache looks at the file of the compiled function only, and would go on serving it after
a change in `cable` or `platform`. So the cache folder is named by a fingerprint of everything that
shapes the machine code: the sources, numba, Python and the processor.
"""

import hashlib
import os
import platform as computer
import tempfile
from collections.abc import Callable
from functools import cache
from inspect import isfunction
from pathlib import Path
from types import ModuleType
from typing import Any

Announce = Callable[[str], None]

COMPILING = "compiling the solver (once)..."


def compile_solver(announce: Announce | None = None) -> None:
    """Compile the kernel, or load it from the cache: for a command to call before long work.

    Parameters
    ----------
    announce
        Told one line if it has to be compiled, which takes some seconds.
    """
    integrator(announce)


def integrator(announce: Announce | None = None) -> Any:
    """`model.kernel.integrate`, compiled.

    Parameters
    ----------
    announce
        As for `compile_solver`.
    """
    if announce is not None and not _is_cached():
        announce(COMPILING)
    return _integrator()


def _kernel_modules() -> tuple[ModuleType, ...]:
    """Modules whose functions are compiled; any of their functions may be called in the kernel."""
    from model import cable, kernel, kinematics, platform

    return kinematics, cable, platform, kernel


def fingerprint() -> str:
    """Names all that shapes the machine code: change any of it, and the name is another."""
    import llvmlite
    import numba
    import numpy as np

    parts = [numba.__version__, llvmlite.__version__, np.__version__, computer.python_version()]
    parts += [computer.machine(), _processor()]
    parts += [Path(str(module.__file__)).read_text() for module in _kernel_modules()]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]


def _processor() -> str:
    """The processor's name and features: machine code for one may not run on another."""
    from llvmlite import binding

    return f"{binding.get_host_cpu_name()} {binding.get_host_cpu_features().flatten()}"


def cache_folder() -> Path | None:
    """Where this kernel's machine code is kept; None where nothing can be written."""
    user = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    root = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(user) / "cdpr8" / "numba")
    folder = root / f"kernel-{fingerprint()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return None
    return folder


def _is_cached() -> bool:
    folder = cache_folder()
    return folder is not None and any(folder.rglob("*.nbc"))


@cache
def _integrator() -> Any:
    import numba
    from numba.extending import register_jitable

    from model import kernel

    whole = kernel.integrate
    options = {"error_model": "numpy"}
    for module in _kernel_modules():
        for law in vars(module).values():
            # Each where it is defined, once: modules also hold what they import from each other.
            if isfunction(law) and law.__module__ == module.__name__ and law is not whole:
                register_jitable(**options)(law)
    folder = cache_folder()
    before = numba.config.CACHE_DIR
    try:
        numba.config.CACHE_DIR = str(folder or "")
        return numba.njit(cache=folder is not None, nogil=True, **options)(whole)
    finally:
        numba.config.CACHE_DIR = before
