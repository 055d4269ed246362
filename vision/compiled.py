"""How the kernels of the photometric alignment are compiled by numba, and kept on disk.

They call each other across files, so their machine code is kept under a fingerprint of all of them
(`cdpr8.machine_code`).
"""

from functools import cache
from pathlib import Path
from typing import Any

from cdpr8 import machine_code

SOURCES = (
    "compiled.py",
    "marker_print.py",
    "projection_kernel.py",
    "point_spread_kernel.py",
    "normal_equations_kernel.py",
    "alignment_kernel.py",
)
"""What is compiled together, and what holds the constants frozen into it."""

FAST = {"contract", "reassoc", "nsz", "arcp", "afn"}
"""NaN must stay NaN: only re-ordering of sums and products is allowed."""


@cache
def cache_folder() -> Path | None:
    """Where the machine code is kept; None where nothing can be written."""
    here = Path(__file__).parent
    name = machine_code.fingerprint((here / source).read_text() for source in SOURCES)
    return machine_code.cache_folder(f"alignment-{name}")


def compiled(function: Any) -> Any:
    """A function as machine code, made or loaded at its first call."""
    return machine_code.kept(function, cache_folder(), error_model="numpy", fastmath=FAST)
