"""One integration: arrays in, states out. What `simulate` and the checks stand on."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from model.compiled import Announce, integrator
from model.kernel import PLATFORM_STATES, Extras
from model.machine import Machine
from model.method import Method
from model.steps import Steps

Array = NDArray[np.float64]

PITCH_LIMIT_RAD = np.deg2rad(85.0)
"""At 90 deg pitch the angles of Eq. 2 are singular; no cable robot of this kind gets there."""

SHARE_DIGITS = 10
"""Digits to which two shares of a step are told apart."""

RATE_LIMIT = 1e6
"""m/s and rad/s (and states of effects): far beyond anything but a blow-up."""


@dataclass(frozen=True)
class Trajectory:
    """States at the outputs.

    Parameters
    ----------
    time_s
        Shape (n,); shorter than asked after a blow-up.
    states
        Shape (n, s), laid out as `model.kernel` says.
    culprit
        Index of the state that blew up, -1 for none.
    end_s
        How far the integration got.
    steps_taken, derivatives
        How much work it was.
    solve_s
        Wall time of the integration, without compiling.
    """

    time_s: Array
    states: Array
    culprit: int
    end_s: float
    steps_taken: int
    derivatives: int
    solve_s: float


def integrate(
    machine: Machine,
    method: Method,
    steps: Steps,
    drive: Array,
    initial: Array,
    jump: Array,
    extras: Extras | None,
    announce: Announce | None = None,
) -> Trajectory:
    """Integrate Eq. 18.

    Parameters
    ----------
    machine
        The plant.
    method, steps
        How.
    drive
        The drive at every stage of every step, shape (n, stages, 6 or 22); SI units.
    initial
        State before the first point, shape (s,).
    jump
        Added to the state at ``steps.jump_point``, shape (s,).
    extras
        The left-out effects that are on.
    announce
        Told one line if the kernel has to be compiled first.
    """
    solve = integrator(announce)
    state = np.array(initial, dtype=np.float64)
    states = np.empty((steps.output_s.size, state.size))
    inside, inside_weights = rows_inside(method, steps)
    began = time.perf_counter()
    points, culprit = solve(
        state,
        steps.step_s,
        drive,
        steps.jump_point,
        np.ascontiguousarray(jump, dtype=np.float64),
        steps.first_row,
        inside,
        inside_weights,
        blow_up_limits(machine, state.size),
        method.stage_weights,
        method.step_weights,
        machine.plant(),
        extras,
        np.empty((method.nodes.size, state.size)),
        np.empty(state.size),
        states,
    )
    solve_s = time.perf_counter() - began
    return Trajectory(
        states=states[: steps.rows_kept(points, culprit)],
        time_s=steps.output_s[: steps.rows_kept(points, culprit)],
        culprit=culprit,
        end_s=float(steps.point_s[min(points, steps.point_s.size - 1)]),
        steps_taken=min(points, steps.step_s.size),
        derivatives=steps.evaluations(method, min(points, steps.step_s.size)),
        solve_s=solve_s,
    )


def rows_inside(method: Method, steps: Steps) -> tuple[NDArray[np.int64], Array]:
    """Which row of the weights gives each output, -1 where the output is a point; and the weights.

    Shapes (rows,) and (any, stages): shares of a step that differ by rounding only are one.
    """
    within = steps.share > 0.0
    shares, which = np.unique(np.round(steps.share[within], SHARE_DIGITS), return_inverse=True)
    inside = np.full(steps.share.size, -1, dtype=np.int64)
    inside[within] = which
    if not shares.size:
        return inside, np.zeros((0, method.nodes.size))
    return inside, np.ascontiguousarray(method.weights_inside(shares))


def blow_up_limits(machine: Machine, states: int) -> Array:
    """Magnitudes no state of a sound run reaches, shape (states,); m, rad and s.

    A platform as far off as its longest cable, a cable that vibrates as wide as it is long.
    """
    limits = np.full(states, RATE_LIMIT)
    limits[0:3] = machine.rest_length.max()
    limits[3:6] = np.pi, PITCH_LIMIT_RAD, np.pi
    limits[PLATFORM_STATES : PLATFORM_STATES + machine.cables] = machine.rest_length
    return limits
