"""Laws as machine code, kept under a name that changes with any source of this package.

numba's own cache looks at one file only: it would go on serving a law after a change in another
file whose functions that law calls.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from cdpr8 import machine_code


def law(function: Callable[..., Any]) -> Any:
    """A function of numbers, tuples and arrays, compiled at its first call or loaded from disk."""
    return machine_code.kept(function, cache_folder())


@cache
def cache_folder() -> Path | None:
    """Where this plant's machine code is kept; None where nothing can be written."""
    sources = [path.read_text() for path in sorted(Path(__file__).parent.glob("*.py"))]
    return machine_code.cache_folder(f"outsider-{machine_code.fingerprint(sources)}")
