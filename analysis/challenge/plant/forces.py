"""Force and moment of all cables on the platform, and their tensions, at one step."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.compiled import law
from analysis.challenge.plant.fibre import pull
from analysis.challenge.plant.friction import friction
from analysis.challenge.plant.loads import loads
from analysis.challenge.plant.pulley import straight, wrapped
from analysis.challenge.plant.strings import extension, vibrate

Array = NDArray[np.float64]


@law
def rotation(quaternion: Array) -> Array:
    """Rotation matrix of a unit quaternion (w, x, y, z), from the platform frame to O-XYZ."""
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    turn = np.empty((3, 3))
    turn[0, 0], turn[0, 1] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z)
    turn[0, 2], turn[1, 0] = 2 * (x * z + w * y), 2 * (x * y + w * z)
    turn[1, 1], turn[1, 2] = 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    turn[2, 0], turn[2, 1] = 2 * (x * z - w * y), 2 * (y * z + w * x)
    turn[2, 2] = 1 - 2 * (x * x + y * y)
    return turn


@law
def push(
    cables: Array,
    states: Array,
    g: Array,
    post_of: NDArray[np.int64],
    posts: Array,
    qpos: Array,
    qvel: Array,
    time_s: float,
    step_s: float,
    kick: float,
    wrench: Array,
    cell: Array,
    attitude: Array,
) -> None:
    """Force and moment on the platform; states of cables and frame move on by one step.

    Parameters
    ----------
    cables, states
        Shapes (8, CABLE_NUMBERS) and (8, CABLE_STATES).
    g
        Numbers of platform and frame.
    post_of, posts
        The post of each cable, shape (8,); give of each post and its rate, shape (4, 6).
    qpos, qvel
        MuJoCo's: position, quaternion; speed in O-XYZ, angular speed in the platform frame.
    time_s, step_s, kick
        Time, step, and the share of it that passes for rates.
    wrench
        Six numbers, written: N and N m about the centre of mass in O-XYZ.
    cell, attitude
        Eight tensions at the cells and three angles, written.
    """
    turn = rotation(qpos[3:7])
    omega = turn @ qvel[3:6]
    attitude[0] = np.arctan2(turn[2, 1], turn[2, 2])
    attitude[1] = -np.arcsin(turn[2, 0])
    attitude[2] = np.arctan2(turn[1, 0], turn[0, 0])
    wrench[:] = 0.0
    on_post = np.zeros((at.POSTS, 3))
    arm, end, start = np.empty(3), np.empty(3), np.empty(3)
    moves = np.empty(3)
    for i in range(len(cables)):
        p, s, post = cables[i], states[i], posts[post_of[i]]
        for j in range(3):
            arm[j] = 0.0
            for k in range(3):
                arm[j] += turn[j, k] * p[at.ANCHOR + k]
            start[j] = qpos[j] + arm[j]
            end[j] = p[at.BASE + j] + post[j]
        moves[0] = qvel[0] + omega[1] * arm[2] - omega[2] * arm[1]
        moves[1] = qvel[1] + omega[2] * arm[0] - omega[0] * arm[2]
        moves[2] = qvel[2] + omega[0] * arm[1] - omega[1] * arm[0]
        if p[at.RADIUS] > 0.0:
            chord, x, y, z = wrapped(start, end, p[at.RADIUS])
        else:
            chord, x, y, z = straight(start, end)
        along = x * moves[0] + y * moves[1] + z * moves[2]
        speed = x * post[3] + y * post[4] + z * post[5] - along
        level = np.sqrt(1.0 - z * z) + 1e-12
        stretch = chord - p[at.REST_PATH] + extension(p, s, chord)
        behind = pull(p, s, stretch, speed, chord, level, time_s, step_s)
        rubbed = friction(p, s, speed, behind, step_s)
        tension = max(behind + rubbed, 0.0)
        cell[i] = behind if p[at.BEHIND] > 0.0 else tension
        sway = (moves[2] - along * z) / level
        side = (y * moves[0] - x * moves[1]) / level
        vibrate(p, s, tension, speed, chord, sway, side, kick, step_s)
        s[at.STARTED] = 1.0
        force = (tension * x, tension * y, tension * z)
        for j in range(3):
            wrench[j] += force[j]
            at_rest = p[at.PRETENSION] * p[at.REST_DIRECTION + j]
            on_post[post_of[i], j] -= force[j] - at_rest
        wrench[3] += arm[1] * force[2] - arm[2] * force[1]
        wrench[4] += arm[2] * force[0] - arm[0] * force[2]
        wrench[5] += arm[0] * force[1] - arm[1] * force[0]
    if g[at.FRAME_GIVE] > 0.0:
        _frame(g, posts, on_post, step_s)
    loads(g, qpos[:3], turn, qvel[:3], omega, attitude, wrench)


@law
def _frame(g: Array, posts: Array, force: Array, step_s: float) -> None:
    """Each post is a mass on a spring in each direction: m b'' = F - b/C - loss."""
    circular = 2.0 * np.pi * g[at.FRAME_HZ]
    mass = 1.0 / (g[at.FRAME_GIVE] * circular * circular)
    for post in range(at.POSTS):
        for j in range(3):
            loss = 2.0 * g[at.FRAME_LOSS] * circular * posts[post, 3 + j]
            back = circular * circular * posts[post, j]
            posts[post, 3 + j] += step_s * (force[post, j] / mass - back - loss)
            posts[post, j] += step_s * posts[post, 3 + j]
