"""Where the platform and its cables are, and how fast: Eqs. 1 and 9 to 14 of the paper.

Every function works on plain components, so that one text serves two readers: the kernel, which
numba compiles with floats, and NumPy, which passes arrays of times. A vector is a tuple of its
three components, a matrix a tuple of its three rows. SI units and radians.
"""

from typing import Any, TypeAlias

import numpy as np

Quantity: TypeAlias = Any
"""A float (in the kernel) or an array of floats (over time)."""

Vector: TypeAlias = tuple[Quantity, Quantity, Quantity]
Matrix: TypeAlias = Any
"""Three rows of three, a tuple of tuples or a (3, 3) array: indexed ``matrix[row][column]``."""

Trigonometry: TypeAlias = tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]


def add(a: Vector, b: Vector) -> Vector:
    """Sum a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def subtract(a: Vector, b: Vector) -> Vector:
    """Difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scale(factor: Quantity, a: Vector) -> Vector:
    """Multiple of a."""
    return factor * a[0], factor * a[1], factor * a[2]


def dot(a: Vector, b: Vector) -> Quantity:
    """Scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def transform(matrix: Matrix, a: Vector) -> Vector:
    """Product of a matrix and a."""
    return (
        matrix[0][0] * a[0] + matrix[0][1] * a[1] + matrix[0][2] * a[2],
        matrix[1][0] * a[0] + matrix[1][1] * a[1] + matrix[1][2] * a[2],
        matrix[2][0] * a[0] + matrix[2][1] * a[1] + matrix[2][2] * a[2],
    )


def transform_back(matrix: Matrix, a: Vector) -> Vector:
    """The transposed matrix times a: for a rotation, its inverse."""
    return (
        matrix[0][0] * a[0] + matrix[1][0] * a[1] + matrix[2][0] * a[2],
        matrix[0][1] * a[0] + matrix[1][1] * a[1] + matrix[2][1] * a[2],
        matrix[0][2] * a[0] + matrix[1][2] * a[1] + matrix[2][2] * a[2],
    )


def trigonometry(attitude: Vector) -> Trigonometry:
    """Sine and cosine of roll, of pitch and of yaw, so that they are computed once.

    Parameters
    ----------
    attitude
        Roll phi, pitch theta and yaw psi, in rad.
    """
    return (
        np.sin(attitude[0]),
        np.cos(attitude[0]),
        np.sin(attitude[1]),
        np.cos(attitude[1]),
        np.sin(attitude[2]),
        np.cos(attitude[2]),
    )


def rotation(angles: Trigonometry) -> Matrix:
    """R of Eq. 1, from platform frame to O-XYZ: R = Rz(psi) Ry(theta) Rx(phi)."""
    sin_roll, cos_roll, sin_pitch, cos_pitch, sin_yaw, cos_yaw = angles
    return (
        (
            cos_yaw * cos_pitch,
            cos_yaw * sin_pitch * sin_roll - sin_yaw * cos_roll,
            cos_yaw * sin_pitch * cos_roll + sin_yaw * sin_roll,
        ),
        (
            sin_yaw * cos_pitch,
            sin_yaw * sin_pitch * sin_roll + cos_yaw * cos_roll,
            sin_yaw * sin_pitch * cos_roll - cos_yaw * sin_roll,
        ),
        (-sin_pitch, cos_pitch * sin_roll, cos_pitch * cos_roll),
    )


def angles_of(matrix: Matrix) -> Vector:
    """Roll, pitch and yaw of a rotation, in rad: what `rotation` makes a matrix of."""
    return (
        np.arctan2(matrix[2][1], matrix[2][2]),
        -np.arcsin(np.minimum(np.maximum(matrix[2][0], -1.0), 1.0)),
        np.arctan2(matrix[1][0], matrix[0][0]),
    )


def angular_velocity(angles: Trigonometry, rates: Vector) -> Vector:
    """Angular velocity in O-XYZ: omega = H [phi', theta', psi'], H as printed below Eq. 2.

    Parameters
    ----------
    angles
        From `trigonometry`.
    rates
        phi', theta' and psi', in rad/s.

    Returns
    -------
    Vector
        omega, in rad/s.
    """
    _, _, sin_pitch, cos_pitch, sin_yaw, cos_yaw = angles
    return (
        cos_pitch * cos_yaw * rates[0] - sin_yaw * rates[1],
        cos_pitch * sin_yaw * rates[0] + cos_yaw * rates[1],
        -sin_pitch * rates[0] + rates[2],
    )


def rates_of(angles: Trigonometry, omega: Vector) -> Vector:
    """The inverse of H: phi', theta' and psi' of an angular velocity; singular at 90 deg pitch."""
    _, _, sin_pitch, cos_pitch, sin_yaw, cos_yaw = angles
    roll_rate = (cos_yaw * omega[0] + sin_yaw * omega[1]) / cos_pitch
    return (
        roll_rate,
        -sin_yaw * omega[0] + cos_yaw * omega[1],
        omega[2] + sin_pitch * roll_rate,
    )


def angular_velocity_drift(angles: Trigonometry, rates: Vector) -> Vector:
    """H' [phi', theta', psi']: the part of omega' that is there without angular acceleration.

    Parameters
    ----------
    angles
        From `trigonometry`.
    rates
        phi', theta' and psi', in rad/s.

    Returns
    -------
    Vector
        H' [phi', theta', psi'], in rad/s2.
    """
    _, _, sin_pitch, cos_pitch, sin_yaw, cos_yaw = angles
    roll_rate, pitch_rate, yaw_rate = rates
    return (
        -(sin_pitch * cos_yaw * pitch_rate + cos_pitch * sin_yaw * yaw_rate) * roll_rate
        - cos_yaw * yaw_rate * pitch_rate,
        (-sin_pitch * sin_yaw * pitch_rate + cos_pitch * cos_yaw * yaw_rate) * roll_rate
        - sin_yaw * yaw_rate * pitch_rate,
        -cos_pitch * pitch_rate * roll_rate,
    )


def cable_line(base: Vector, position: Vector, arm: Vector) -> tuple[Quantity, Vector]:
    """Length and direction of a cable, Eqs. 1 and 9.

    Parameters
    ----------
    base
        B_i, the base point in O-XYZ, in m.
    position
        X_P, the centre of mass in O-XYZ, in m.
    arm
        r_i = R x_Pi, from the centre of mass to the anchor, in O-XYZ, in m.

    Returns
    -------
    length, direction
        L_i in m, and u_i, the unit vector from anchor to base: a tension T_i > 0 pulls along u_i.
    """
    line = subtract(subtract(base, position), arm)
    length = np.sqrt(dot(line, line))
    return length, scale(1.0 / length, line)


def length_rate(direction: Vector, arm: Vector, velocity: Vector, omega: Vector) -> Quantity:
    """v_yi = dL_i/dt = -(u_i . v + (r_i x u_i) . omega), in m/s.

    Eq. 13 prints the opposite sign, which contradicts Eq. 1: moving towards the base shortens
    the cable. The paper uses its square only.
    """
    return -(dot(direction, velocity) + dot(cross(arm, direction), omega))
