"""The kernel compiled by numba, kept on disk under a fingerprint of all its sources.

See `cdpr8.machine_code` for why.
"""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from inspect import isfunction
from pathlib import Path
from types import ModuleType
from typing import Any

from cdpr8 import machine_code

Announce = Callable[[str], None]

COMPILING = "compiling the solver (once)..."

FAST = {"reassoc", "nsz", "arcp", "contract", "afn"}
"""What the lane kernel may do to arithmetic. Not "nnan" nor "ninf": a NaN must stay one."""


UNCOUNTED = {"_nrt": False}
"""No counting of references to arrays: their counts, atomic, took most of the time. So compiled
functions allocate nothing, and return no part of an array: Python gives them their room."""

INLINE = (
    "acceleration", "bent", "cable", "cable_pull", "cable_rates", "derivative", "eased", "held",
    "platform_wrench", "sine_cosine", "_way",
)  # fmt: skip
"""Small next to their many arguments: a call would cost more than the work. A simulation with any
law of the cables took twice as long where `cable_pull` and `cable_rates` were called."""

CALLED = {
    "integrate": "runge_kutta",
    "derivatives": "kernel",
    "observe": "kernel",
    "drive_wrench": "kernel",
    "integrate_lanes": "lane_steps",
    "observe_lanes": "lanes",
    "between_rows": "loops",
    "follow_play": "loops",
}
"""Functions that Python calls, and the module of `model` each is in; all others of these modules
are compiled into them."""

LANES = ("lane_sine", "lanes", "lane_steps")
"""Modules of the lane kernel."""


def compile_solver(announce: Announce | None = None) -> None:
    """Compile the kernel, or load it from the cache: for a command to call before long work.

    Parameters
    ----------
    announce
        Told one line if it has to be compiled, which takes some seconds.
    """
    integrator(announce)


def integrator(announce: Announce | None = None) -> Any:
    """`model.runge_kutta.integrate`, compiled.

    Parameters
    ----------
    announce
        As for `compile_solver`.
    """
    if announce is not None and not _is_cached("runge_kutta.integrate"):
        announce(COMPILING)
    return compiled("integrate")


def lane_integrator(announce: Announce | None = None) -> Any:
    """`model.lane_steps.integrate_lanes`, compiled.

    Parameters
    ----------
    announce
        As for `compile_solver`.
    """
    if announce is not None and not _is_cached("lane_steps.integrate"):
        announce(COMPILING)
    return compiled("integrate_lanes")


def _kernel_modules() -> tuple[ModuleType, ...]:
    """Modules whose functions are compiled; any of their functions may be called in the kernel."""
    from model import (
        cable,
        kernel,
        kinematics,
        lane_sine,
        lane_steps,
        lanes,
        loops,
        platform,
        runge_kutta,
    )
    from model.library import assembled, bristle, context, smooth, taut_string
    from model.library import lanes as layout
    from model.library.discovery import effect_modules

    return (
        kinematics,
        cable,
        platform,
        smooth,
        bristle,
        taut_string,
        context,
        layout,
        *effect_modules(),
        assembled,
        kernel,
        runge_kutta,
        lane_sine,
        lanes,
        lane_steps,
        loops,
    )


def fingerprint() -> str:
    """Names all that shapes the kernel's machine code, as `cdpr8.machine_code.fingerprint`."""
    from model.library import assembled

    own = [assembled.TEXT, Path(__file__).read_text()]
    laws = [Path(str(module.__file__)).read_text() for module in _kernel_modules()]
    return machine_code.fingerprint(own + laws)


def cache_folder() -> Path | None:
    """Where this kernel's machine code is kept; None where nothing can be written."""
    return machine_code.cache_folder(f"kernel-{fingerprint()}")


def _is_cached(name: str) -> bool:
    folder = cache_folder()
    return folder is not None and any(folder.rglob(f"{name}*.nbc"))


@cache
def compiled(name: str) -> Any:
    """A function of `CALLED`, compiled or from the cache, at its first call."""
    module = import_module(f"model.{CALLED[name]}")
    options: dict[str, Any] = {"error_model": "numpy", **UNCOUNTED, **_fast(module)}
    _compile_laws()
    whole = getattr(module, name)
    return machine_code.kept(whole, cache_folder(), nogil=True, **options)


def _fast(module: ModuleType) -> dict[str, Any]:
    inside = module.__name__.removeprefix("model.") in LANES
    return {"fastmath": FAST} if inside else {}


@cache
def _compile_laws() -> None:
    """Let the kernel call every function of its modules but those that Python calls.

    Laws of effects become part of what calls them: a loop over lanes that calls is none of vectors.
    """
    from numba.extending import register_jitable

    from model.library.discovery import effect_modules

    for module in _kernel_modules():
        for law in vars(module).values():
            # Each where it is defined, once: modules also hold what they import from each other.
            if isfunction(law) and law.__module__ == module.__name__ and law.__name__ not in CALLED:
                inline = {"forceinline": law.__name__ in INLINE or module in effect_modules()}
                register_jitable(error_model="numpy", **UNCOUNTED, **_fast(module), **inline)(law)
