"""Loops over lanes are made loops of vectors: one that is not takes up to twice as long."""

import subprocess
import sys

ASKED = """
import llvmlite.binding as llvm
for what in ("", "-missed"):
    llvm.set_option("", f"--pass-remarks{what}=loop-vectorize")
from inspect import signature
import numba
from model import compiled
from model.library import assembled
from model.library.discovery import kernel_effects
compiled._compile_laws()
words, numbers = numba.int64[::1], numba.float64[::1]
KINDS = {"i": numba.int64, "on": numba.int64, "offset": words, "carrier": words}
for name in ("lane_pull", "lane_rates", "lane_wrench"):
    law = getattr(assembled, name)
    kinds = tuple(KINDS.get(one, numbers) for one in signature(law).parameters)
    options = dict(error_model="numpy", fastmath=compiled.FAST, **compiled.UNCOUNTED)
    numba.njit(kinds, **options)(law)
"""
"""Compiles what calls all laws for the lanes, and lets the compiler tell what it does to loops."""


def test_every_loop_over_lanes_is_one_of_vectors() -> None:
    from model.library.assembled import TEXT

    run = [sys.executable, "-c", ASKED]
    told = subprocess.run(run, capture_output=True, text=True, check=True).stderr
    remarks = [line for line in told.splitlines() if "loop" in line]
    missed = [line for line in remarks if "not vectorized" in line]
    assert missed == []
    assert len([line for line in remarks if "vectorized loop" in line]) >= TEXT.count("in range(l")
