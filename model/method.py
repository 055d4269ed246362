"""Integration methods as data: an explicit Runge-Kutta tableau and the steps it may take."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model import dop853

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Method:
    """An explicit Runge-Kutta method and the longest step it should take.

    Parameters
    ----------
    name
        As given to `simulate`.
    nodes, stage_weights, step_weights
        c_i, a_ij and b_i of the Butcher tableau: shapes (s,), (s, s) and (s,).
    longest_step_s
        Default step.
    steps_per_period
        Fewest steps in a period of the machine's highest tone.
    order
        Order of the method.
    """

    name: str
    nodes: Array
    stage_weights: Array
    step_weights: Array
    longest_step_s: float
    steps_per_period: float
    order: int

    def step_s(self, highest_tone_hz: float) -> float:
        """The longest step for a machine whose highest tone is given."""
        return min(self.longest_step_s, 1.0 / (self.steps_per_period * highest_tone_hz))


def runge_kutta_4() -> Method:
    """The classical method, at the paper's time step of 1e-4 s (Section 4.1)."""
    stage_weights = np.zeros((4, 4))
    stage_weights[1, 0] = stage_weights[2, 1] = 0.5
    stage_weights[3, 2] = 1.0
    return Method(
        name="rk4",
        nodes=np.array([0.0, 0.5, 0.5, 1.0]),
        stage_weights=stage_weights,
        step_weights=np.array([1.0, 2.0, 2.0, 1.0]) / 6.0,
        longest_step_s=1e-4,
        steps_per_period=33.0,
        order=4,
    )


def dormand_prince_853() -> Method:
    """The 8th-order method of Hairer, Norsett and Wanner (1993), Section II.5.

    At 1 ms it keeps a cable of 126 Hz to 3e-6 of its amplitude over 10 s (notes/solver.md);
    above 300 Hz it takes shorter steps.
    """
    stages = len(dop853.NODES)
    stage_weights = np.zeros((stages, stages))
    for stage, weights in enumerate(dop853.STAGE_WEIGHTS):
        stage_weights[stage, :stage] = weights
    return Method(
        name="dop853",
        nodes=np.array(dop853.NODES),
        stage_weights=stage_weights,
        step_weights=np.array(dop853.STEP_WEIGHTS),
        longest_step_s=1e-3,
        steps_per_period=1e3 / 300.0,
        order=8,
    )


METHODS = {"dop853": dormand_prince_853, "rk4": runge_kutta_4}


def find_method(name: str) -> Method:
    """The method of that name.

    Raises
    ------
    UsageError
        There is none.
    """
    if name not in METHODS:
        raise UsageError(f"no integration method {name!r}", allowed=", ".join(METHODS))
    return METHODS[name]()
