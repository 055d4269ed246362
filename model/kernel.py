"""The equations of motion, Eq. 18, and the fixed-step integrator: what `compiled` compiles.

This is plain Python: it runs as it stands (slowly), and reads nothing but its arguments. All that
can be configured comes in as an argument, because numba freezes module globals when it compiles.

The state is one flat vector, and its layout is fixed:

=========  ==================================================  ==============
index      what                                                unit
=========  ==================================================  ==============
0 to 2     X_p, Y_p, Z_p of the centre of mass                 m
3 to 5     roll phi, pitch theta, yaw psi                      rad
6 to 8     X_p', Y_p', Z_p'                                    m/s
9 to 11    phi', theta', psi'                                  rad/s
12 to 19   X_w, mid-span amplitudes of the cables              m
20 to 27   X_w'                                                m/s
28 on      states of left-out effects (none yet)               their own
=========  ==================================================  ==============
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.cable import tension, transverse_acceleration
from model.kinematics import (
    add,
    angular_velocity,
    cable_line,
    cross,
    length_rate,
    rotation,
    scale,
    transform,
    trigonometry,
)
from model.platform import acceleration

Array = NDArray[np.float64]

PLATFORM_STATES = 12
STATES = 28


class Plant(NamedTuple):
    """The numbers of one machine as the kernel reads them; shapes as in `model.machine.Machine`."""

    mass: float
    gravity: float
    inertia: Array
    inverse_inertia: Array
    base: Array
    anchor: Array
    rest_length: Array
    stiffness: Array
    pretension: Array
    line_density: Array
    damping: Array


def derivative(state: Array, drive: Array, plant: Any, rate: Array) -> int:
    """The right-hand side of Eq. 18.

    Parameters
    ----------
    state
        Shape (28,), laid out as above.
    drive
        The drive's force and moment about the centre of mass in O-XYZ, shape (6,); N and N m.
    plant
        A `Plant`.
    rate
        Filled with the derivative of `state`, shape (28,).

    Returns
    -------
    int
        Index of a slack cable, -1 where all are taut.
    """
    cables = plant.stiffness.size
    position = (state[0], state[1], state[2])
    angles = trigonometry((state[3], state[4], state[5]))
    velocity = (state[6], state[7], state[8])
    rates = (state[9], state[10], state[11])
    turn = rotation(angles)
    omega = angular_velocity(angles, rates)

    force = (drive[0], drive[1], drive[2] - plant.mass * plant.gravity)
    moment = (drive[3], drive[4], drive[5])
    slack = -1
    for i in range(cables):
        base = (plant.base[i, 0], plant.base[i, 1], plant.base[i, 2])
        arm = transform(turn, (plant.anchor[i, 0], plant.anchor[i, 1], plant.anchor[i, 2]))
        length, direction = cable_line(base, position, arm)
        axial_velocity = length_rate(direction, arm, velocity, omega)
        mid_span = state[PLATFORM_STATES + i]
        mid_span_rate = state[PLATFORM_STATES + cables + i]
        pull = tension(
            plant.pretension[i],
            plant.stiffness[i],
            length - plant.rest_length[i],
            mid_span,
            length,
        )
        if pull <= 0.0:
            slack = i
        force = add(force, scale(pull, direction))
        moment = add(moment, scale(pull, cross(arm, direction)))
        rate[PLATFORM_STATES + i] = mid_span_rate
        rate[PLATFORM_STATES + cables + i] = transverse_acceleration(
            mid_span,
            mid_span_rate,
            pull,
            axial_velocity,
            length,
            plant.line_density[i],
            plant.damping[i],
        )

    linear, angular = acceleration(
        plant.mass, plant.inertia, plant.inverse_inertia, angles, rates, force, moment
    )
    for axis in range(3):
        rate[axis] = velocity[axis]
        rate[3 + axis] = rates[axis]
        rate[6 + axis] = linear[axis]
        rate[9 + axis] = angular[axis]
    return slack


def advance(
    start: Array, step_s: float, weights: Array, rates: Array, count: int, result: Array
) -> None:
    """Fill `result` with start + step_s * (weights . rates), over the first `count` stages."""
    for k in range(start.size):
        result[k] = start[k]
    for stage in range(count):
        factor = step_s * weights[stage]
        if factor != 0.0:
            for k in range(start.size):
                result[k] += factor * rates[stage, k]


def step(
    state: Array,
    step_s: float,
    drive: Array,
    stage_weights: Array,
    step_weights: Array,
    plant: Any,
    rates: Array,
    trial: Array,
) -> int:
    """One step of an explicit Runge-Kutta method, in place.

    Parameters
    ----------
    state
        Shape (s,), moved on by the step.
    step_s
        Length of the step, s.
    drive
        The drive's wrench at each stage, shape (stages, 6); N and N m.
    stage_weights, step_weights
        The method: a_ij, shape (stages, stages), and b_i, shape (stages,).
    plant
        A `Plant`.
    rates, trial
        Room to work in, shapes (stages, s) and (s,).

    Returns
    -------
    int
        Index of a cable that is slack at the start of the step, -1 where all are taut.
    """
    slack = derivative(state, drive[0], plant, rates[0])
    for stage in range(1, step_weights.size):
        advance(state, step_s, stage_weights[stage], rates, stage, trial)
        derivative(trial, drive[stage], plant, rates[stage])
    advance(state, step_s, step_weights, rates, step_weights.size, state)
    return slack


def first_beyond(state: Array, limit: Array) -> int:
    """Index of the first state beyond its limit, -1 for none; a NaN is beyond every limit."""
    for k in range(state.size):
        if not abs(state[k]) <= limit[k]:
            return k
    return -1


def integrate(
    state: Array,
    step_s: Array,
    drive: Array,
    jump_point: int,
    jump: Array,
    row_of_point: NDArray[np.int64],
    limit: Array,
    stage_weights: Array,
    step_weights: Array,
    plant: Any,
    trajectory: Array,
) -> tuple[int, int, int, int, int]:
    """Integrate Eq. 18 by an explicit Runge-Kutta method over given steps.

    Points are the ends of the steps: point n is the start of step n.

    Parameters
    ----------
    state
        The state before point 0, shape (s,); left at the last state reached.
    step_s
        Length of each step, shape (n,), in s.
    drive
        The drive's wrench at every stage of every step, shape (n, stages, 6); N and N m.
    jump_point, jump
        At this point `jump`, shape (s,), is added to the state.
    row_of_point
        Row of `trajectory` a point is stored in, -1 for none; shape (n + 1,).
    limit
        Magnitude beyond which a state is a blow-up, shape (s,).
    stage_weights, step_weights
        The method: a_ij, shape (stages, stages), and b_i, shape (stages,).
    plant
        A `Plant`.
    trajectory
        Filled with states, shape (rows, s).

    Returns
    -------
    points, culprit, slack_point, slack_cable, slack_points
        Points reached; index of the state that blew up, or -1; the first point with a slack
        cable, that cable (-1 for none), and how many points had one.
    """
    rates = np.empty((step_weights.size, state.size))
    trial = np.empty(state.size)
    steps = step_s.size
    slack_point, slack_cable, slack_points = -1, -1, 0
    for point in range(steps + 1):
        if point == jump_point:
            state += jump
        culprit = first_beyond(state, limit)
        if culprit >= 0:
            return point, culprit, slack_point, slack_cable, slack_points
        if row_of_point[point] >= 0:
            trajectory[row_of_point[point]] = state
        if point == steps:
            break
        slack = step(
            state, step_s[point], drive[point], stage_weights, step_weights, plant, rates, trial
        )
        if slack >= 0:
            slack_points += 1
            if slack_cable < 0:
                slack_point, slack_cable = point, slack
    return steps + 1, -1, slack_point, slack_cable, slack_points
