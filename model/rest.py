"""Where a machine comes to rest, which is not X* = 0 where the drive was made for another.

A platform whose mass, pretension or geometry is not quite that of the drive's machine hangs beside
X* = 0; started there, with no damping of its own, it would ring for the whole of the run.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from model.compiled import compiled
from model.extras import going, held, resting
from model.kernel import Extras
from model.kinematics import cross, rotation, trigonometry
from model.library.selection import ActiveEffect
from model.machine import Machine

Array = NDArray[np.float64]

MOST_ROUNDS = 60
CLOSE_M = 1e-10
"""Rounds end when the platform moves by less than this. Holds and stops bend, one at each hook: it
takes some rounds to find which of them are met."""

STEP = 1e-6
"""Of the differences of the pose, m and rad."""

SOON_S = 1e-5
"""Over which a speed is taken for that of the cables."""

POSE = np.arange(6)
"""Where it is in the state vector; its rates follow."""

FARTHEST_M = 0.3
"""A platform that would hang farther off than this has no rest worth the name."""


def rest_state(
    machine: Machine,
    extras: Extras | None,
    effects: Sequence[ActiveEffect],
    wrench: Array,
    states: int,
) -> Array:
    """The state in which cables, weight and a constant wrench balance.

    Parameters
    ----------
    machine
        The plant.
    extras
        Effects in the kernel; what they add to tensions at rest counts. What the elongation tells
        at rest has come to that; other memory is empty.
    effects
        The same, as they are.
    wrench
        Of the drive at rest, N and N m, shape (6,).
    states
        Length of the state vector.

    Returns
    -------
    Array
        Shape (states,), the pose in m and rad first; zeros where there is none near X* = 0.
    """
    derivatives, plant = compiled("derivatives"), machine.plant()
    drive = np.append(wrench, np.zeros(machine.cables * 2))
    told = resting(extras, effects, machine)
    places, held_by, steps = held(extras)
    places, held_by = np.append(POSE, places), np.append(POSE + len(POSE), held_by)
    steps = np.append(np.full(len(POSE), STEP), steps)
    found = np.zeros(states)
    rates = np.empty((len(places) + 1, states))
    for _ in range(MOST_ROUNDS):
        tried = np.tile(found, (len(places) + 1, 1))
        tried[np.arange(1, len(places) + 1), places] += steps
        for there, law, _ in told:
            tried[:, there] = law(_elongation(machine, tried[:, :6]))
        derivatives(tried, drive, plant, extras, rates)
        left = rates[:, held_by]
        move, *_ = np.linalg.lstsq(((left[1:] - left[0]) / steps[:, None]).T, -left[0])
        found[places] += move
        if not np.abs(found[POSE]).max() < FARTHEST_M:
            break
        if np.abs(move[POSE]).max() < CLOSE_M:
            if not np.abs(found[POSE]).max() > 10.0 * CLOSE_M:
                break
            for there, law, _ in told:
                found[there] = law(_elongation(machine, found[None, :6])[0])
            return found
    return np.zeros(states)


def gained_at_once(
    machine: Machine,
    extras: Extras | None,
    effects: Sequence[ActiveEffect],
    rest: Array,
    platform: Array,
) -> Array:
    """What memory gains as the platform is moved, and given a speed, at once.

    Parameters
    ----------
    machine
        The plant.
    extras, effects
        Effects in the kernel, packed and as they are.
    rest
        The state at rest, shape (states,).
    platform
        What the platform gains, shape (12,): of its pose, m and rad, and of its rates.
    """
    gained = np.zeros_like(rest)
    before = rest[:6]
    poses = np.stack([before, before + platform[:6]])
    told = [one for one in resting(extras, effects, machine) if one.let_go.any()]
    if told and platform[:6].any():
        here, there = _elongation(machine, poses)
        for places, law, share in told:
            gained[places] = share * (law(there) - law(here))
    told = [one for one in going(extras, effects, machine) if one.let_go.any()]
    if told and platform[6:].any():
        ahead = poses[1] + np.outer([0.5, -0.5], SOON_S * platform[6:])
        rate = np.subtract(*_elongation(machine, ahead)) / SOON_S
        for places, law, share in told:
            gained[places] = share * law(rate)
    return gained


def tones_hz(machine: Machine) -> Array:
    """Tones of the platform on its cables about X* = 0, pretension included, shape (6,), Hz.

    Pretension turns with the cables it pulls by, which stiffens the softest modes most.

    Parameters
    ----------
    machine
        The plant.
    """
    poses = STEP * np.vstack([np.eye(6), -np.eye(6)])
    stretched = machine.stiffness * _elongation(machine, poses)
    pull = _pull(machine, poses, machine.pretension + stretched)
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


def _elongation(machine: Machine, poses: Array) -> Array:
    """Of the cables beyond X* = 0, shape (n, 8), m."""
    return _lines(machine, poses)[2] - machine.rest_length


def _pull(machine: Machine, poses: Array, tension: Array) -> Array:
    """Force and moment of the cables on the platform, of tensions (n, 8), shape (n, 6)."""
    arms, along, lengths = _lines(machine, poses)
    force = (tension / lengths)[..., None] * along
    x, y, z = np.moveaxis(arms, -1, 0)
    moment = np.stack(cross((x, y, z), tuple(np.moveaxis(force, -1, 0))), axis=-1)
    return np.hstack([force.sum(axis=1), moment.sum(axis=1)])
