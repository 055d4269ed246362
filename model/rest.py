"""Where a machine comes to rest, which is not X* = 0 where the drive was made for another.

A platform whose mass, pretension or geometry is not quite that of the drive's machine hangs beside
X* = 0; started there, with no damping of its own, it would ring for the whole of the run.
"""

import numpy as np
from numpy.typing import NDArray

from model.compiled import compiled
from model.kernel import Extras
from model.kinematics import cross, rotation, trigonometry
from model.machine import Machine

Array = NDArray[np.float64]

MOST_ROUNDS = 12
CLOSE_M = 1e-10
"""Rounds end when the platform moves by less than this."""

STEP = 1e-6
"""Of the differences, m and rad."""

FARTHEST_M = 0.3
"""A platform that would hang farther off than this has no rest worth the name."""


def rest_pose(machine: Machine, extras: Extras | None, wrench: Array, states: int) -> Array:
    """The pose at which cables, weight and a constant wrench balance.

    Parameters
    ----------
    machine
        The plant.
    extras
        Effects in the kernel; what they add to tensions at rest counts, their memory is empty.
    wrench
        Of the drive at rest, N and N m, shape (6,).
    states
        Length of the state vector.

    Returns
    -------
    Array
        Shape (6,), m and rad; zeros where there is none near X* = 0.
    """
    observe, plant = compiled("observe"), machine.plant()
    cables = np.empty((5, 7, machine.cables))
    no_drive = np.zeros((1, 6))
    shown = np.zeros((7, states))
    pose = np.zeros(6)
    for _ in range(MOST_ROUNDS):
        shown[:, :6] = pose + np.vstack([np.zeros(6), STEP * np.eye(6)])
        observe(shown, no_drive, plant, extras, cables)
        left = _pull(machine, shown[:, :6], cables[3]) + wrench
        left[:, 2] -= machine.mass * machine.gravity
        move = -np.linalg.solve(((left[1:] - left[0]) / STEP).T, left[0])
        pose = pose + move
        if not np.abs(pose).max() < FARTHEST_M:
            break
        if np.abs(move).max() < CLOSE_M:
            return pose if np.abs(pose).max() > 10.0 * CLOSE_M else np.zeros(6)
    return np.zeros(6)


def tones_hz(machine: Machine) -> Array:
    """Tones of the platform on its cables about X* = 0, pretension included, shape (6,), Hz.

    Pretension turns with the cables it pulls by, which stiffens the softest modes most.

    Parameters
    ----------
    machine
        The plant.
    """
    poses = STEP * np.vstack([np.eye(6), -np.eye(6)])
    stretched = _lines(machine, poses)[2] - machine.rest_length
    pull = _pull(machine, poses, machine.pretension + machine.stiffness * stretched)
    stiffness = -(pull[:6] - pull[6:]).T / (2.0 * STEP)
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = machine.mass * np.eye(3)
    inertia[3:, 3:] = machine.inertia
    squares = np.linalg.eigvals(np.linalg.solve(inertia, stiffness)).real
    return np.asarray(np.sort(np.sqrt(np.maximum(squares, 0.0))) / (2.0 * np.pi))


def _lines(machine: Machine, poses: Array) -> tuple[Array, Array, Array]:
    """r_i and the lines to the pulleys in O-XYZ, shape (n, 8, 3), and their lengths, (n, 8)."""
    turns = np.array([rotation(trigonometry(tuple(angles))) for angles in poses[:, 3:].tolist()])
    arms = machine.anchor @ turns.transpose(0, 2, 1)
    along = machine.base - poses[:, None, :3] - arms
    return arms, along, np.sqrt((along**2).sum(axis=-1))


def _pull(machine: Machine, poses: Array, tension: Array) -> Array:
    """Force and moment of the cables on the platform, of tensions (n, 8), shape (n, 6)."""
    arms, along, lengths = _lines(machine, poses)
    force = (tension / lengths)[..., None] * along
    x, y, z = np.moveaxis(arms, -1, 0)
    moment = np.stack(cross((x, y, z), tuple(np.moveaxis(force, -1, 0))), axis=-1)
    return np.hstack([force.sum(axis=1), moment.sum(axis=1)])
