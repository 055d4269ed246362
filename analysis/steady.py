"""A run's steady motion: poses as harmonics, and elongations at the tensions' own times.

A camera of 16 frames a second knows a motion of 2 Hz well, if not at every instant: poses are
fitted by the drive's harmonics below the camera's band, and lengths follow from that fit.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.recording import Recording
from cdpr8.errors import DataError
from model import Machine
from model.kinematics import Matrix, rotation, trigonometry

Array = NDArray[np.float64]

HARMONICS = 3
"""Of the drive, in the poses, at most."""

BAND = 0.45
"""Of the camera's rate: harmonics above it would be folded."""

LEAST_SAMPLES = 16

NEIGHBOURS = (2, 3, 4, 5, 6)
"""Lines about the drive's, on each side, that tell how much noise there is at its frequency."""

RATE_STEP = 1e-4
"""Of the difference that gives a rate, in periods."""


@dataclass(frozen=True)
class Steady:
    """The steady part of one run.

    Attributes
    ----------
    hertz
        The drive's frequency.
    machine
        Of the rig file.
    tension_t_s, tension_n
        For cables 1 to 8; empty where a cable has none.
    pose
        Coefficients of the poses' harmonics, shape (1 + 2 h, 6): mean, cosines and sines; m, rad.
    pose_noise_m
        Standard deviation of the cosine (or sine) amplitude of the fitted elongation, shape (8,).
    tension_noise_n
        The same of the tension, about what follows the elongation, shape (8,).
    moved_m
        Amplitude of the elongation at the drive's frequency, shape (8,).
    axis_noise
        As `pose_noise_m`, of the pose's own axes, shape (6,), m and rad.
    middle_s
        Of the steady motion.
    """

    hertz: float
    machine: Machine
    tension_t_s: tuple[Array, ...]
    tension_n: tuple[Array, ...]
    pose: Array
    pose_noise_m: Array
    tension_noise_n: Array
    moved_m: Array
    axis_noise: Array
    middle_s: float

    @property
    def circular(self) -> float:
        """The drive's, rad/s."""
        return 2.0 * np.pi * self.hertz

    def pose_at(self, t_s: Array) -> Array:
        """Fitted poses, shape (n, 6)."""
        return np.asarray(harmonic_basis(t_s, self.hertz, (len(self.pose) - 1) // 2) @ self.pose)

    def slopes(
        self,
        base: Array,
        anchor: Array,
        zero: Array | None = None,
        turn: Array | None = None,
        late_s: float = 0.0,
    ) -> Array:
        """Slopes of tension over elongation, shape (8,), N/m; NaN where a cable has no tension.

        Parameters
        ----------
        base, anchor
            Of the cables, shape (8, 3), m.
        zero
            Added to the poses, shape (6,).
        turn
            By which the camera's axes are turned, shape (3,), rad.
        late_s
            By how much the camera's stamps are late.
        """
        found = np.full(8, np.nan)
        for i, (t_s, tension) in enumerate(zip(self.tension_t_s, self.tension_n, strict=True)):
            if len(t_s) > LEAST_SAMPLES:
                columns = self.columns(t_s + late_s, base[i], anchor[i], zero, turn)
                found[i] = np.linalg.lstsq(columns, tension, rcond=None)[0][2]
        return found

    def columns(
        self,
        t_s: Array,
        base: Array,
        anchor: Array,
        zero: Array | None = None,
        turn: Array | None = None,
    ) -> Array:
        """What a tension is regressed on, shape (n, 4): 1, time, elongation, its rate / omega."""
        step = RATE_STEP / self.hertz

        def length(at_s: Array) -> Array:
            pose = self.pose_at(at_s)
            if turn is not None:
                pose = pose + np.hstack([np.cross(turn, pose[:, :3]), np.cross(turn, pose[:, 3:])])
            return lengths(pose if zero is None else pose + zero, base, anchor)

        stretch = length(t_s)
        rate = (length(t_s + step) - length(t_s - step)) / (2.0 * step * self.circular)
        middle = t_s - t_s.mean()
        return np.column_stack([np.ones_like(t_s), middle, stretch - stretch.mean(), rate])


def steady(recording: Recording) -> Steady:
    """The steady part of a run.

    Parameters
    ----------
    recording
        The run.

    Raises
    ------
    DataError
        It has no poses, no steady motion, or its camera is too slow for it.
    """
    where = str(recording.run.folder)
    if not recording.has_pose:
        raise DataError("the run has no usable poses, so no elongations", where=where)
    hertz = recording.excitation.frequency_hz
    window = _window(recording)
    poses = recording.bundles[-1]
    inside = (poses.t_s >= window[0]) & (poses.t_s < window[1])
    t_s, value = poses.t_s[inside], poses.value[inside]
    fps = 1.0 / float(np.median(np.diff(t_s))) if len(t_s) > LEAST_SAMPLES else 0.0
    count = min(HARMONICS, int(BAND * fps / hertz))
    if count < 1:
        raise DataError(
            f"{fps:.1f} poses a second do not follow a motion of {hertz:g} Hz",
            where=where,
            allowed=f"below {BAND * fps:.2g} Hz",
            remedy="record a slower motion",
        )
    basis = harmonic_basis(t_s, hertz, count)
    coefficients = np.asarray(np.linalg.lstsq(basis, value, rcond=None)[0], dtype=np.float64)
    machine = Machine.from_rig(recording.rig)
    left = value - basis @ coefficients
    along = length_gradient(machine, coefficients[0])

    def noise_of(along: Array) -> Array:
        levels = [noise_level(t_s, left @ row, hertz) for row in along]
        return np.sqrt(2.0 * np.array(levels) / len(t_s))

    times, values = [np.zeros(0)] * 8, [np.zeros(0)] * 8
    for cable, bundle in zip(recording.cables, recording.bundles, strict=False):
        inside = (bundle.t_s >= window[0]) & (bundle.t_s < window[1])
        times[cable - 1], values[cable - 1] = bundle.t_s[inside], bundle.value[inside, 0]
    part = Steady(
        hertz=hertz,
        machine=machine,
        tension_t_s=tuple(times),
        tension_n=tuple(values),
        pose=coefficients,
        pose_noise_m=noise_of(along),
        tension_noise_n=np.full(8, np.inf),
        moved_m=np.hypot(*(along @ coefficients[1:3].T).T),
        axis_noise=noise_of(np.eye(6)),
        middle_s=(window[0] + window[1]) / 2.0,
    )
    noise = np.full(8, np.inf)
    for i in range(8):
        if len(times[i]) > LEAST_SAMPLES:
            columns = part.columns(times[i], machine.base[i], machine.anchor[i])
            rest = values[i] - columns @ np.linalg.lstsq(columns, values[i], rcond=None)[0]
            noise[i] = np.sqrt(2.0 * noise_level(times[i], rest, hertz) / len(times[i]))
    return replace(part, tension_noise_n=noise)


def _window(recording: Recording) -> tuple[float, float]:
    stretches = [one for one in recording.bundles[-1].segments if one.fundamental_hz is not None]
    if not stretches:
        raise DataError(
            "the run has no steady motion of two periods or more",
            where=str(recording.run.folder),
            remedy="record a slow sine, such as 2 Hz for 10 s",
        )
    return min(one.start_s for one in stretches), max(one.end_s for one in stretches)


def harmonic_basis(t_s: Array, hertz: float, count: int) -> Array:
    """One, and cosine and sine of each harmonic, shape (n, 1 + 2 count)."""
    angle = 2.0 * np.pi * hertz * t_s[:, None] * np.arange(1, count + 1)
    pairs = np.stack([np.cos(angle), np.sin(angle)], axis=2).reshape(len(t_s), 2 * count)
    return np.hstack([np.ones((len(t_s), 1)), pairs])


def noise_level(t_s: Array, residual: Array, hertz: float) -> float:
    """Variance of a sample that white noise as strong as this about a frequency would have.

    Parameters
    ----------
    t_s, residual
        What a fit leaves, shape (n,); however it is correlated, its lines beside the frequency
        are as strong as those that stood under it.
    hertz
        The frequency.
    """
    spacing = 1.0 / (t_s[-1] - t_s[0])
    lines = [hertz + sign * place * spacing for place in NEIGHBOURS for sign in (-1.0, 1.0)]
    near = np.array([one for one in lines if one > 0.5 * spacing])
    turns = np.exp(-2j * np.pi * near[:, None] * t_s)
    return float(np.mean(np.abs(turns @ residual) ** 2) / len(t_s))


def lengths(pose: Array, base: Array, anchor: Array) -> Array:
    """Length of one cable over poses, Eqs. 1 and 9, shape (n,), m."""
    turn = rotation(trigonometry((pose[:, 3], pose[:, 4], pose[:, 5])))
    return np.asarray(np.linalg.norm(base - pose[:, :3] - arms(turn, anchor), axis=1))


def arms(turn: Matrix, anchor: Array) -> Array:
    """One anchor in O-XYZ over rotations, shape (n, 3), m."""
    return np.stack([sum(turn[r][c] * anchor[c] for c in range(3)) for r in range(3)], axis=1)


def length_gradient(machine: Machine, pose: Array) -> Array:
    """What each length changes by with the pose, shape (8, 6), 1 and m/rad."""
    step = 1e-6
    around = pose + step * np.vstack([np.eye(6), -np.eye(6)])
    sides = np.array(
        [lengths(around, machine.base[i], machine.anchor[i]) for i in range(machine.cables)]
    )
    return np.asarray((sides[:, :6] - sides[:, 6:]) / (2.0 * step))
