"""The model: the paper's Eqs. 1 to 18, solved, and the physics it leaves out.

SI units and radians inside; degrees where a name says so. Cables are numbered 1 to 8, and arrays
hold cable ``i`` at index ``i - 1``.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from model.batch import jacobian as jacobian
    from model.batch import simulate_many as simulate_many
    from model.compiled import compile_solver as compile_solver
    from model.library.selection import ActiveEffect as ActiveEffect
    from model.machine import Machine as Machine
    from model.observation import Observation as Observation
    from model.observation import observe as observe
    from model.simulation import Simulation as Simulation
    from model.simulator import simulate as simulate
    from model.strings import Strings as Strings
    from model.task import Disturbance as Disturbance
    from model.task import Task as Task

_DOORS = {
    "ActiveEffect": "model.library.selection",
    "Disturbance": "model.task",
    "Machine": "model.machine",
    "Observation": "model.observation",
    "Simulation": "model.simulation",
    "Strings": "model.strings",
    "Task": "model.task",
    "compile_solver": "model.compiled",
    "jacobian": "model.batch",
    "observe": "model.observation",
    "simulate": "model.simulator",
    "simulate_many": "model.batch",
}

__all__ = [
    "ActiveEffect",
    "Disturbance",
    "Machine",
    "Observation",
    "Simulation",
    "Strings",
    "Task",
    "compile_solver",
    "jacobian",
    "observe",
    "simulate",
    "simulate_many",
]


def __getattr__(name: str) -> Any:
    """Open a door when it is used, so that ``--help`` does not wait for NumPy."""
    if name not in _DOORS:
        raise AttributeError(f"module 'model' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_DOORS[name]), name)
