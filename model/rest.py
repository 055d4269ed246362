"""Where a machine comes to rest, which is not X* = 0 where the drive was made for another.

A platform whose mass, pretension or geometry is not quite that of the drive's machine hangs beside
X* = 0; started there, with no damping of its own, it would ring for the whole of the run.
"""

import numpy as np
from numpy.typing import NDArray

from model.compiled import compiled
from model.kernel import Extras
from model.kinematics import rotation, trigonometry
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
        left = np.array([_pull(machine, *one) for one in zip(shown[:, :6], cables[3], strict=True)])
        left += wrench
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

    def net(pose: Array) -> Array:
        stretched = _lengths(machine, pose) - machine.rest_length
        return _pull(machine, pose, machine.pretension + machine.stiffness * stretched)

    sides = [net(STEP * row) - net(-STEP * row) for row in np.eye(6)]
    stiffness = -np.array(sides).T / (2.0 * STEP)
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = machine.mass * np.eye(3)
    inertia[3:, 3:] = machine.inertia
    squares = np.linalg.eigvals(np.linalg.solve(inertia, stiffness)).real
    return np.asarray(np.sort(np.sqrt(np.maximum(squares, 0.0))) / (2.0 * np.pi))


def _arms(machine: Machine, pose: Array) -> Array:
    """r_i in O-XYZ, shape (8, 3)."""
    return np.asarray(machine.anchor @ _rotation(pose[3:]).T)


def _rotation(angles: Array) -> Array:
    """R = Rz(psi) Ry(theta) Rx(phi), shape (3, 3)."""
    return np.array(rotation(trigonometry((float(angles[0]), float(angles[1]), float(angles[2])))))


def _lengths(machine: Machine, pose: Array) -> Array:
    along = machine.base - pose[:3] - _arms(machine, pose)
    return np.asarray(np.linalg.norm(along, axis=1))


def _pull(machine: Machine, pose: Array, tension: Array) -> Array:
    """Force and moment of the cables on the platform, shape (6,)."""
    arm = _arms(machine, pose)
    along = machine.base - pose[:3] - arm
    force = tension[:, None] * along / np.linalg.norm(along, axis=1, keepdims=True)
    return np.concatenate([force.sum(axis=0), np.cross(arm, force).sum(axis=0)])
