"""The rigid platform: Newton-Euler, Eq. 2 of the paper, solved forwards and backwards.

The rotational rows of Eq. 2 are A_G H [phi'', theta'', psi''] + W_C = moment, with
A_G = R I R^T (the inertia in O-XYZ) and W_C = A_G H' [phi', theta', psi'] + omega x (A_G omega).
"""

from model.kinematics import (
    Matrix,
    Quantity,
    Trigonometry,
    Vector,
    add,
    angular_velocity,
    angular_velocity_drift,
    cross,
    rates_of,
    rotation,
    scale,
    subtract,
    transform,
    transform_back,
)


def in_fixed_frame(turn: Matrix, inertia: Matrix, a: Vector) -> Vector:
    """R I R^T a: a tensor given in the platform frame, applied to a vector of O-XYZ."""
    return transform(turn, transform(inertia, transform_back(turn, a)))


def acceleration(
    mass: Quantity,
    inertia: Matrix,
    inverse_inertia: Matrix,
    angles: Trigonometry,
    rates: Vector,
    force: Vector,
    moment: Vector,
) -> tuple[Vector, Vector]:
    """Eq. 2 solved for X''.

    Parameters
    ----------
    mass
        kg.
    inertia, inverse_inertia
        About the centre of mass in the platform frame, kg m2, and its inverse.
    angles
        From `model.kinematics.trigonometry`.
    rates
        phi', theta', psi' in rad/s.
    force, moment
        All that acts on the platform, gravity included, about the centre of mass, in O-XYZ;
        N and N m.

    Returns
    -------
    linear, angular
        [X_p'', Y_p'', Z_p''] in m/s2, and [phi'', theta'', psi''] in rad/s2.
    """
    turn = rotation(angles)
    omega = angular_velocity(angles, rates)
    gyroscopic = cross(omega, in_fixed_frame(turn, inertia, omega))
    spin = in_fixed_frame(turn, inverse_inertia, subtract(moment, gyroscopic))
    drift = angular_velocity_drift(angles, rates)
    return scale(1.0 / mass, force), rates_of(angles, subtract(spin, drift))


def required_wrench(
    mass: Quantity,
    inertia: Matrix,
    angles: Trigonometry,
    rates: Vector,
    linear: Vector,
    angular: Vector,
) -> tuple[Vector, Vector]:
    """M X'' + W_C of Eq. 2: the force and moment that give a known acceleration.

    Parameters
    ----------
    mass, inertia, angles, rates
        As for `acceleration`.
    linear, angular
        [X_p'', Y_p'', Z_p''] in m/s2, and [phi'', theta'', psi''] in rad/s2.

    Returns
    -------
    force, moment
        About the centre of mass, in O-XYZ; N and N m.
    """
    turn = rotation(angles)
    omega = angular_velocity(angles, rates)
    spin = add(angular_velocity(angles, angular), angular_velocity_drift(angles, rates))
    gyroscopic = cross(omega, in_fixed_frame(turn, inertia, omega))
    return scale(mass, linear), add(in_fixed_frame(turn, inertia, spin), gyroscopic)
