"""The commanded motion, what a faulty drive makes of it, and the frozen wrench that it applies."""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.machine import Machine
from analysis.challenge.outsider.path import straight
from analysis.challenge.outsider.rigid_body import GRAVITY
from analysis.challenge.outsider.vectors import at, cross, gained, times, turned, turned_back
from cdpr8.rigfile import Excitation

Array = NDArray[np.float64]

AXES = ("roll", "pitch", "yaw")

SERVO_S = 0.006
"""Standard deviation of the gaussian by which a servo smooths the jumps of a gear with play, s.

Of what play takes away alone: over the whole motion it would take 1.1 % of an amplitude at 4 Hz."""


@dataclass(frozen=True)
class DriveFault:
    """What a drive does to the motion asked of it; the defaults are none.

    Parameters
    ----------
    amplitude_share, frequency_share
        Relative errors of amplitude and frequency; the ramps keep their times.
    late_s
        Delay, s.
    harmonic_share, harmonic_order, harmonic_phase_rad
        A further line, relative to the amplitude.
    play_rad
        The whole clearance of its gear, rad.
    """

    amplitude_share: float = 0.0
    frequency_share: float = 0.0
    late_s: float = 0.0
    harmonic_share: float = 0.0
    harmonic_order: int = 2
    harmonic_phase_rad: float = 0.0
    play_rad: float = 0.0


SOUND = DriveFault()

RAMPS: dict[str, Callable[[Array], Array]] = {
    "quintic": lambda x: x**3 * (10.0 - 15.0 * x + 6.0 * x * x),
    "raised_cosine": lambda x: 0.5 - 0.5 * np.cos(np.pi * x),
    "cubic": lambda x: x**2 * (3.0 - 2.0 * x),
    "septic": lambda x: x**4 * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x**3),
}
"""How the motion grows, as the rig file names it; x from 0 to 1."""


def angle(excitation: Excitation, fault: DriveFault, time_s: Array) -> Array:
    """The angle that the drive commands, A w(tau) sin(2 pi f tau), rad.

    Parameters
    ----------
    excitation
        The motion asked for; with ramps: a motion that starts at once is not this plant's.
    fault
        What the drive does to it.
    time_s
        Evenly spaced, shape (n,), s.

    Raises
    ------
    ValueError
        The motion has no ramp.
    """
    if excitation.ramp_s <= 0.0:
        raise ValueError("this plant drives motions with a ramp only")
    amplitude = np.radians(excitation.amplitude_deg * (1.0 + fault.amplitude_share))
    frequency = excitation.frequency_hz * (1.0 + fault.frequency_share)
    tau = time_s - excitation.start_s - fault.late_s
    phase = 2.0 * np.pi * frequency * tau
    swing = np.sin(phase)
    if fault.harmonic_share:
        line = np.sin(fault.harmonic_order * phase + fault.harmonic_phase_rad)
        swing = swing + fault.harmonic_share * line
    found = amplitude * _window(excitation, tau) * swing
    if fault.play_rad > 0.0:
        from scipy.ndimage import gaussian_filter1d

        step_s = float(time_s[1] - time_s[0])
        lost = behind_play(found, fault.play_rad / 2.0) - found
        found = found + gaussian_filter1d(lost, SERVO_S / step_s)
    return np.asarray(found)


def _window(excitation: Excitation, tau: Array) -> Array:
    """w: up over a ramp, down by the same law as the excitation's ending says."""
    ramp, ramp_s = RAMPS[excitation.ramp], excitation.ramp_s
    last_s = excitation.end_s - excitation.start_s
    up = ramp(np.clip(tau / ramp_s, 0.0, 1.0))
    if excitation.ending == "at_once":
        return np.asarray(up * (tau <= last_s))
    return np.asarray(up * ramp(np.clip((last_s - tau) / ramp_s, 0.0, 1.0)))


@law
def behind_play(moved: Array, half: float) -> Array:
    """A gear with play: what follows stands until the other flank is reached (play operator)."""
    found = np.empty_like(moved)
    held = 0.0
    for j in range(len(moved)):
        if moved[j] - held > half:
            held = moved[j] - half
        elif moved[j] - held < -half:
            held = moved[j] + half
        found[j] = held
    return found


def frozen_wrench(nominal: Machine, excitation: Excitation, motion: Array, step_s: float) -> Array:
    """The wrench by which the nominal machine, its cables at rest, would follow a motion.

    Newton and Euler for a body that turns about one axis; rates by central differences.

    Parameters
    ----------
    nominal
        As the run's own rig file describes it.
    excitation
        Says about which axis.
    motion
        The angle at evenly spaced instants, shape (n,), rad.
    step_s
        Between two of them, s.

    Returns
    -------
    Array
        Force and moment about the rig file's centre of mass, O-XYZ, shape (n, 6); N and N m.
    """
    rate = np.gradient(motion, step_s, edge_order=2)
    growth = np.gradient(rate, step_s, edge_order=2)
    axis = np.eye(3)[AXES.index(excitation.axis)]
    found = np.zeros((len(motion), 6))
    _write_wrenches(
        axis, motion, rate, growth, nominal.inertia, nominal.base, nominal.anchor,
        nominal.lines[0], nominal.stiffness, nominal.pretension, found,
    )  # fmt: skip
    found[:, 2] += nominal.mass * GRAVITY
    return found


@law
def _write_turn_about(axis: Array, angle: float, turn: Array) -> None:
    """Rodrigues' rotation about a unit axis (3,), written to `turn`, (3, 3)."""
    x, y, z = axis[0], axis[1], axis[2]
    sine, rest = sin(angle), 1.0 - cos(angle)
    turn[0, 0], turn[0, 1], turn[0, 2] = 1.0 - rest * (y * y + z * z), -sine * z, sine * y
    turn[1, 0], turn[1, 1], turn[1, 2] = sine * z, 1.0 - rest * (x * x + z * z), -sine * x
    turn[2, 0], turn[2, 1], turn[2, 2] = -sine * y, sine * x, 1.0 - rest * (x * x + y * y)
    for i in range(3):
        for j in range(3):
            if i != j:
                turn[i, j] += rest * axis[i] * axis[j]


@law
def _write_wrenches(
    axis: Array,
    motion: Array,
    rate: Array,
    growth: Array,
    inertia: Array,
    base: Array,
    anchor: Array,
    rest_length: Array,
    stiffness: Array,
    pretension: Array,
    found: Array,
) -> None:
    """Inertia's moment less the cables' pull, at each instant, added to `found`, shape (n, 6)."""
    turn = np.zeros((3, 3))
    about = at(axis, 0)
    for n in range(len(motion)):
        _write_turn_about(axis, motion[n], turn)
        momentum = turned(turn, turned(inertia, turned_back(turn, about)))
        gained(found[n], 3, times(growth[n], momentum))
        gained(found[n], 3, times(rate[n] * rate[n], cross(about, momentum)))
        for i in range(len(base)):
            arm = turned(turn, at(anchor[i], 0))
            length, direction = straight(arm, at(base[i], 0))
            tension = pretension[i] + stiffness[i] * (length - rest_length[i])
            pull = times(-tension, direction)
            gained(found[n], 0, pull)
            gained(found[n], 3, cross(arm, pull))
