"""The platform behind the simulated rig: CDPR-8 with friction at its pulleys.

A machine of its own, not the model that is compared with it: a body-frame Newton-Euler platform
turned by a quaternion, cables with their first transverse mode, and at every pulley bristle
friction (LuGre: Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995, Eqs. 1-3). Only what
the machine is given is shared with `model`: the numbers of the rig file, the commanded motion and
the drive's frozen wrench.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig
from model.drive import required_drive
from model.machine import Machine
from model.motion import RampedSine
from rig.simulated.plant_kernel import STATES, Plant, advance

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

PIECE_S = 2.0
"""So much is simulated at a time: a tenth of a second's work, and little memory."""


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

    def then(self, after: "PlatformTrajectory", from_s: float = -np.inf) -> "PlatformTrajectory":
        """These and the times after them; of these only what `from_s` and later asks for, s."""
        kept = slice(max(0, int(np.searchsorted(self.t_s, from_s, side="right")) - 1), None)
        return PlatformTrajectory(
            np.concatenate([self.t_s[kept], after.t_s]),
            np.concatenate([self.pose[kept], after.pose]),
            np.concatenate([self.tension_n[kept], after.tension_n]),
        )


class PlatformSimulation:
    """Moves the platform as commanded, with friction at the pulleys, piece after piece.

    Parameters
    ----------
    rig
        The machine.
    excitation
        The commanded motion; its disturbances act when the motion starts.
    friction_n
        Coulomb friction of each pulley, shape (8,); None takes `PULLEY_FRICTION_N`.
    """

    def __init__(self, rig: Rig, excitation: Excitation, friction_n: Array | None = None) -> None:
        friction = np.asarray(PULLEY_FRICTION_N if friction_n is None else friction_n, dtype=float)
        self._machine = machine = Machine.from_rig(rig)
        self._motion = RampedSine.from_excitation(excitation)
        self._excitation = excitation
        self._left = int(np.ceil(excitation.duration_s / STEP_S / OUTPUT_EVERY)) + 1
        self._done = 0
        self._start = round(excitation.start_s / STEP_S)
        self._disturbance = np.zeros(STATES)
        self._disturbance[0:3] = excitation.platform_offset_m
        self._disturbance[13 : 13 + CABLES] = excitation.cable_offset_m
        # Without a ramp the motion starts in the commanded state (design, section 4).
        first_rate = self._motion.at(np.array([excitation.start_s]))[1][0]
        self._disturbance[10:13] = first_rate[3:]
        self._state = np.zeros(STATES)
        self._state[3] = 1.0
        self._plant = Plant(
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

    @property
    def over(self) -> bool:
        """Whether the excitation's whole duration is simulated."""
        return self._left == 0

    def advance(self, seconds: float = PIECE_S) -> PlatformTrajectory:
        """The next so many seconds; fewer at the end.

        Raises
        ------
        UsageError
            The motion throws the platform out of its workspace.
        """
        rows = min(self._left, max(1, round(seconds / STEP_S / OUTPUT_EVERY)))
        first, steps = self._done * OUTPUT_EVERY, rows * OUTPUT_EVERY
        half_steps: Array = np.arange(2.0 * first, 2.0 * (first + steps) + 1.0) * (STEP_S / 2)
        wrench = required_drive(self._machine, *self._motion.at(half_steps))
        start = self._start - first
        states, tension = advance(
            self._plant, self._state, steps, start, self._disturbance, wrench, STEP_S, OUTPUT_EVERY
        )
        if not np.all(np.abs(states[:, 0:3]) < LOST_M):
            raise UsageError(
                f"the simulated platform leaves its workspace at {self._excitation.frequency_hz} "
                f"Hz and {self._excitation.amplitude_deg} deg",
                remedy="a smaller amplitude, or a frequency away from the cables' resonances",
            )
        number = np.arange(float(self._done), float(self._done + rows))
        self._done += rows
        self._left -= rows
        return PlatformTrajectory(
            t_s=number * (STEP_S * OUTPUT_EVERY),
            pose=np.column_stack([states[:, 0:3], _roll_pitch_yaw(states[:, 3:7])]),
            tension_n=tension,
        )


def simulate_platform(
    rig: Rig, excitation: Excitation, friction_n: Array | None = None
) -> PlatformTrajectory:
    """The whole motion at once: parameters and errors of `PlatformSimulation`."""
    simulation = PlatformSimulation(rig, excitation, friction_n)
    pieces = []
    while not simulation.over:
        pieces.append(simulation.advance())
    return PlatformTrajectory(
        np.concatenate([piece.t_s for piece in pieces]),
        np.concatenate([piece.pose for piece in pieces]),
        np.concatenate([piece.tension_n for piece in pieces]),
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
