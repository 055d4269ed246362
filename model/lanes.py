"""Sixteen simulations side by side: the equations of `model.kernel` on flat arrays.

The laws are the same functions; only the loops differ. Each quantity stands in `LANES` neighbours
of a flat array, so that one vector instruction serves eight simulations, and every loop over lanes
is free of branches and of the C library: the rules of notes/solver.md. `model.library.lanes` says
where what stands. Like the scalar kernel, this runs as plain Python too.

Arrays, all flat but the rates: ``y`` states, ``f`` their rates, ``q`` the numbers of the machines,
``work`` room to work in.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.cable import tension, transverse_acceleration
from model.kernel import STATES, WRENCH
from model.kinematics import (
    angular_velocity,
    cable_line,
    cross,
    length_rate,
    rotation,
    transform,
)
from model.lane_sine import sine_cosine
from model.library.assembled import lane_pull, lane_rates, lane_wrench
from model.platform import acceleration

Array = NDArray[np.float64]

CABLES = 8
LANES = 16

ANGLES = 0
TURN = 6 * LANES
OMEGA = 15 * LANES
FORCE = 18 * LANES
MOMENT = 21 * LANES
POSITION = 24 * LANES
VELOCITY = 27 * LANES
RATES = 30 * LANES
ARM = 33 * LANES
DIRECTION = 36 * LANES
LENGTH = 39 * LANES
ELONGATION = 40 * LANES
ELONGATION_RATE = 41 * LANES
AXIAL_VELOCITY = 42 * LANES
ANCHOR_VELOCITY = 43 * LANES
ELASTIC = 46 * LANES
PULL = 47 * LANES
BEHIND = 48 * LANES
MID_SPAN = 49 * LANES
MID_SPAN_RATE = 50 * LANES
ACCELERATION = 51 * LANES
WORK = 57 * LANES
"""First of each quantity in `work`; a test holds them to `model.library.lanes`."""

BASE = 0
ANCHOR = 3 * LANES
REST_LENGTH = 6 * LANES
STIFFNESS = 7 * LANES
PRETENSION = 8 * LANES
LINE_DENSITY = 9 * LANES
DAMPING = 10 * LANES
"""First of each number of a cable in its part of `q`."""

MASS = 0
GRAVITY = LANES
INERTIA = 2 * LANES
INVERSE_INERTIA = 11 * LANES
DRIVE_ARM = 20 * LANES
PLATFORM = 23 * LANES
"""First of each number of the platform in its part of `q`."""


def locate(y: Array, work: Array) -> None:
    """Angles, rotation and velocities of the platforms."""
    for w in range(LANES):
        sin_roll, cos_roll = sine_cosine(y[3 * LANES + w])
        sin_pitch, cos_pitch = sine_cosine(y[4 * LANES + w])
        sin_yaw, cos_yaw = sine_cosine(y[5 * LANES + w])
        angles = (sin_roll, cos_roll, sin_pitch, cos_pitch, sin_yaw, cos_yaw)
        rates = (y[9 * LANES + w], y[10 * LANES + w], y[11 * LANES + w])
        turn = rotation(angles)
        omega = angular_velocity(angles, rates)
        work[ANGLES + w] = sin_roll
        work[ANGLES + LANES + w] = cos_roll
        work[ANGLES + 2 * LANES + w] = sin_pitch
        work[ANGLES + 3 * LANES + w] = cos_pitch
        work[ANGLES + 4 * LANES + w] = sin_yaw
        work[ANGLES + 5 * LANES + w] = cos_yaw
        work[TURN + w] = turn[0][0]
        work[TURN + LANES + w] = turn[0][1]
        work[TURN + 2 * LANES + w] = turn[0][2]
        work[TURN + 3 * LANES + w] = turn[1][0]
        work[TURN + 4 * LANES + w] = turn[1][1]
        work[TURN + 5 * LANES + w] = turn[1][2]
        work[TURN + 6 * LANES + w] = turn[2][0]
        work[TURN + 7 * LANES + w] = turn[2][1]
        work[TURN + 8 * LANES + w] = turn[2][2]
        work[OMEGA + w] = omega[0]
        work[OMEGA + LANES + w] = omega[1]
        work[OMEGA + 2 * LANES + w] = omega[2]
        work[RATES + w] = rates[0]
        work[RATES + LANES + w] = rates[1]
        work[RATES + 2 * LANES + w] = rates[2]
    for k in range(3 * LANES):
        work[POSITION + k] = y[k]
        work[VELOCITY + k] = y[6 * LANES + k]


def turn_of(work: Array, w: int) -> Any:
    """The rotation of one lane's platform."""
    return (
        (work[TURN + w], work[TURN + LANES + w], work[TURN + 2 * LANES + w]),
        (work[TURN + 3 * LANES + w], work[TURN + 4 * LANES + w], work[TURN + 5 * LANES + w]),
        (work[TURN + 6 * LANES + w], work[TURN + 7 * LANES + w], work[TURN + 8 * LANES + w]),
    )


def cables_elastic(i: int, y: Array, command: Array, own: Array, work: Array) -> None:
    """Eqs. 9 to 16 for cable i."""
    at, at_rate = (12 + i) * LANES, (12 + CABLES + i) * LANES
    mid_span, mid_span_rate = y[at : at + LANES], y[at_rate : at_rate + LANES]
    for w in range(LANES):
        work[MID_SPAN + w] = mid_span[w]
        work[MID_SPAN_RATE + w] = mid_span_rate[w]
        work[ELONGATION + w] = 0.0
        work[ELONGATION_RATE + w] = 0.0
    if command.shape[0] > WRENCH:
        spread = 1 if command.shape[1] > 1 else 0
        for w in range(LANES):
            work[ELONGATION + w] = command[WRENCH + i, w * spread]
            work[ELONGATION_RATE + w] = command[WRENCH + CABLES + i, w * spread]
    for w in range(LANES):
        turn = turn_of(work, w)
        base = (own[BASE + w], own[BASE + LANES + w], own[BASE + 2 * LANES + w])
        anchor = (own[ANCHOR + w], own[ANCHOR + LANES + w], own[ANCHOR + 2 * LANES + w])
        position = (
            work[POSITION + w],
            work[POSITION + LANES + w],
            work[POSITION + 2 * LANES + w],
        )
        velocity = (
            work[VELOCITY + w],
            work[VELOCITY + LANES + w],
            work[VELOCITY + 2 * LANES + w],
        )
        omega = (work[OMEGA + w], work[OMEGA + LANES + w], work[OMEGA + 2 * LANES + w])
        arm = transform(turn, anchor)
        length, direction = cable_line(base, position, arm)
        axial_velocity = length_rate(direction, arm, velocity, omega)
        around = cross(omega, arm)
        elongation = length - own[REST_LENGTH + w] - work[ELONGATION + w]
        elastic = tension(
            own[PRETENSION + w],
            own[STIFFNESS + w],
            elongation,
            work[MID_SPAN + w],
            length,
        )
        work[ARM + w] = arm[0]
        work[ARM + LANES + w] = arm[1]
        work[ARM + 2 * LANES + w] = arm[2]
        work[DIRECTION + w] = direction[0]
        work[DIRECTION + LANES + w] = direction[1]
        work[DIRECTION + 2 * LANES + w] = direction[2]
        work[LENGTH + w] = length
        work[ELONGATION + w] = elongation
        work[ELONGATION_RATE + w] = axial_velocity - work[ELONGATION_RATE + w]
        work[AXIAL_VELOCITY + w] = axial_velocity
        work[ANCHOR_VELOCITY + w] = velocity[0] + around[0]
        work[ANCHOR_VELOCITY + LANES + w] = velocity[1] + around[1]
        work[ANCHOR_VELOCITY + 2 * LANES + w] = velocity[2] + around[2]
        work[ELASTIC + w] = elastic
        work[PULL + w] = 0.0
        work[BEHIND + w] = 0.0


def weigh(own: Array, work: Array) -> None:
    """The drive's wrench about the centres of mass, and the weight."""
    for w in range(LANES):
        turn = turn_of(work, w)
        arm = (own[DRIVE_ARM + w], own[DRIVE_ARM + LANES + w], own[DRIVE_ARM + 2 * LANES + w])
        pushed = (work[FORCE + w], work[FORCE + LANES + w], work[FORCE + 2 * LANES + w])
        lever = cross(transform(turn, arm), pushed)
        work[FORCE + 2 * LANES + w] -= own[MASS + w] * own[GRAVITY + w]
        work[MOMENT + w] += lever[0]
        work[MOMENT + LANES + w] += lever[1]
        work[MOMENT + 2 * LANES + w] += lever[2]


def take_up(work: Array) -> None:
    """The whole tension, and what it does to the platforms."""
    for w in range(LANES):
        pull = max(work[ELASTIC + w] + work[PULL + w], 0.0)
        arm = (work[ARM + w], work[ARM + LANES + w], work[ARM + 2 * LANES + w])
        direction = (
            work[DIRECTION + w],
            work[DIRECTION + LANES + w],
            work[DIRECTION + 2 * LANES + w],
        )
        lever = cross(arm, direction)
        work[PULL + w] = pull
        work[FORCE + w] += pull * direction[0]
        work[FORCE + LANES + w] += pull * direction[1]
        work[FORCE + 2 * LANES + w] += pull * direction[2]
        work[MOMENT + w] += pull * lever[0]
        work[MOMENT + LANES + w] += pull * lever[1]
        work[MOMENT + 2 * LANES + w] += pull * lever[2]


def vibrate(i: int, own: Array, work: Array, f: Array) -> None:
    """Eq. 17 for cable i."""
    for w in range(LANES):
        work[ACCELERATION + w] = transverse_acceleration(
            work[MID_SPAN + w],
            work[MID_SPAN_RATE + w],
            work[PULL + w],
            work[AXIAL_VELOCITY + w],
            work[LENGTH + w],
            own[LINE_DENSITY + w],
            own[DAMPING + w],
        )
    at, at_rate = (12 + i) * LANES, (12 + CABLES + i) * LANES
    rate, acceleration_ = f[at : at + LANES], f[at_rate : at_rate + LANES]
    for w in range(LANES):
        rate[w] = work[MID_SPAN_RATE + w]
        acceleration_[w] = work[ACCELERATION + w]


def accelerate(own: Array, work: Array) -> None:
    """Eq. 2 for all platforms."""
    for w in range(LANES):
        angles = (
            work[ANGLES + w],
            work[ANGLES + LANES + w],
            work[ANGLES + 2 * LANES + w],
            work[ANGLES + 3 * LANES + w],
            work[ANGLES + 4 * LANES + w],
            work[ANGLES + 5 * LANES + w],
        )
        inertia = (
            (own[INERTIA + w], own[INERTIA + LANES + w], own[INERTIA + 2 * LANES + w]),
            (
                own[INERTIA + 3 * LANES + w],
                own[INERTIA + 4 * LANES + w],
                own[INERTIA + 5 * LANES + w],
            ),
            (
                own[INERTIA + 6 * LANES + w],
                own[INERTIA + 7 * LANES + w],
                own[INERTIA + 8 * LANES + w],
            ),
        )
        inverse = (
            (
                own[INVERSE_INERTIA + w],
                own[INVERSE_INERTIA + LANES + w],
                own[INVERSE_INERTIA + 2 * LANES + w],
            ),
            (
                own[INVERSE_INERTIA + 3 * LANES + w],
                own[INVERSE_INERTIA + 4 * LANES + w],
                own[INVERSE_INERTIA + 5 * LANES + w],
            ),
            (
                own[INVERSE_INERTIA + 6 * LANES + w],
                own[INVERSE_INERTIA + 7 * LANES + w],
                own[INVERSE_INERTIA + 8 * LANES + w],
            ),
        )
        linear, angular = acceleration(
            own[MASS + w],
            inertia,
            inverse,
            angles,
            (work[RATES + w], work[RATES + LANES + w], work[RATES + 2 * LANES + w]),
            (work[FORCE + w], work[FORCE + LANES + w], work[FORCE + 2 * LANES + w]),
            (work[MOMENT + w], work[MOMENT + LANES + w], work[MOMENT + 2 * LANES + w]),
        )
        work[ACCELERATION + w] = linear[0]
        work[ACCELERATION + LANES + w] = linear[1]
        work[ACCELERATION + 2 * LANES + w] = linear[2]
        work[ACCELERATION + 3 * LANES + w] = angular[0]
        work[ACCELERATION + 4 * LANES + w] = angular[1]
        work[ACCELERATION + 5 * LANES + w] = angular[2]


def lane_derivative(y: Array, command: Array, q: Array, extras: Any, work: Array, f: Array) -> None:
    """The right-hand side of Eq. 18 for all lanes.

    Parameters
    ----------
    y
        States, shape (s * LANES,).
    command
        The drive, shape (6 or 22, 1 or LANES).
    q
        The machines, see `model.library.lanes`.
    extras
        An `Extras`; of `values`, the lanes have their own in `q`.
    work
        Room to work in, shape (WORK,).
    f
        Filled with the derivatives, shape (s * LANES,).
    """
    stride = (q.size - PLATFORM) // CABLES
    platform = q[CABLES * stride :]
    locate(y, work)
    spread = 1 if command.shape[1] > 1 else 0
    for k in range(WRENCH):
        for w in range(LANES):
            work[FORCE + k * LANES + w] = command[k, w * spread]
    weigh(platform, work)
    for k in range(STATES * LANES, y.size):
        f[k] = 0.0
    for i in range(CABLES):
        own = q[i * stride : (i + 1) * stride]
        cables_elastic(i, y, command, own, work)
        if extras is not None:
            lane_pull(i, extras.on[i], extras.offset, extras.carrier, own, y, work)
        take_up(work)
        vibrate(i, own, work, f)
        if extras is not None:
            lane_rates(i, extras.on[i], extras.offset, extras.carrier, own, y, work, f)
    if extras is not None:
        lane_wrench(extras.on[0], q, y, work)
    accelerate(platform, work)
    for k in range(3 * LANES):
        f[k] = work[VELOCITY + k]
        f[3 * LANES + k] = work[RATES + k]
    for k in range(6 * LANES):
        f[6 * LANES + k] = work[ACCELERATION + k]


def observe_lanes(
    states: Array,
    drive: Array,
    q: Array,
    extras: Any,
    y: Array,
    work: Array,
    cables_out: Array,
) -> None:
    """As `model.kernel.observe`, for all lanes.

    Parameters
    ----------
    states
        Shape (LANES, n, s).
    drive
        Shape (n or 1, 6 or 22, 1 or LANES).
    q, extras
        The machines and the effects that are on in any of them.
    y, work
        Room to work in, shapes (s * LANES,) and (WORK,).
    cables_out
        Filled with L_i, Delta L_i, v_yi, the tension at the anchor and behind the pulley, shape
        (LANES, 5, n, 8).
    """
    stride = (q.size - PLATFORM) // CABLES
    for row in range(states.shape[1]):
        for k in range(states.shape[2]):
            for w in range(LANES):
                y[k * LANES + w] = states[w, row, k]
        command = drive[min(row, drive.shape[0] - 1)]
        locate(y, work)
        for i in range(CABLES):
            own = q[i * stride : (i + 1) * stride]
            cables_elastic(i, y, command, own, work)
            if extras is not None:
                lane_pull(i, extras.on[i], extras.offset, extras.carrier, own, y, work)
            take_up(work)
            for w in range(LANES):
                cables_out[w, 0, row, i] = work[LENGTH + w]
                cables_out[w, 1, row, i] = work[ELONGATION + w]
                cables_out[w, 2, row, i] = work[AXIAL_VELOCITY + w]
                cables_out[w, 3, row, i] = work[PULL + w]
                cables_out[w, 4, row, i] = max(work[PULL + w] - work[BEHIND + w], 0.0)
