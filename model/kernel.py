"""The equations of motion, Eq. 18: what `compiled` compiles; `runge_kutta` integrates them.

This is plain Python: it runs as it stands (slowly), and reads nothing but its arguments. All that
can be configured comes in as an argument, because numba freezes module globals when it compiles.

The state is one flat vector:

=========  ==================================================  ==============
index      what                                                unit
=========  ==================================================  ==============
0 to 2     X_p, Y_p, Z_p of the centre of mass                 m
3 to 5     roll phi, pitch theta, yaw psi                      rad
6 to 8     X_p', Y_p', Z_p'                                    m/s
9 to 11    phi', theta', psi'                                  rad/s
12 to 19   X_w, mid-span amplitudes of the cables              m
20 to 27   X_w'                                                m/s
28 on      states of the left-out effects that are on          their own
=========  ==================================================  ==============

The drive is a row of numbers: force and moment in O-XYZ, of a wrench that acts at `drive_arm`, and,
where winches drive, the lengths they have paid out and the rates of these, cable by cable.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.cable import tension, transverse_acceleration
from model.kinematics import (
    Matrix,
    Vector,
    add,
    angular_velocity,
    cable_line,
    cross,
    length_rate,
    rotation,
    scale,
    subtract,
    transform,
    trigonometry,
)
from model.library.assembled import RATED, cable_pull, cable_rates, platform_wrench
from model.platform import acceleration, required_wrench

Array = NDArray[np.float64]

PLATFORM_STATES = 12
STATES = 28
WRENCH = 6


class Plant(NamedTuple):
    """The numbers of one machine as the kernel reads them; shapes as in `model.machine.Machine`."""

    mass: float
    gravity: float
    inertia: Array
    inverse_inertia: Array
    drive_arm: Array
    base: Array
    anchor: Array
    rest_length: Array
    stiffness: Array
    pretension: Array
    line_density: Array
    damping: Array
    least_pull: float


class Extras(NamedTuple):
    """The left-out effects that are on, as the kernel reads them.

    Parameters
    ----------
    on
        Which effects act on a cable, a bit for each in the order of the library, shape (8,);
        those of the platform stand with cable 1.
    offset
        Index of an effect's first state, shape (effects,).
    carrier
        The cable that carries the states a cable shares with the others of its post, shape (8,).
    numbers
        Numbers of each cable and parameters of all effects, shape (8, any), laid out as
        `model.library.lanes` says.
    """

    on: NDArray[np.int64]
    offset: NDArray[np.int64]
    carrier: NDArray[np.int64]
    numbers: Array


class Cable(NamedTuple):
    """One cable at one moment, as the laws of `model.effects` see it; SI units.

    Parameters
    ----------
    arm, direction
        r_i and u_i, in O-XYZ.
    length, elongation, elongation_rate
        L_i; Delta L_i of Eq. 14, less what a winch has paid out, and its rate.
    axial_velocity
        v_yi = dL_i/dt: how fast the cable runs over its pulley.
    anchor_velocity
        Of the anchor, in O-XYZ.
    elastic
        T_i of Eq. 16.
    pull
        The tension at the anchor, with all effects.
    behind
        The part of it that a cell behind the pulley does not see.
    """

    arm: Vector
    direction: Vector
    length: float
    elongation: float
    elongation_rate: float
    axial_velocity: float
    anchor_velocity: Vector
    elastic: float
    pull: float
    behind: float


def cable(
    i: int,
    state: Array,
    drive: Array,
    turn: Matrix,
    velocity: Vector,
    omega: Vector,
    plant: Any,
    extras: Any,
) -> Cable:
    """Eqs. 9 to 16 for cable i, and what left-out effects add to its tension."""
    cables = plant.stiffness.size
    position = (state[0], state[1], state[2])
    base = (plant.base[i, 0], plant.base[i, 1], plant.base[i, 2])
    arm = transform(turn, (plant.anchor[i, 0], plant.anchor[i, 1], plant.anchor[i, 2]))
    length, direction = cable_line(base, position, arm)
    axial_velocity = length_rate(direction, arm, velocity, omega)
    elongation, elongation_rate = length - plant.rest_length[i], axial_velocity
    if drive.size > WRENCH:
        elongation -= drive[WRENCH + i]
        elongation_rate -= drive[WRENCH + cables + i]
    elastic = tension(
        plant.pretension[i],
        plant.stiffness[i],
        elongation,
        state[PLATFORM_STATES + i],
        length,
    )
    anchor_velocity = add(velocity, cross(omega, arm))
    line = Cable(
        arm,
        direction,
        length,
        elongation,
        elongation_rate,
        axial_velocity,
        anchor_velocity,
        elastic,
        elastic,
        0.0,
    )
    if extras is None:
        return line
    on = extras.on[i]
    if on == 0:
        return line
    added, behind = cable_pull(i, on, line, state, extras.offset, extras.carrier, extras.numbers)
    return Cable(
        arm,
        direction,
        length,
        elongation,
        elongation_rate,
        axial_velocity,
        anchor_velocity,
        elastic,
        max(elastic + added, 0.0),
        behind,
    )


def derivative(state: Array, drive: Array, plant: Any, extras: Any, rate: Array) -> None:
    """The right-hand side of Eq. 18.

    Parameters
    ----------
    state
        Laid out as above, shape (s,).
    drive
        Shape (6,), or (22,) where winches drive; N, N m, m and m/s.
    plant, extras
        A `Plant` and an `Extras`.
    rate
        Filled with the derivative of `state`, shape (s,).
    """
    cables = plant.stiffness.size
    angles = trigonometry((state[3], state[4], state[5]))
    velocity = (state[6], state[7], state[8])
    rates = (state[9], state[10], state[11])
    turn = rotation(angles)
    omega = angular_velocity(angles, rates)

    pushed = (drive[0], drive[1], drive[2])
    drive_arm = transform(turn, (plant.drive_arm[0], plant.drive_arm[1], plant.drive_arm[2]))
    force = subtract(pushed, (0.0, 0.0, plant.mass * plant.gravity))
    moment = add((drive[3], drive[4], drive[5]), cross(drive_arm, pushed))
    for k in range(STATES, state.size):
        rate[k] = 0.0
    for i in range(cables):
        line = cable(i, state, drive, turn, velocity, omega, plant, extras)
        force = add(force, scale(line.pull, line.direction))
        moment = add(moment, scale(line.pull, cross(line.arm, line.direction)))
        mid_span_rate = state[PLATFORM_STATES + cables + i]
        rate[PLATFORM_STATES + i] = mid_span_rate
        rate[PLATFORM_STATES + cables + i] = transverse_acceleration(
            state[PLATFORM_STATES + i],
            mid_span_rate,
            line.pull,
            line.axial_velocity,
            line.length,
            plant.line_density[i],
            plant.damping[i],
        )
        if extras is not None:
            on = extras.on[i]
            if on & RATED != 0:
                across = cable_rates(
                    i, on, line, state, extras.offset, extras.carrier, extras.numbers, rate
                )
                force = add(force, across)
                moment = add(moment, cross(line.arm, across))
    if extras is not None:
        added_force, added_moment = platform_wrench(
            extras.on[0], state, velocity, omega, extras.offset, extras.numbers
        )
        force, moment = add(force, added_force), add(moment, added_moment)

    linear, angular = acceleration(
        plant.mass, plant.inertia, plant.inverse_inertia, angles, rates, force, moment
    )
    for axis in range(3):
        rate[axis] = velocity[axis]
        rate[3 + axis] = rates[axis]
        rate[6 + axis] = linear[axis]
        rate[9 + axis] = angular[axis]


def derivatives(states: Array, drive: Array, plant: Any, extras: Any, rates_out: Array) -> None:
    """Rates of some states, each by itself.

    Parameters
    ----------
    states
        Shape (n, s).
    drive
        One row for all, shape (6,) or (22,).
    plant, extras
        A `Plant` and an `Extras`.
    rates_out
        Filled, shape (n, s).
    """
    for row in range(states.shape[0]):
        derivative(states[row], drive, plant, extras, rates_out[row])


def observe(states: Array, drive: Array, plant: Any, extras: Any, cables_out: Array) -> None:
    """The cables of a trajectory.

    Parameters
    ----------
    states
        Shape (n, s).
    drive
        The drive at each of them, shape (n, 6 or 22); or one row for all.
    plant, extras
        A `Plant` and an `Extras`.
    cables_out
        Filled with L_i, Delta L_i, v_yi, the tension at the anchor and behind the pulley,
        shape (5, n, 8).
    """
    for row in range(states.shape[0]):
        state = states[row]
        angles = trigonometry((state[3], state[4], state[5]))
        velocity = (state[6], state[7], state[8])
        omega = angular_velocity(angles, (state[9], state[10], state[11]))
        turn = rotation(angles)
        command = drive[min(row, drive.shape[0] - 1)]
        for i in range(plant.stiffness.size):
            line = cable(i, state, command, turn, velocity, omega, plant, extras)
            cables_out[0, row, i] = line.length
            cables_out[1, row, i] = line.elongation
            cables_out[2, row, i] = line.axial_velocity
            cables_out[3, row, i] = line.pull
            cables_out[4, row, i] = max(line.pull - line.behind, 0.0)


def drive_wrench(pose: Array, rate: Array, acceleration_: Array, plant: Any, wrench: Array) -> None:
    """M X'' + W_C - W_G - J_A^T T of Eq. 2 for a platform on elastic cables, time by time.

    Parameters
    ----------
    pose, rate, acceleration_
        X, X' and X'', shape (n, 6); m, rad and s.
    plant
        The nominal `Plant`.
    wrench
        Filled with force and moment about the centre of mass in O-XYZ, shape (n, 6); N and N m.
    """
    for row in range(pose.shape[0]):
        angles = trigonometry((pose[row, 3], pose[row, 4], pose[row, 5]))
        turn = rotation(angles)
        force, moment = required_wrench(
            plant.mass,
            plant.inertia,
            angles,
            (rate[row, 3], rate[row, 4], rate[row, 5]),
            (acceleration_[row, 0], acceleration_[row, 1], acceleration_[row, 2]),
            (acceleration_[row, 3], acceleration_[row, 4], acceleration_[row, 5]),
        )
        force = add(force, (0.0, 0.0, plant.mass * plant.gravity))
        for i in range(plant.stiffness.size):
            base = (plant.base[i, 0], plant.base[i, 1], plant.base[i, 2])
            arm = transform(turn, (plant.anchor[i, 0], plant.anchor[i, 1], plant.anchor[i, 2]))
            position = (pose[row, 0], pose[row, 1], pose[row, 2])
            length, direction = cable_line(base, position, arm)
            elongation = length - plant.rest_length[i]
            pull = tension(
                plant.pretension[i],
                plant.stiffness[i],
                elongation,
                0.0,
                length,
                plant.least_pull,
            )
            force = subtract(force, scale(pull, direction))
            moment = subtract(moment, scale(pull, cross(arm, direction)))
        for axis in range(3):
            wrench[row, axis] = force[axis]
            wrench[row, 3 + axis] = moment[axis]
