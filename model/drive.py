"""The ideal drive, ``drive = "wrench"`` (design, section 4).

The wrench that makes the nominal platform (elastic cables T_0 + k Delta L, no cable vibration)
follow X*. It is tabulated once, at every stage of every step, and frozen: initial disturbances,
cable vibration and whatever the plant has beyond the nominal machine make the platform deviate.
"""

import numpy as np
from numpy.typing import NDArray

from model.cable import tension
from model.kinematics import (
    add,
    cable_line,
    cross,
    rotation,
    scale,
    subtract,
    transform,
    trigonometry,
)
from model.machine import Machine
from model.motion import Motion
from model.platform import required_wrench

Array = NDArray[np.float64]

CHUNK_TIMES = 8192
"""Times evaluated together: their temporaries stay in the processor's cache."""


def required_drive(machine: Machine, pose: Array, rate: Array, acceleration: Array) -> Array:
    """M X'' + W_C - W_G - J_A^T T of Eq. 2 for the platform on elastic cables.

    Parameters
    ----------
    machine
        The nominal machine.
    pose, rate, acceleration
        X, X' and X'', shape (n, 6); m, rad and s.

    Returns
    -------
    Array
        Force and moment about the centre of mass in O-XYZ, shape (n, 6); N and N m.
    """
    angles = trigonometry((pose[:, 3], pose[:, 4], pose[:, 5]))
    position = (pose[:, 0], pose[:, 1], pose[:, 2])
    force, moment = required_wrench(
        machine.mass,
        machine.inertia,
        angles,
        (rate[:, 3], rate[:, 4], rate[:, 5]),
        (acceleration[:, 0], acceleration[:, 1], acceleration[:, 2]),
        (acceleration[:, 3], acceleration[:, 4], acceleration[:, 5]),
    )
    force = add(force, (0.0, 0.0, machine.mass * machine.gravity))
    turn = rotation(angles)
    for i in range(machine.cables):
        arm = transform(turn, tuple(machine.anchor[i]))
        length, direction = cable_line(tuple(machine.base[i]), position, arm)
        pull = tension(
            machine.pretension[i],
            machine.stiffness[i],
            length - machine.rest_length[i],
            0.0,
            length,
        )
        force = subtract(force, scale(pull, direction))
        moment = subtract(moment, scale(pull, cross(arm, direction)))
    return np.stack(np.broadcast_arrays(*force, *moment), axis=-1)


def wrench_table(machine: Machine, motion: Motion, time_s: Array, within_s: Array) -> Array:
    """The frozen drive.

    Parameters
    ----------
    machine
        The nominal machine.
    motion
        X*.
    time_s
        Times of the stages, shape (n, stages).
    within_s
        A time inside each step, shape (n, 1): says which side of a break is meant.

    Returns
    -------
    Array
        Force and moment about the centre of mass in O-XYZ, shape (n, stages, 6); N and N m.
    """
    table = np.empty((*time_s.shape, 6))
    rows = max(1, CHUNK_TIMES // time_s.shape[1])
    for first in range(0, len(time_s), rows):
        part = slice(first, first + rows)
        command = motion.at(time_s[part], within_s[part])
        pose, rate, acceleration = (values.reshape(-1, 6) for values in command)
        wrench = required_drive(machine, pose, rate, acceleration)
        table[part] = wrench.reshape(table[part].shape)
    return table
