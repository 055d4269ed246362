"""Frequency and amplitude: one motion at many frequencies, each started in several ways."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from model.sweep.plan import Plan as Plan
    from model.sweep.run import sweep as sweep
    from model.sweep.statistics import by_frequency as by_frequency

_DOORS = {
    "Plan": "model.sweep.plan",
    "by_frequency": "model.sweep.statistics",
    "sweep": "model.sweep.run",
}

__all__ = ["Plan", "by_frequency", "sweep"]


def __getattr__(name: str) -> Any:
    """Open a door when it is used, so that ``--help`` does not wait for NumPy."""
    if name not in _DOORS:
        raise AttributeError(f"module 'model.sweep' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_DOORS[name]), name)
