"""The commanded motion and the frozen wrench that would move the nominal machine along it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.machine import Machine
from cdpr8.rigfile import Excitation

Array = NDArray[np.float64]
Swing = tuple[Array, Array, Array]
"""Angle, its rate and its acceleration over time; rad, rad/s and rad/s2."""

AXES = ("roll", "pitch", "yaw")

SERVO_S = 4e-3
"""Standard deviation of the smoothing that a servo behind play gives its output, s."""


@dataclass(frozen=True)
class DriveFault:
    """What a drive does to the motion asked of it; the defaults are none.

    Parameters
    ----------
    amplitude_share
        Relative error of the amplitude.
    frequency_share
        Relative error of its clock.
    late_s
        Delay, s.
    harmonic_share, harmonic_order, harmonic_phase_rad
        A further line of the motion, relative to the amplitude.
    backlash_rad
        Half the play of its gear, rad.
    """

    amplitude_share: float = 0.0
    frequency_share: float = 0.0
    late_s: float = 0.0
    harmonic_share: float = 0.0
    harmonic_order: int = 2
    harmonic_phase_rad: float = 0.0
    backlash_rad: float = 0.0


SOUND = DriveFault()


def course(excitation: Excitation, fault: DriveFault, time_s: Array) -> Swing:
    """Angle of the motion about its axis, with its two derivatives.

    Parameters
    ----------
    excitation
        The motion asked for; rest, ramps and start as in a rig file.
    fault
        What the drive does to it.
    time_s
        Evenly spaced, shape (n,), s. At a jump the mean of both sides is taken.
    """
    step_s = float(time_s[1] - time_s[0])
    if fault.backlash_rad > 0.0:
        angle = _with_play(_angle(excitation, fault)(time_s), fault.backlash_rad, step_s)
        rate = np.gradient(angle, step_s)
        return angle, rate, np.gradient(rate, step_s)
    angle_at = _angle(excitation, fault)
    moving = _moving(excitation, fault, time_s, step_s)
    # Central differences of a smooth curve of known steps: exact to 1e-9 of the amplitude.
    base_s = 2e-4
    near = [angle_at(time_s + j * base_s, free=True) for j in (-2, -1, 0, 1, 2)]
    rate = (8.0 * (near[3] - near[1]) - (near[4] - near[0])) / (12.0 * base_s)
    bend = (16.0 * (near[3] + near[1]) - (near[4] + near[0]) - 30.0 * near[2]) / 12.0
    return moving * near[2], moving * rate, moving * bend / base_s**2


def _angle(excitation: Excitation, fault: DriveFault) -> Callable[..., Array]:
    """A w(tau) sin(2 pi f tau) and what the fault adds, of time."""
    amplitude = np.deg2rad(excitation.amplitude_deg) * (1.0 + fault.amplitude_share)
    circular = 2.0 * np.pi * excitation.frequency_hz

    def at(time_s: Array, free: bool = False) -> Array:
        tau = (time_s - excitation.start_s - fault.late_s) * (1.0 + fault.frequency_share)
        value = np.sin(circular * tau)
        if fault.harmonic_share:
            phase = fault.harmonic_order * circular * tau + fault.harmonic_phase_rad
            value = value + fault.harmonic_share * np.sin(phase)
        if excitation.ramp_s > 0.0:
            beyond_s = excitation.ramp_s if excitation.ending == "ramp_beyond" else 0.0
            value = value * _rise(tau / excitation.ramp_s, excitation.ramp)
            left_s = excitation.motion_s + beyond_s - tau
            value = value * _rise(left_s / excitation.ramp_s, excitation.ramp)
        elif not free:
            value = value * ((tau >= 0.0) & (tau <= excitation.motion_s))
        return np.asarray(amplitude * value)

    return at


def _rise(x: Array, law: str) -> Array:
    """From 0 to 1: a raised cosine, or with two smooth derivatives at both ends (quintic)."""
    x = np.clip(x, 0.0, 1.0)
    if law == "raised_cosine":
        return np.asarray(np.sin(0.5 * np.pi * x) ** 2)
    return np.asarray(x * x * x * (10.0 + x * (6.0 * x - 15.0)))


def _moving(excitation: Excitation, fault: DriveFault, time_s: Array, step_s: float) -> Array:
    """1 during the motion, 0 at rest, a half on the jumps of a motion without ramps."""
    if excitation.ramp_s > 0.0:
        return np.ones_like(time_s)
    first = excitation.start_s + fault.late_s
    last = first + excitation.motion_s / (1.0 + fault.frequency_share)
    inside = (time_s > first - 0.5 * step_s) & (time_s < last - 0.5 * step_s)
    at_end = np.abs(time_s - last) <= 0.5 * step_s
    return np.where(at_end, 0.5, inside.astype(float))


def _with_play(angle: Array, play: float, step_s: float) -> Array:
    """A gear with play: its output stands until the other flank is reached; a servo smooths it."""
    from scipy.ndimage import gaussian_filter1d

    out = np.empty_like(angle)
    held = 0.0
    for n, value in enumerate(angle.tolist()):
        held = min(max(held, value - play), value + play)
        out[n] = held
    return np.asarray(gaussian_filter1d(out, SERVO_S / step_s, mode="nearest"))


def frozen_wrench(machine: Machine, excitation: Excitation, motion: Swing) -> Array:
    """The wrench that makes the nominal machine follow the motion, its cables not vibrating.

    Parameters
    ----------
    machine
        As the run's own rig file describes it.
    excitation
        Says about which axis.
    motion
        Angle, rate and acceleration, each of shape (n,).

    Returns
    -------
    Array
        Force and moment about the centre of mass in O-XYZ, shape (n, 6); N and N m.
    """
    angle, rate, bend = motion
    axis = np.eye(3)[AXES.index(excitation.axis)]
    turn = _about(axis, angle)
    tensor = turn @ machine.inertia @ np.swapaxes(turn, 1, 2)
    momentum = tensor @ axis
    moment = momentum * bend[:, None] + np.cross(axis, momentum) * (rate * rate)[:, None]
    force = np.zeros_like(moment)
    force[:, 2] = machine.mass * machine.gravity
    rest_length, _ = machine.lines
    for i in range(len(machine.base)):
        arm = turn @ machine.anchor[i]
        line = machine.base[i] - arm
        length = np.linalg.norm(line, axis=1)
        tension = machine.pretension[i] + machine.stiffness[i] * (length - rest_length[i])
        pull = line * (np.maximum(tension, 0.0) / length)[:, None]
        force -= pull
        moment = moment - np.cross(arm, pull)
    return np.hstack([force, moment])


def _about(axis: Array, angle: Array) -> Array:
    """Rotation matrices about an axis (Rodrigues), shape (n, 3, 3)."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, rest = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    return np.asarray(np.eye(3) + sine * skew + rest * (skew @ skew))
