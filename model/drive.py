"""What drives the platform along X* (design, section 4): an ideal wrench, or winches.

``drive = "wrench"`` is the wrench that makes the nominal platform (elastic cables
T_0 + k Delta L, no cable vibration; whether they hang slack or push is `Machine.least_pull`)
follow X*. ``drive = "winch"`` pays out the length each cable has on X*. Either is tabulated once,
at every stage of every step, and frozen: initial disturbances, cable vibration and whatever the
plant has beyond the nominal machine make the platform deviate.
"""

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from model.cable import tension
from model.compiled import compiled
from model.kernel import WRENCH
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
from model.outputs import cable_states
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
            machine.least_pull,
        )
        force = subtract(force, scale(pull, direction))
        moment = subtract(moment, scale(pull, cross(arm, direction)))
    return np.stack(np.broadcast_arrays(*force, *moment), axis=-1)


def drive_columns(kind: str) -> int:
    """How many numbers a row of a drive's table has."""
    return WRENCH if kind == "wrench" else WRENCH + 2 * CABLES


def drive_table(
    machine: Machine, motion: Motion, time_s: Array, within_s: Array, kind: str = "wrench"
) -> Array:
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
    kind
        "wrench" or "winch".

    Returns
    -------
    Array
        Shape (n, stages, 6): force and moment about the centre of mass in O-XYZ, N and N m. With
        winches shape (n, stages, 22): then follow the lengths paid out, m, and their rates, m/s.
    """
    table = np.empty((*time_s.shape, drive_columns(kind)))
    rows = max(1, CHUNK_TIMES // time_s.shape[1])
    for first in range(0, len(time_s), rows):
        part = slice(first, first + rows)
        command = motion.at(time_s[part], within_s[part])
        flat = [np.ascontiguousarray(values.reshape(-1, 6)) for values in command]
        fill = _pay_out if kind == "winch" else _push
        table[part] = fill(machine, *flat).reshape(table[part].shape)
    return table


def _push(machine: Machine, pose: Array, rate: Array, acceleration: Array) -> Array:
    """`required_drive`, compiled."""
    wrench = np.empty_like(pose)
    compiled("drive_wrench")(pose, rate, acceleration, machine.plant(), wrench)
    return wrench


def _pay_out(machine: Machine, pose: Array, rate: Array, _: Array) -> Array:
    """Lengths of the cables on X*, over those at rest, and their rates.

    What the rig file leaves of static equilibrium is held by a constant wrench, so that rest is
    still: a machine that hangs on its cables has none.
    """
    still = np.zeros((1, 6))
    wrench = np.repeat(required_drive(machine, still, still, still), len(pose), axis=0)
    on_course = cable_states(machine, pose, rate, np.zeros((len(pose), machine.cables)))
    return np.hstack([wrench, on_course.elongation_m, on_course.axial_velocity_m_per_s])
