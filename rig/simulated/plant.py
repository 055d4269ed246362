"""The platform behind the simulated rig: CDPR-8 with friction at its pulleys.

A machine of its own, not the model that is compared with it: a body-frame Newton-Euler platform
turned by a quaternion, cables with their first transverse mode, and at every pulley bristle
friction (LuGre: Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995, Eqs. 1-3). Only what
the machine is given is shared with `model`: the numbers of the rig file, the commanded motion and
the drive's frozen wrench.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig
from model.drive import required_drive
from model.machine import Machine
from model.motion import RampedSine

Array = NDArray[np.float64]

PULLEY_FRICTION_N = (0.216, 0.216, 0.556, 0.556, 0.556, 0.200, 0.200, 0.556)
"""Coulomb friction of the simulated pulleys, cable by cable: see sample_data/make_run01.py."""

BRISTLE_LENGTH_M = 5e-5
"""Deflection of the bristles at which a pulley slips."""

BRISTLE_DAMPING_N_S_PER_M = 2.0
"""Damping of the bristles; settles the ringing that sticking would leave."""

STEP_S = 1e-4
OUTPUT_EVERY = 10
LOST_M = 0.5
"""A platform farther than this from rest is no machine any more."""

_STATES = 13 + 3 * CABLES


class _Plant(NamedTuple):
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


@dataclass(frozen=True)
class PlatformTrajectory:
    """What the simulated platform and its cables did, at 1 kHz.

    Attributes
    ----------
    t_s
        Shape (n,), on the tension clock.
    pose
        X, Y, Z in m and roll, pitch, yaw in rad, shape (n, 6).
    tension_n
        At the platform's side of the pulleys, shape (n, 8), in N.
    """

    t_s: Array
    pose: Array
    tension_n: Array

    def pose_at(self, t_s: Array) -> Array:
        """Pose at any times, shape (len(t_s), 6); held before the first and after the last."""
        return np.column_stack([np.interp(t_s, self.t_s, axis) for axis in self.pose.T])

    def tension_at(self, cable: int, t_s: Array) -> Array:
        """Tension of cable 1 to 8 at any times, shape of `t_s`, in N."""
        return np.interp(t_s, self.t_s, self.tension_n[:, cable - 1])


def simulate_platform(
    rig: Rig, excitation: Excitation, friction_n: Array | None = None
) -> PlatformTrajectory:
    """Move the platform as commanded, with friction at the pulleys.

    Parameters
    ----------
    rig
        The machine.
    excitation
        The commanded motion; its disturbances act when the motion starts.
    friction_n
        Coulomb friction of each pulley, shape (8,); None takes `PULLEY_FRICTION_N`.

    Raises
    ------
    UsageError
        The motion throws the platform out of its workspace.
    """
    friction = np.asarray(PULLEY_FRICTION_N if friction_n is None else friction_n, dtype=float)
    machine = Machine.from_rig(rig)
    motion = RampedSine.from_excitation(excitation)
    steps = int(np.ceil(excitation.duration_s / STEP_S / OUTPUT_EVERY)) * OUTPUT_EVERY
    half_steps: Array = np.arange(2.0 * steps + 1.0) * (STEP_S / 2)
    command = motion.at(half_steps)
    wrench = required_drive(machine, *command)
    start = round(excitation.start_s / STEP_S)
    disturbance = np.zeros(_STATES)
    disturbance[0:3] = excitation.platform_offset_m
    disturbance[13 : 13 + CABLES] = excitation.cable_offset_m
    # Without a ramp the motion starts in the commanded state (design, section 4).
    first_rate = motion.at(np.array([excitation.start_s]))[1][0]
    disturbance[10:13] = first_rate[3:]
    plant = _Plant(
        machine.mass,
        machine.gravity,
        machine.inertia,
        np.asarray(np.linalg.inv(machine.inertia), dtype=np.float64),
        machine.base,
        machine.anchor,
        machine.rest_length,
        machine.stiffness,
        machine.pretension,
        machine.line_density,
        machine.damping,
        friction,
        BRISTLE_LENGTH_M,
        BRISTLE_DAMPING_N_S_PER_M,
    )
    states, tension = _advance(plant, steps, start, disturbance, wrench, STEP_S, OUTPUT_EVERY)
    if not np.all(np.abs(states[:, 0:3]) < LOST_M):
        raise UsageError(
            f"the simulated platform leaves its workspace at {excitation.frequency_hz} Hz and "
            f"{excitation.amplitude_deg} deg",
            remedy="a smaller amplitude, or a frequency away from the cables' resonances",
        )
    return PlatformTrajectory(
        t_s=np.arange(float(len(states))) * (STEP_S * OUTPUT_EVERY),
        pose=np.column_stack([states[:, 0:3], _roll_pitch_yaw(states[:, 3:7])]),
        tension_n=tension,
    )


def _roll_pitch_yaw(quaternion: Array) -> Array:
    """Angles of R = Rz(yaw) Ry(pitch) Rx(roll) from unit quaternions (w, x, y, z), shape (n, 3)."""
    w, x, y, z = quaternion.T
    return np.column_stack(
        [
            np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
            np.arcsin(np.clip(2 * (w * y - z * x), -1, 1)),
            np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        ]
    )


@numba.njit(cache=True, error_model="numpy")
def _rotation(q: Array) -> Array:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@numba.njit(cache=True, error_model="numpy")
def _rates(plant: _Plant, state: Array, wrench: Array, rate: Array, tension: Array) -> None:
    """Time derivative of the state into `rate`, cable tensions into `tension`.

    State: position (3), quaternion (4), velocity (3), body angular velocity (3), mid-span
    amplitudes (8), their rates (8), bristle deflections (8).
    """
    turn = _rotation(state[3:7])
    velocity = state[7:10]
    omega = state[10:13]
    force = np.array([wrench[0], wrench[1], wrench[2] - plant.mass * plant.gravity])
    moment = wrench[3:6].copy()
    for i in range(len(plant.stiffness)):
        arm = turn @ plant.anchor[i]
        line = plant.base[i] - state[0:3] - arm
        length = np.sqrt(line @ line)
        direction = line / length
        point_velocity = velocity + turn @ np.cross(omega, plant.anchor[i])
        stretching = -(direction @ point_velocity)
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
        force += pull * direction
        moment += np.cross(arm, pull * direction)
        tone_squared = (np.pi / length) ** 2 * (pull / plant.line_density[i] - stretching**2)
        rate[13 + i] = state[21 + i]
        rate[21 + i] = -plant.damping[i] * state[21 + i] - tone_squared * middle
        rate[29 + i] = slip
    w, x, y, z = state[3:7]
    p, q, r = omega
    rate[0:3] = velocity
    rate[3] = 0.5 * (-x * p - y * q - z * r)
    rate[4] = 0.5 * (w * p + y * r - z * q)
    rate[5] = 0.5 * (w * q - x * r + z * p)
    rate[6] = 0.5 * (w * r + x * q - y * p)
    rate[7:10] = force / plant.mass
    gyroscopic = np.cross(omega, plant.inertia @ omega)
    rate[10:13] = plant.inverse_inertia @ (turn.T @ moment - gyroscopic)


@numba.njit(cache=True, error_model="numpy")
def _advance(
    plant: _Plant,
    steps: int,
    start: int,
    disturbance: Array,
    wrench: Array,
    step: float,
    every: int,
) -> tuple[Array, Array]:
    """Classic fourth-order Runge-Kutta at a fixed step; the disturbance is added at `start`.

    `wrench` stands at every half step, shape (2 steps + 1, 6).
    """
    size = len(disturbance)
    cables = len(plant.stiffness)
    state = np.zeros(size)
    state[3] = 1.0
    states = np.zeros((steps // every + 1, size))
    tensions = np.zeros((steps // every + 1, cables))
    k1, k2, k3, k4 = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size)
    tension, spare = np.zeros(cables), np.zeros(cables)
    for n in range(steps + 1):
        if n == start:
            state += disturbance
        _rates(plant, state, wrench[2 * n], k1, tension)
        if n % every == 0:
            states[n // every] = state
            tensions[n // every] = tension
        if n == steps:
            break
        _rates(plant, state + 0.5 * step * k1, wrench[2 * n + 1], k2, spare)
        _rates(plant, state + 0.5 * step * k2, wrench[2 * n + 1], k3, spare)
        _rates(plant, state + step * k3, wrench[2 * n + 2], k4, spare)
        state += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        state[3:7] /= np.sqrt(state[3:7] @ state[3:7])
    return states, tensions
