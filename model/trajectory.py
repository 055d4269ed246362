"""One integration: arrays in, states out. What `simulate` and the checks stand on."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from model.compiled import Announce, integrator
from model.kernel import PLATFORM_STATES, STATES
from model.machine import Machine
from model.method import Method
from model.status import Outcome, outcome
from model.steps import Steps

Array = NDArray[np.float64]

PITCH_LIMIT_RAD = np.deg2rad(85.0)
"""At 90 deg pitch the angles of Eq. 2 are singular; no cable robot of this kind gets there."""

RATE_LIMIT = 1e6
"""m/s and rad/s: far beyond anything but a blow-up."""


@dataclass(frozen=True)
class Trajectory:
    """States at the outputs.

    Parameters
    ----------
    time_s
        Shape (n,); shorter than asked after a blow-up.
    states
        Shape (n, 28), laid out as `model.kernel` says.
    outcome
        Whether it went well.
    steps_taken, derivatives
        How much work it was.
    solve_s
        Wall time of the integration, without compiling.
    """

    time_s: Array
    states: Array
    outcome: Outcome
    steps_taken: int
    derivatives: int
    solve_s: float


def integrate(
    machine: Machine,
    method: Method,
    steps: Steps,
    wrench: Array,
    initial: Array,
    jump: Array,
    announce: Announce | None = None,
) -> Trajectory:
    """Integrate Eq. 18.

    Parameters
    ----------
    machine
        The plant.
    method, steps
        How.
    wrench
        The drive at every stage of every step, shape (n, stages, 6); N and N m.
    initial
        State before the first point, shape (28,).
    jump
        Added to the state at ``steps.jump_point``, shape (28,).
    announce
        Told one line if the kernel has to be compiled first.
    """
    solve = integrator(announce)
    state = np.array(initial, dtype=np.float64)
    states = np.empty((int(steps.row_of_point.max()) + 1, state.size))
    stages = method.step_weights.size
    began = time.perf_counter()
    points, culprit, slack_point, slack_cable, slack_points = solve(
        state,
        steps.step_s,
        np.ascontiguousarray(wrench, dtype=np.float64),
        steps.jump_point,
        np.ascontiguousarray(jump, dtype=np.float64),
        steps.row_of_point,
        blow_up_limits(machine),
        method.stage_weights,
        method.step_weights,
        machine.plant(),
        states,
    )
    solve_s = time.perf_counter() - began
    rows = int(np.count_nonzero(steps.row_of_point[:points] >= 0))
    return Trajectory(
        time_s=steps.output_s[:rows],
        states=states[:rows],
        outcome=outcome(
            steps.point_s,
            culprit=culprit,
            culprit_point=points,
            slack_point=slack_point,
            slack_cable=slack_cable,
            slack_points=slack_points,
        ),
        steps_taken=min(points, steps.step_s.size),
        derivatives=stages * min(points, steps.step_s.size),
        solve_s=solve_s,
    )


def blow_up_limits(machine: Machine) -> Array:
    """Magnitudes no state of a sound run reaches, shape (28,); m, rad and s.

    A platform as far off as its longest cable, a cable that vibrates as wide as it is long.
    """
    limits = np.full(STATES, RATE_LIMIT)
    limits[0:3] = machine.rest_length.max()
    limits[3:6] = np.pi, PITCH_LIMIT_RAD, np.pi
    limits[PLATFORM_STATES : PLATFORM_STATES + machine.cables] = machine.rest_length
    return limits
