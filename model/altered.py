"""Motions as an imperfect drive makes them of the commanded one."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from model.compiled import compiled
from model.motion import Command, Motion, RampedSine

Array = NDArray[np.float64]

GRID_HZ = 4000.0
"""Play depends on what went before: it is followed on this grid, and interpolated."""


@dataclass(frozen=True)
class _Imperfect:
    """A motion made of a commanded one; its times are as commanded where nothing else is said.

    Parameters
    ----------
    motion
        As commanded.
    """

    motion: Motion

    @property
    def start_s(self) -> float:
        """When it starts."""
        return self.motion.start_s

    @property
    def disturbed_s(self) -> float:
        """When X_p0 and X_w0 act."""
        return self.motion.disturbed_s

    @property
    def duration_s(self) -> float:
        """How long the whole lasts."""
        return self.motion.duration_s

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """Where it is not smooth."""
        return self.motion.breaks_s

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """Where amplitudes are taken."""
        return self.motion.steady_window_s


@dataclass(frozen=True)
class Altered(_Imperfect):
    """A motion made larger, faster or later.

    Parameters
    ----------
    motion
        As commanded.
    factor
        On the whole of it.
    pace
        How much faster it runs from its start on.
    late_s
        How much later it starts.
    disturbed_late_share
        1: X_p0 and X_w0 act as it starts; 0: as it was to start.
    """

    factor: float = 1.0
    pace: float = 1.0
    late_s: float = 0.0
    disturbed_late_share: float = 1.0

    @property
    def start_s(self) -> float:
        """When it starts."""
        return self.motion.start_s + self.late_s

    @property
    def disturbed_s(self) -> float:
        """When X_p0 and X_w0 act."""
        return self.motion.disturbed_s + self.disturbed_late_share * self.late_s

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """Where it is not smooth, or disturbed."""
        breaks = tuple(self._when(time_s) for time_s in self.motion.breaks_s)
        return breaks if self.disturbed_s in breaks else (*breaks, self.disturbed_s)

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*''; see `Motion.at`."""
        within = None if within_s is None else self._inner(np.asarray(within_s))
        pose, rate, acceleration = self.motion.at(self._inner(np.asarray(time_s)), within)
        first, second = self.factor * self.pace, self.factor * self.pace**2
        return self.factor * pose, first * rate, second * acceleration

    def _inner(self, time_s: Array) -> Array:
        start_s = self.motion.start_s
        inner: Array = start_s + self.pace * (time_s - self.start_s)
        return inner

    def _when(self, inner_s: float) -> float:
        return self.start_s + (inner_s - self.motion.start_s) / self.pace


def retuned(motion: Motion, factor: float) -> Motion:
    """A motion whose sine has another frequency, while its ramps keep their times.

    Parameters
    ----------
    motion
        As commanded; one that is no sine runs faster as a whole.
    factor
        On the frequency.
    """
    return _innermost(
        motion,
        lambda one: (
            replace(one, frequency_hz=factor * one.frequency_hz)
            if isinstance(one, RampedSine)
            else Altered(one, pace=factor)
        ),
    )


def turned(motion: Motion, back_rad: float) -> Motion:
    """A motion whose sine is turned back, while its ramps keep their times.

    Parameters
    ----------
    motion
        As commanded; one that is no sine stays as it is.
    back_rad
        By which angle.
    """
    return _innermost(
        motion,
        lambda one: (
            replace(one, phase_rad=one.phase_rad - back_rad) if isinstance(one, RampedSine) else one
        ),
    )


def _innermost(motion: Motion, alter: Callable[[Motion], Motion]) -> Motion:
    """A motion, what was commanded altered, and made of that as before."""
    if isinstance(motion, Altered | Distorted | Loose):
        return replace(motion, motion=_innermost(motion.motion, alter))
    return alter(motion)


@dataclass(frozen=True)
class Distorted(_Imperfect):
    """A sine with one harmonic.

    Parameters
    ----------
    motion
        As commanded; one that is no sine stays as it is.
    share, order, phase_rad
        Amplitude over that of the sine, order and phase of the harmonic.
    """

    share: float
    order: int
    phase_rad: float

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*''; see `Motion.at`."""
        total = self.motion.at(time_s, within_s)
        for sine in _sines(self.motion):
            harmonic = replace(
                sine,
                amplitude_rad=self.share * sine.amplitude_rad,
                frequency_hz=self.order * sine.frequency_hz,
                phase_rad=self.phase_rad,
            )
            added = harmonic.at(time_s, within_s)
            total = (total[0] + added[0], total[1] + added[1], total[2] + added[2])
        return total


def _sines(motion: Motion) -> tuple[RampedSine, ...]:
    """The sine a motion is made of, as an imperfect drive has altered it so far."""
    if isinstance(motion, RampedSine):
        return (motion,)
    if isinstance(motion, Altered):
        return tuple(
            replace(
                sine,
                amplitude_rad=motion.factor * sine.amplitude_rad,
                frequency_hz=motion.pace * sine.frequency_hz,
                start_s=sine.start_s + motion.late_s,
            )
            for sine in _sines(motion.motion)
        )
    if isinstance(motion, Loose):
        return _sines(motion.motion)
    return ()


@dataclass(frozen=True)
class Loose(_Imperfect):
    """A motion that plays by d to either side, on its angles.

    Parameters
    ----------
    motion
        As commanded.
    play_rad
        Half the play, d.
    servo_s
        Standard deviation of the Gaussian by which a servo smooths what play takes away.
    servo_late_s
        By how much it does so later.
    """

    play_rad: float
    servo_s: float
    servo_late_s: float = 0.0

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*''; see `Motion.at`."""
        told = tuple(values.copy() for values in self.motion.at(time_s, within_s))
        if self.play_rad == 0.0:
            return told[0], told[1], told[2]
        grid_s, lags = _followed(replace(self, servo_late_s=0.0))
        for values, lag in zip(told, lags, strict=True):
            for axis in range(3):
                values[..., 3 + axis] -= np.interp(time_s - self.servo_late_s, grid_s, lag[:, axis])
        return told[0], told[1], told[2]


@lru_cache(maxsize=4)
def _followed(loose: Loose) -> tuple[Array, tuple[Array, Array, Array]]:
    """A grid of times, and on it the lag of each angle, its rate and its acceleration."""
    from scipy.ndimage import gaussian_filter1d

    grid_s = np.arange(int(loose.duration_s * GRID_HZ) + 2) / GRID_HZ
    angles = loose.motion.at(grid_s)[0][:, 3:]
    lag = np.stack([_play(angles[:, axis], loose.play_rad) for axis in range(3)], axis=1)
    sigma = loose.servo_s * GRID_HZ
    value, rate, acceleration = (
        gaussian_filter1d(lag, sigma, axis=0, order=order, mode="nearest") * GRID_HZ**order
        for order in range(3)
    )
    return grid_s, (value, rate, acceleration)


def _play(values: Array, play: float) -> Array:
    """What values with play to either side lag by: they stand until the other stop is reached."""
    lag = np.zeros_like(values)
    if np.any(values):
        compiled("follow_play")(np.diff(values), play, lag)
    return lag
