"""The platform: a rigid body under its weight, the drive, dampers, air and a hose.

Newton for the centre of mass, Euler's equations in the platform frame for the rotation, the
attitude as a unit quaternion (Goldstein, Classical Mechanics, 3rd ed., sections 4.5 and 5.5).
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.vectors import (
    Vector,
    at,
    cross,
    gained,
    minus,
    plus,
    times,
    turned,
    turned_back,
)
from cdpr8 import STANDARD_GRAVITY_M_PER_S2

Array = NDArray[np.float64]

GRAVITY = STANDARD_GRAVITY_M_PER_S2

FACES = 4
"""The air takes hold at this many points, fore, aft, above and below."""


@law
def write_turn(state: Array, turn: Array) -> None:
    """The rotation matrix of the attitude, platform frame to O-XYZ, written to `turn` (3, 3)."""
    w, x, y, z = (
        state[at_.ATTITUDE],
        state[at_.ATTITUDE + 1],
        state[at_.ATTITUDE + 2],
        state[at_.ATTITUDE + 3],
    )
    turn[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    turn[0, 1] = 2.0 * (x * y - w * z)
    turn[0, 2] = 2.0 * (x * z + w * y)
    turn[1, 0] = 2.0 * (x * y + w * z)
    turn[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    turn[1, 2] = 2.0 * (y * z - w * x)
    turn[2, 0] = 2.0 * (x * z - w * y)
    turn[2, 1] = 2.0 * (y * z + w * x)
    turn[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@law
def move(state: Array, change: Array) -> None:
    """Rates of place and attitude: x' = v, q' = (0, omega) q / 2 with omega in O-XYZ."""
    gained(change, at_.PLACE, at(state, at_.SPEED))
    x, y, z = at(state, at_.SPIN)
    a, b, c, d = (
        state[at_.ATTITUDE],
        state[at_.ATTITUDE + 1],
        state[at_.ATTITUDE + 2],
        state[at_.ATTITUDE + 3],
    )
    change[at_.ATTITUDE] = 0.5 * (-x * b - y * c - z * d)
    change[at_.ATTITUDE + 1] = 0.5 * (x * a + y * d - z * c)
    change[at_.ATTITUDE + 2] = 0.5 * (y * a + z * b - x * d)
    change[at_.ATTITUDE + 3] = 0.5 * (z * a + x * c - y * b)


@law
def load_at(load: Array, arm: Vector, force: Vector) -> None:
    """Add a force that acts `arm` away from the centre of mass to `load`, force and moment (6,)."""
    gained(load, 0, force)
    gained(load, 3, cross(arm, force))


@law
def weight_and_drive(load: Array, wrench: Array, platform: Array, turn: Array) -> None:
    """Weight, and the drive's wrench (6,), which acts at the rig file's centre of mass."""
    load[2] -= platform[at_.MASS] * GRAVITY
    load_at(load, turned(turn, at(platform, at_.TRACKED)), at(wrench, 0))
    gained(load, 3, at(wrench, 3))


@law
def dampers(load: Array, state: Array, platform: Array) -> None:
    """Forces and moments in proportion to speed and spin: `platform_damping`."""
    gained(load, 0, times(-platform[at_.DAMPING], at(state, at_.SPEED)))
    gained(load, 3, times(-platform[at_.TURNING_DAMPING], at(state, at_.SPIN)))


@law
def air(load: Array, state: Array, platform: Array, turn: Array) -> None:
    """Drag of still air, square of the speed, shared by four points: `air_drag`.

    F = -(rho C_d A / 2) |v| v (Batchelor, An Introduction to Fluid Dynamics, section 5.11).
    """
    reach = platform[at_.DRAG_ARM]
    for face in range(FACES):
        sign = 1.0 if face % 2 == 0 else -1.0
        away = (sign * reach, 0.0, 0.0) if face < 2 else (0.0, 0.0, sign * reach)
        arm = turned(turn, away)
        speed = plus(at(state, at_.SPEED), cross(at(state, at_.SPIN), arm))
        pace = sqrt(speed[0] ** 2 + speed[1] ** 2 + speed[2] ** 2)
        load_at(load, arm, times(-platform[at_.DRAG] / FACES * pace, speed))


@law
def hose(load: Array, state: Array, platform: Array, turn: Array) -> None:
    """A spring and damper alike in all directions, relaxed at rest: `umbilical`."""
    arm = turned(turn, at(platform, at_.HOSE_AT))
    away = minus(plus(at(state, at_.PLACE), arm), at(platform, at_.HOSE_FROM))
    speed = plus(at(state, at_.SPEED), cross(at(state, at_.SPIN), arm))
    spring = times(-platform[at_.HOSE], away)
    load_at(load, arm, plus(spring, times(-platform[at_.HOSE_LOSS], speed)))


@law
def accelerate(
    change: Array,
    state: Array,
    load: Array,
    mass: float,
    inertia: Array,
    inverse: Array,
    turn: Array,
) -> None:
    """Newton, and Euler's I w' = M - w x (I w) in the platform frame.

    Parameters
    ----------
    change, state
        Shape (STATES,).
    load
        Force and moment about the centre of mass in O-XYZ, shape (6,), N and N m.
    mass
        kg.
    inertia, inverse
        Platform frame, shape (3, 3), kg m2 and its inverse.
    turn
        Rotation matrix, shape (3, 3).
    """
    gained(change, at_.SPEED, times(1.0 / mass, at(load, 0)))
    spin = turned_back(turn, at(state, at_.SPIN))
    moment = minus(turned_back(turn, at(load, 3)), cross(spin, turned(inertia, spin)))
    gained(change, at_.SPIN, turned(turn, turned(inverse, moment)))
