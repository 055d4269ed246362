"""What acts on the platform beside its cables: dampers, air, a hose."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.compiled import law

Array = NDArray[np.float64]


@law
def loads(
    g: Array,
    place: Array,
    turn: Array,
    velocity: Array,
    omega: Array,
    attitude: Array,
    wrench: Array,
) -> None:
    """Add force and moment about the centre of mass, N and N m.

    Parameters
    ----------
    g
        Numbers of the platform.
    place, velocity, omega
        Of the centre of mass in O-XYZ, m, m/s and rad/s.
    turn
        Rotation matrix.
    attitude
        Roll, pitch, yaw, rad.
    wrench
        Six numbers; added to.
    """
    for j in range(3):
        wrench[j] -= g[at.DRAG_LINEAR] * velocity[j]
        wrench[3 + j] -= g[at.DRAG_TURNING] * omega[j]
    if g[at.FACES] > 0.0 or g[at.TURNING_AIR] > 0.0:
        _air(g, turn, velocity, omega, wrench)
    if g[at.HOSE] > 0.0 or g[at.HOSE_TURNING] > 0.0:
        away = 0.0
        for j in range(3):
            away += place[j] * place[j]
        spring = g[at.HOSE] * (1.0 + g[at.HOSE_HARDENING] * away)
        for j in range(3):
            wrench[j] -= spring * place[j] + g[at.HOSE] * g[at.HOSE_LOSS] * velocity[j]
            lag = attitude[j] + g[at.HOSE_LOSS] * omega[j]
            wrench[3 + j] -= g[at.HOSE_TURNING] * lag


@law
def _air(g: Array, turn: Array, velocity: Array, omega: Array, wrench: Array) -> None:
    """Each face of a box by the speed across it, in the platform frame; turning by its size."""
    spin = np.sqrt(omega[0] ** 2 + omega[1] ** 2 + omega[2] ** 2)
    for face in range(3):
        across = 0.0
        for j in range(3):
            across += turn[j, face] * velocity[j]
        push = -g[at.FACES + face] * abs(across) * across
        for j in range(3):
            wrench[j] += turn[j, face] * push
    for j in range(3):
        wrench[3 + j] -= g[at.TURNING_AIR] * spin * omega[j]
