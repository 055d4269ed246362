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
        c_i, a_ij and b_i of the Butcher tableau: shapes (s,), (s, s) and (m,). The stages beyond
        the first m serve values inside a step only.
    longest_step_s
        Default step.
    steps_per_period
        Fewest steps in a period of the machine's highest tone.
    order
        Order of the method.
    inside
        Whether it gives values inside a step.
    """

    name: str
    nodes: Array
    stage_weights: Array
    step_weights: Array
    longest_step_s: float
    steps_per_period: float
    order: int
    inside: bool = False

    def weights_inside(self, share: Array) -> Array:
        """Weights of all stages for values inside a step.

        Parameters
        ----------
        share
            How far into the step, 0 to 1, shape (n,).

        Returns
        -------
        Array
            Shape (n, s): the value is start + step * (weights . rates).
        """
        interpolants = _interpolants(self)
        polynomial = np.empty((share.size, len(interpolants)))
        product = np.ones_like(share)
        for power in range(len(interpolants)):
            product = product * (share if power % 2 == 0 else 1.0 - share)
            polynomial[:, power] = product
        return polynomial @ interpolants

    def step_s(self, highest_tone_hz: float) -> float:
        """The longest step for a machine whose highest tone is given."""
        return min(self.longest_step_s, 1.0 / (self.steps_per_period * highest_tone_hz))


def _interpolants(method: Method) -> Array:
    """F_1 to F_7 of the interpolant of DOP853, by stages, shape (7, s)."""
    stages = len(method.nodes)
    step = np.zeros(stages)
    step[: method.step_weights.size] = method.step_weights
    first, last = np.zeros(stages), np.zeros(stages)
    first[0], last[method.step_weights.size] = 1.0, 1.0
    return np.vstack(
        [step, first - step, 2.0 * step - last - first, np.array(dop853.DENSE_WEIGHTS)]
    )


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

    Eight steps in a period keep a cable to 3e-6 of its amplitude over a thousand periods
    (notes/solver.md); values between the ends of a step come from its interpolant.
    """
    nodes = (*dop853.NODES, *dop853.DENSE_NODES)
    stages = len(nodes)
    rows = (*dop853.STAGE_WEIGHTS, dop853.STEP_WEIGHTS, *dop853.DENSE_STAGE_WEIGHTS)
    stage_weights = np.zeros((stages, stages))
    for stage, weights in enumerate(rows):
        stage_weights[stage, : len(weights)] = weights
    return Method(
        name="dop853",
        nodes=np.array(nodes),
        stage_weights=stage_weights,
        step_weights=np.array(dop853.STEP_WEIGHTS),
        longest_step_s=4e-3,
        steps_per_period=10.0,
        order=8,
        inside=True,
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
