"""Integration methods as data: an explicit Runge-Kutta tableau and the steps it may take."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model import dop853

Array = NDArray[np.float64]


THRIFTY_STEP_S = 0.01
"""A fit's steps are no longer, however slow the tones: a drive has ramps and harmonics."""


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
    steps_per_period, thrifty_per_period
        Fewest steps in a period of the machine's highest tone, and where a fit to noisy samples is
        all that is wanted.
    stable
        Step times decay that is asked for at most: rk4 follows 2.8, dp5 3.3, dop853 about 6; a
        friction that grows with the tension decays faster than it does at rest.
    turn_rad
        How far a tone of what sticks may turn in a step. On the imaginary axis dp5 follows 1.0, rk4
        2.8 and dop853 6, but what slips again and again is not smooth: no order helps, and eight
        cables that hold 1 N within 25 um are then simulated to some mN.
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
    thrifty_per_period: float
    stable: float
    turn_rad: float
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

    def step_s(self, highest_tone_hz: float, *, thrifty: bool = False) -> float:
        """The longest step for a machine whose highest tone is given."""
        if thrifty:
            return min(THRIFTY_STEP_S, 1.0 / (self.thrifty_per_period * highest_tone_hz))
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
        thrifty_per_period=33.0,
        stable=2.5,
        turn_rad=0.3,
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
        thrifty_per_period=4.0,
        stable=2.5,
        turn_rad=0.8,
        order=8,
        inside=True,
    )


def dormand_prince_5() -> Method:
    """The 5th-order method of Dormand and Prince (1980), without its error estimate.

    Where the step is bound by a sharp switch of an effect, no order beyond the first few pays, and
    six evaluations serve as well as twelve.
    """
    rows = (
        (),
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    )
    stage_weights = np.zeros((6, 6))
    for stage, weights in enumerate(rows):
        stage_weights[stage, : len(weights)] = weights
    return Method(
        name="dp5",
        nodes=np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0]),
        stage_weights=stage_weights,
        step_weights=np.array([35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]),
        longest_step_s=4e-3,
        steps_per_period=20.0,
        thrifty_per_period=14.0,
        stable=1.25,
        turn_rad=0.6,
        order=5,
    )


METHODS = {"dop853": dormand_prince_853, "dp5": dormand_prince_5, "rk4": runge_kutta_4}


@cache
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
