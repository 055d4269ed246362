"""What follows from the states: lengths, axial velocities and tensions of the cables, over time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from model.cable import tension
from model.kinematics import (
    angular_velocity,
    cable_line,
    length_rate,
    rotation,
    transform,
    trigonometry,
)
from model.machine import Machine

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CableStates:
    """The cables of a machine over time; each of shape (n, 8).

    Parameters
    ----------
    length_m
        L_i.
    elongation_m
        Delta L_i = L_i - L_0i, Eq. 14.
    axial_velocity_m_per_s
        v_yi = dL_i/dt, Eq. 13.
    tension_n
        T_i, Eq. 16.
    """

    length_m: Array
    elongation_m: Array
    axial_velocity_m_per_s: Array
    tension_n: Array


def cable_states(machine: Machine, pose: Array, pose_rate: Array, mid_span: Array) -> CableStates:
    """The cables for given states of platform and cables.

    Parameters
    ----------
    machine
        The machine.
    pose, pose_rate
        X and X', shape (n, 6); m, rad and s.
    mid_span
        X_w, shape (n, 8), m.
    """
    angles = trigonometry((pose[:, 3], pose[:, 4], pose[:, 5]))
    turn = rotation(angles)
    omega = angular_velocity(angles, (pose_rate[:, 3], pose_rate[:, 4], pose_rate[:, 5]))
    position = (pose[:, 0], pose[:, 1], pose[:, 2])
    velocity = (pose_rate[:, 0], pose_rate[:, 1], pose_rate[:, 2])
    length = np.empty((len(pose), machine.cables))
    axial_velocity = np.empty_like(length)
    for i in range(machine.cables):
        arm = transform(turn, tuple(machine.anchor[i]))
        length[:, i], direction = cable_line(tuple(machine.base[i]), position, arm)
        axial_velocity[:, i] = length_rate(direction, arm, velocity, omega)
    elongation = length - machine.rest_length
    pull = tension(machine.pretension, machine.stiffness, elongation, mid_span, length)
    return CableStates(length, elongation, axial_velocity, pull)


def mechanical_energy(machine: Machine, pose: Array, pose_rate: Array) -> Array:
    """Kinetic, elastic and gravitational energy of platform and cables without vibration.

    Eqs. 16 to 18 conserve it for X_w = 0 only: as printed, the cables' vibration pulls on the
    platform but is not pulled back by what it takes.

    Parameters
    ----------
    machine
        The machine.
    pose, pose_rate
        X and X', shape (n, 6); m, rad and s.

    Returns
    -------
    Array
        Shape (n,), J; zero for a platform at rest at the origin with unstretched springs.
    """
    angles = trigonometry((pose[:, 3], pose[:, 4], pose[:, 5]))
    turn = np.moveaxis(np.array(rotation(angles)), -1, 0)
    omega = np.stack(
        np.broadcast_arrays(
            *angular_velocity(angles, (pose_rate[:, 3], pose_rate[:, 4], pose_rate[:, 5]))
        ),
        axis=-1,
    )
    turning = np.einsum("nji,nj->ni", turn, omega)
    kinetic = 0.5 * machine.mass * np.sum(pose_rate[:, :3] ** 2, axis=1)
    kinetic += 0.5 * np.einsum("ni,ij,nj->n", turning, machine.inertia, turning)
    pull = cable_states(machine, pose, pose_rate, np.zeros((len(pose), machine.cables))).tension_n
    elastic = np.sum(pull**2 / (2.0 * machine.stiffness), axis=1)
    return np.asarray(kinetic + elastic + machine.mass * machine.gravity * pose[:, 2])
