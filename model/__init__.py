"""The model: the paper's Eqs. 1 to 18, solved.

SI units and radians inside; degrees where a name says so. Cables are numbered 1 to 8, and arrays
hold cable ``i`` at index ``i - 1``.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from model.compiled import compile_solver as compile_solver
    from model.machine import Machine as Machine
    from model.simulation import Simulation as Simulation
    from model.simulator import Disturbance as Disturbance
    from model.simulator import simulate as simulate

_DOORS = {
    "Disturbance": "model.simulator",
    "Machine": "model.machine",
    "Simulation": "model.simulation",
    "compile_solver": "model.compiled",
    "simulate": "model.simulator",
}

__all__ = ["Disturbance", "Machine", "Simulation", "compile_solver", "simulate"]


def __getattr__(name: str) -> Any:
    """Open a door when it is used, so that ``--help`` does not wait for NumPy."""
    if name not in _DOORS:
        raise AttributeError(f"module 'model' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_DOORS[name]), name)
