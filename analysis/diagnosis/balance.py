"""The three residuals that say on which side something is missing.

(a) Each cable's law: what its tension has beyond T_0i + k_i Delta L_i at the measured pose.
(b) The platform's balance of wrenches: M X'' + W_C + weight less cables and drive, Eq. 2.
(c) Of (a), the part that moves nothing: eight cables pull in six directions, two are inner.

Friction between frame and cell is in (a) of its cable; between cell and platform in (b), along its
column, as is what else pulls there; creep of pretensions in (c); a late camera in all (a) alike.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.nuisances import (
    CAMERA_SHARE,
    CELL_SHARE,
    DRIVE_SHARE,
    LATENCY_S,
    SAMPLE_S,
    START_S,
    inertia_shares,
)
from analysis.diagnosis.recording import Recording
from analysis.steady import Steady, arms, harmonic_basis, lengths, noise_level, steady
from model import Machine
from model.drive import required_drive
from model.kinematics import rotation, trigonometry
from model.motion import RampedSine
from model.platform import required_wrench

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PHASES, TENSION_HARMONICS = 128, 10

SEEN = 4.0
"""A harmonic that stands out of its sigma by this is seen."""


@dataclass(frozen=True)
class Residual:
    """One of the three, over the mean period of the steady motion.

    Attributes
    ----------
    names, units
        Of its rows.
    series
        Shape (rows, phases), about their means.
    amplitude
        Of the drive's first harmonics, cosine less i sine, shape (rows, harmonics).
    covariance
        What noise, and the rig file's numbers and clocks within their sigmas, make of each
        cosine and sine, shape (rows, harmonics, 2, 2). A stiffness that is off makes no quadrature.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    series: Array
    amplitude: Complex
    covariance: Array

    @property
    def sigma(self) -> Array:
        """Of the amplitudes' magnitudes, shape (rows, harmonics)."""
        return np.asarray(np.sqrt(np.trace(self.covariance, axis1=2, axis2=3)))

    @property
    def significance(self) -> Array:
        """Of each row, how far its most prominent harmonic stands out, in sigmas."""
        return self.against(self.amplitude)

    def against(self, amplitude: Complex) -> Array:
        """How far such amplitudes, shape (rows, harmonics), would stand out, shape (rows,)."""
        both = _both(amplitude)
        square = (both * np.linalg.solve(self.covariance, both[..., None])[..., 0]).sum(axis=-1)
        return np.asarray(np.sqrt(square.max(axis=1)))

    @property
    def seen(self) -> tuple[str, ...]:
        """Rows that stand out."""
        return tuple(
            name for name, one in zip(self.names, self.significance, strict=True) if one > SEEN
        )


@dataclass(frozen=True)
class Balance:
    """The three residuals of a run.

    Attributes
    ----------
    phase_s
        Times of the series, from the start of a period, shape (phases,).
    cables, platform, inner
        Residuals (a) in N, (b) in N and N m, and (c) in N.
    inner_directions
        Tensions that move nothing, shape (8, 2).
    structure
        Wrench of unit tensions at rest, shape (6, 8).
    spring
        Of k_i Delta L_i at the measured pose, at the drive's frequency, cosine less i sine, shape
        (8,).
    """

    phase_s: Array
    cables: Residual
    platform: Residual
    inner: Residual
    inner_directions: Array
    structure: Array
    spring: Complex


@dataclass(frozen=True)
class _Known:
    """What the residuals are computed with: each can be moved by its sigma."""

    machine: Machine
    gain: Array
    camera_gain: float
    late_s: float
    early_s: Array
    drive_share: float
    drive_late_s: float


def balance(recording: Recording) -> Balance:
    """The three residuals over a run's steady motion.

    Parameters
    ----------
    recording
        The run.

    Raises
    ------
    DataError
        The run has no poses or no steady motion.
    """
    part = steady(recording)
    machine = Machine.from_rig(recording.rig)
    tension, noise = _tension_harmonics(part)
    known = _Known(machine, np.ones(8), 1.0, 0.0, np.zeros(8), 0.0, 0.0)
    start = recording.excitation.start_s + recording.shift_s
    first_s = np.ceil((part.middle_s - start) * part.hertz) / part.hertz + start
    t_s = first_s + np.arange(PHASES) / (PHASES * part.hertz)
    count = (len(part.pose) - 1) // 2
    inner = _inner(machine)

    def rows(one: _Known) -> Array:
        return _rows(recording, part, tension, one, inner, t_s)

    here = rows(known)
    noise_only = 0.5 * _noise(part, machine, noise, inner, count)
    covariance = noise_only[..., None, None] * np.eye(2)
    for one in _moved(recording, known):
        change = _both(_harmonics(rows(one) - here, count))
        covariance += change[..., :, None] * change[..., None, :]
    series, amplitude = here - here.mean(axis=1, keepdims=True), _harmonics(here, count)
    parts = [slice(0, 8), slice(8, 14), slice(14, 16)]
    wrench = tuple(f"{kind} {axis}" for kind in ("force", "moment") for axis in "xyz")
    names = [tuple(f"cable {i}" for i in range(1, 9)), wrench, ("inner 1", "inner 2")]
    units = [("N",) * 8, ("N",) * 3 + ("N m",) * 3, ("N", "N")]
    cables, platform, along = (
        Residual(n, u, series[p], amplitude[p], covariance[p])
        for n, u, p in zip(names, units, parts, strict=True)
    )
    pose = part.pose_at(t_s)
    ends = zip(machine.stiffness, machine.base, machine.anchor, strict=True)
    spring = np.stack([k * lengths(pose, base, anchor) for k, base, anchor in ends])
    return Balance(
        t_s - t_s[0], cables, platform, along, inner, machine.structure,
        _harmonics(spring, 1)[:, 0],
    )  # fmt: skip


def _tension_harmonics(part: Steady) -> tuple[Array, Array]:
    """Coefficients, shape (8, 1 + 2 h), and sigma of an amplitude's magnitude, shape (8, h)."""
    found = np.full((8, 1 + 2 * TENSION_HARMONICS), np.nan)
    noise = np.full((8, TENSION_HARMONICS), np.inf)
    for i, (t_s, value) in enumerate(zip(part.tension_t_s, part.tension_n, strict=True)):
        if len(t_s) > 4 * TENSION_HARMONICS:
            basis = harmonic_basis(t_s, part.hertz, TENSION_HARMONICS)
            found[i] = np.linalg.lstsq(basis, value, rcond=None)[0]
            rest = value - basis @ found[i]
            noise[i] = [
                np.sqrt(4.0 * noise_level(t_s, rest, h * part.hertz) / len(t_s))
                for h in range(1, TENSION_HARMONICS + 1)
            ]
    return found, noise


def _rows(
    recording: Recording, part: Steady, tension: Array, known: _Known, inner: Array, t_s: Array
) -> Array:
    """(a), (b), (c) over a period, shape (16, phases); cables without tension follow their law."""
    machine = known.machine
    pose, rate, acceleration = _motion(part, t_s + known.late_s)
    pose, rate, acceleration = (known.camera_gain * one for one in (pose, rate, acceleration))
    pulled, law = np.empty((8, PHASES)), np.empty((8, PHASES))
    for i in range(8):
        stretch = lengths(pose, machine.base[i], machine.anchor[i]) - machine.rest_length[i]
        law[i] = machine.pretension[i] + machine.stiffness[i] * stretch
        basis = harmonic_basis(t_s + known.early_s[i], part.hertz, TENSION_HARMONICS)
        pulled[i] = known.gain[i] * (basis @ tension[i])
    pulled = np.where(np.isnan(pulled), law, pulled)
    beyond = pulled - law
    command = RampedSine.from_excitation(recording.excitation)
    nominal = Machine.from_rig(recording.rig)
    asked = command.at(t_s - recording.shift_s - known.drive_late_s)
    pushed = 0.0 if recording.excitation.drive == "winch" else 1.0
    drive = required_drive(nominal, *(pushed * one for one in asked))
    drive = (1.0 + known.drive_share) * drive
    left = _wrench(machine, pose, rate, acceleration, pulled, drive)
    return np.vstack([beyond, left, inner.T @ beyond])


def _wrench(
    machine: Machine, pose: Array, rate: Array, acceleration: Array, pulled: Array, drive: Array
) -> Array:
    """M X'' + W_C + weight less cables and drive, shape (6, phases)."""
    angles = trigonometry((pose[:, 3], pose[:, 4], pose[:, 5]))
    rates, linear, angular = rate[:, 3:], acceleration[:, :3], acceleration[:, 3:]
    moving = (tuple(one.T) for one in (rates, linear, angular))
    force, moment = required_wrench(machine.mass, machine.inertia, angles, *moving)
    wanted = np.stack(np.broadcast_arrays(*force, *moment))
    wanted[2] += machine.mass * machine.gravity
    turn = rotation(angles)
    for i in range(8):
        arm = arms(turn, machine.anchor[i])
        line = machine.base[i] - pose[:, :3] - arm
        pull = line / np.linalg.norm(line, axis=1, keepdims=True) * pulled[i][:, None]
        wanted[:3] -= pull.T
        wanted[3:] -= np.cross(arm, pull).T
    return np.asarray(wanted - drive.T)


def _motion(part: Steady, t_s: Array) -> tuple[Array, Array, Array]:
    """Fitted pose, rate and acceleration, shape (n, 6)."""
    count = (len(part.pose) - 1) // 2
    own = np.repeat(part.circular * np.arange(1, count + 1), 2)
    basis = harmonic_basis(t_s, part.hertz, count)
    turned = basis[:, 1:].reshape(len(t_s), count, 2)[:, :, ::-1] * np.array([-1.0, 1.0])
    slope = turned.reshape(len(t_s), 2 * count) * own
    return (
        np.asarray(basis @ part.pose),
        np.asarray(slope @ part.pose[1:]),
        np.asarray(-(basis[:, 1:] * own**2) @ part.pose[1:]),
    )


def _both(amplitude: Complex) -> Array:
    """Cosine and sine on a last axis."""
    return np.stack([amplitude.real, -amplitude.imag], axis=-1)


def _harmonics(rows: Array, count: int) -> Complex:
    return np.asarray(2.0 / rows.shape[1] * np.fft.rfft(rows, axis=1)[:, 1 : count + 1])


def _inner(machine: Machine) -> Array:
    """Two orthonormal sets of tensions that make no wrench at rest, shape (8, 2)."""
    return np.asarray(np.linalg.svd(machine.structure)[2][6:].T)


def _noise(part: Steady, machine: Machine, noise: Array, inner: Array, count: int) -> Array:
    """Variance of the amplitudes for noise of cells and poses alone, shape (16, harmonics)."""
    cells = np.where(np.isfinite(noise[:, :count]), noise[:, :count], 0.0) ** 2
    poses = 2.0 * (machine.stiffness * part.pose_noise_m) ** 2
    beyond = cells + poses[:, None]
    inertia = np.concatenate([np.full(3, machine.mass), np.diag(machine.inertia)])
    faster = (part.circular * np.arange(1, count + 1)) ** 2
    pushed = 2.0 * (inertia * part.axis_noise)[:, None] ** 2 * faster**2
    return np.vstack([beyond, machine.structure**2 @ cells + pushed, (inner**2).T @ beyond])


def _moved(recording: Recording, known: _Known) -> Sequence[_Known]:
    """Each number of the rig file, and each clock and gain, moved by its sigma."""
    rig, machine = recording.rig, known.machine
    unit = np.eye(8)
    found: list[_Known] = []

    def change(**changes: Any) -> None:
        found.append(replace(known, machine=replace(machine, **changes)))

    shares = inertia_shares(rig)
    for axis in range(3):
        inertia = machine.inertia.copy()
        inertia[axis, axis] *= 1.0 + shares[axis]
        change(inertia=inertia)
    change(mass=machine.mass + rig.platform.mass_kg.sigma)
    for i, cable in enumerate(rig.cable):
        change(stiffness=machine.stiffness + cable.stiffness_n_per_m.sigma * unit[i])
        for axis in range(3):
            moved = np.outer(unit[i], np.eye(3)[axis])
            change(anchor=machine.anchor + cable.anchor_m.sigma * moved)
            change(base=machine.base + cable.base_m.sigma * moved)
        found.append(replace(known, gain=known.gain + CELL_SHARE * unit[i]))
        found.append(replace(known, early_s=SAMPLE_S * unit[i]))
    return [
        *found,
        replace(known, camera_gain=1.0 + CAMERA_SHARE),
        replace(known, late_s=LATENCY_S),
        replace(known, drive_share=DRIVE_SHARE),
        replace(known, drive_late_s=START_S),
    ]
