"""The simulated plant's equations and their integration, compiled: see `rig.simulated.plant`.

It runs without Python's lock: the amplifiers of a rig that is being recorded answer meanwhile.
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES

Array = NDArray[np.float64]

STATES = 13 + 3 * CABLES


class Plant(NamedTuple):
    """What the kernel reads of the machine: SI units, cables along the first axis."""

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
    friction: Array
    bristle_length: float
    bristle_damping: float


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _turn(q: Array, turn: Array) -> None:
    w, x, y, z = q
    turn[0, 0] = 1 - 2 * (y * y + z * z)
    turn[0, 1] = 2 * (x * y - w * z)
    turn[0, 2] = 2 * (x * z + w * y)
    turn[1, 0] = 2 * (x * y + w * z)
    turn[1, 1] = 1 - 2 * (x * x + z * z)
    turn[1, 2] = 2 * (y * z - w * x)
    turn[2, 0] = 2 * (x * z - w * y)
    turn[2, 1] = 2 * (y * z + w * x)
    turn[2, 2] = 1 - 2 * (x * x + y * y)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _times(matrix: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z,
    )


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _rates(
    plant: Plant, state: Array, wrench: Array, rate: Array, tension: Array, turn: Array
) -> None:
    """Time derivative of the state into `rate`, cable tensions into `tension`.

    State: position (3), quaternion (4), velocity (3), body angular velocity (3), mid-span
    amplitudes (8), their rates (8), bristle deflections (8). `turn` is room for a rotation.
    Written out by component: arrays of three cost more to make than to calculate.
    """
    _turn(state[3:7], turn)
    w, x, y, z = state[3], state[4], state[5], state[6]
    vx, vy, vz = state[7], state[8], state[9]
    p, q, r = state[10], state[11], state[12]
    fx, fy, fz = wrench[0], wrench[1], wrench[2] - plant.mass * plant.gravity
    mx, my, mz = wrench[3], wrench[4], wrench[5]
    for i in range(len(plant.stiffness)):
        bx, by, bz = plant.anchor[i, 0], plant.anchor[i, 1], plant.anchor[i, 2]
        ax, ay, az = _times(turn, bx, by, bz)
        lx = plant.base[i, 0] - state[0] - ax
        ly = plant.base[i, 1] - state[1] - ay
        lz = plant.base[i, 2] - state[2] - az
        length = np.sqrt(lx * lx + ly * ly + lz * lz)
        dx, dy, dz = lx / length, ly / length, lz / length
        sx, sy, sz = _times(turn, q * bz - r * by, r * bx - p * bz, p * by - q * bx)
        stretching = -(dx * (vx + sx) + dy * (vy + sy) + dz * (vz + sz))
        middle = state[13 + i]
        swing = (np.pi * middle) ** 2 / (4.0 * length)
        elongation = length - plant.rest_length[i] + swing
        slip = 0.0
        rubbing = 0.0
        if plant.friction[i] > 0.0:
            bristle = state[29 + i]
            slip = stretching - abs(stretching) * bristle / plant.bristle_length
            rubbing = plant.friction[i] / plant.bristle_length * bristle
            rubbing += plant.bristle_damping * slip
        pull = max(0.0, plant.pretension[i] + plant.stiffness[i] * elongation + rubbing)
        tension[i] = pull
        px, py, pz = pull * dx, pull * dy, pull * dz
        fx, fy, fz = fx + px, fy + py, fz + pz
        mx += ay * pz - az * py
        my += az * px - ax * pz
        mz += ax * py - ay * px
        tone_squared = (np.pi / length) ** 2 * (pull / plant.line_density[i] - stretching**2)
        rate[13 + i] = state[21 + i]
        rate[21 + i] = -plant.damping[i] * state[21 + i] - tone_squared * middle
        rate[29 + i] = slip
    rate[0], rate[1], rate[2] = vx, vy, vz
    rate[3] = 0.5 * (-x * p - y * q - z * r)
    rate[4] = 0.5 * (w * p + y * r - z * q)
    rate[5] = 0.5 * (w * q - x * r + z * p)
    rate[6] = 0.5 * (w * r + x * q - y * p)
    rate[7], rate[8], rate[9] = fx / plant.mass, fy / plant.mass, fz / plant.mass
    hx, hy, hz = _times(plant.inertia, p, q, r)
    # The moment in the body's frame, less the gyroscopic one.
    nx = turn[0, 0] * mx + turn[1, 0] * my + turn[2, 0] * mz - (q * hz - r * hy)
    ny = turn[0, 1] * mx + turn[1, 1] * my + turn[2, 1] * mz - (r * hx - p * hz)
    nz = turn[0, 2] * mx + turn[1, 2] * my + turn[2, 2] * mz - (p * hy - q * hx)
    rate[10], rate[11], rate[12] = _times(plant.inverse_inertia, nx, ny, nz)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance(
    plant: Plant,
    state: Array,
    steps: int,
    start: int,
    disturbance: Array,
    wrench: Array,
    step: float,
    every: int,
) -> tuple[Array, Array]:
    """Classic fourth-order Runge-Kutta at a fixed step; the disturbance is added at `start`.

    `state` is moved on; what it was every so many steps is returned, from before the first.
    `wrench` stands at every half step, shape (2 steps + 1, 6).
    """
    size = len(state)
    cables = len(plant.stiffness)
    states = np.zeros((steps // every, size))
    tensions = np.zeros((steps // every, cables))
    k1, k2, k3, k4 = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size)
    tension, spare, trial = np.zeros(cables), np.zeros(cables), np.zeros(size)
    turn = np.zeros((3, 3))
    for n in range(steps):
        if n == start:
            state += disturbance
        _rates(plant, state, wrench[2 * n], k1, tension, turn)
        if n % every == 0:
            states[n // every] = state
            tensions[n // every] = tension
        for i in range(size):
            trial[i] = state[i] + 0.5 * step * k1[i]
        _rates(plant, trial, wrench[2 * n + 1], k2, spare, turn)
        for i in range(size):
            trial[i] = state[i] + 0.5 * step * k2[i]
        _rates(plant, trial, wrench[2 * n + 1], k3, spare, turn)
        for i in range(size):
            trial[i] = state[i] + step * k3[i]
        _rates(plant, trial, wrench[2 * n + 2], k4, spare, turn)
        for i in range(size):
            state[i] += step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
        norm = np.sqrt(
            state[3] * state[3] + state[4] * state[4] + state[5] * state[5] + state[6] * state[6]
        )
        for i in range(3, 7):
            state[i] /= norm
    return states, tensions
