"""Laws as machine code, kept under a name that changes with any of them.

numba's own cache goes on serving a law after a change in another one that it calls: data would then
be made by laws that stand nowhere.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from cdpr8 import machine_code


def law(function: Callable[..., Any]) -> Any:
    """A function of numbers and arrays, compiled, or loaded from the cache, at its first call."""
    return machine_code.kept(function, cache_folder())


@cache
def cache_folder() -> Path | None:
    """Where the plant's machine code is kept; None where nothing can be written."""
    sources = [one.read_text() for one in sorted(Path(__file__).parent.glob("*.py"))]
    return machine_code.cache_folder(f"plant-{machine_code.fingerprint(sources)}")
