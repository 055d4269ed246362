"""What motions with a start, an end and ramps have in common."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model.motion import Command, smooth_step

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Times:
    """When a motion is: rest, motion, rest.

    Parameters
    ----------
    start_s, motion_s
        Start and length of the motion.
    ramp_s
        Over this time it is faded in and, before its end, out; 0 for not at all.
    rest_s
        After the motion.
    """

    start_s: float = 1.0
    motion_s: float = 10.0
    ramp_s: float = 0.5
    rest_s: float = 1.0

    def __post_init__(self) -> None:
        sound = min(self.start_s, self.ramp_s, self.rest_s) >= 0 and self.motion_s > 0
        if not (sound and 2.0 * self.ramp_s <= self.motion_s):
            raise UsageError(
                f"start {self.start_s:g} s, motion {self.motion_s:g} s, ramp {self.ramp_s:g} s, "
                f"rest {self.rest_s:g} s",
                allowed="none negative, and a motion above 0 s that two ramps fit into",
            )


@dataclass(frozen=True, kw_only=True)
class Windowed(ABC):
    """A shape s(tau), tau counted from the start, times a window w(tau); rest before and after.

    Parameters
    ----------
    times
        When.
    """

    times: Times = Times()

    @abstractmethod
    def shape(self, tau: Array) -> Command:
        """The shape s and its two derivatives, with the coordinates on a last axis."""

    @property
    def disturbed_s(self) -> float:
        """See `Motion`."""
        return self.start_s

    @property
    def start_s(self) -> float:
        """When the motion starts."""
        return self.times.start_s

    @property
    def end_s(self) -> float:
        """When the motion ends."""
        return self.times.start_s + self.times.motion_s

    @property
    def duration_s(self) -> float:
        """Rest, motion and rest."""
        return self.end_s + self.times.rest_s

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """From the end of the first ramp to the start of the last."""
        return self.start_s + self.times.ramp_s, self.end_s - self.times.ramp_s

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """Start and end of the motion and of its ramps."""
        return (self.start_s, *self.steady_window_s, self.end_s)

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*''; see `model.motion.Motion.at`."""
        time_s = np.asarray(time_s, dtype=float)
        within = time_s if within_s is None else within_s
        moving = np.broadcast_to((within >= self.start_s) & (within <= self.end_s), time_s.shape)
        tau = time_s - self.start_s
        value, rate, acceleration = self.shape(tau)
        w, w_1, w_2 = (values[..., None] for values in self._window(tau))
        on = moving[..., None]
        return (
            np.where(on, w * value, 0.0),
            np.where(on, w_1 * value + w * rate, 0.0),
            np.where(on, w_2 * value + 2.0 * w_1 * rate + w * acceleration, 0.0),
        )

    def _window(self, tau: Array) -> Command:
        ramp = self.times.ramp_s
        if ramp == 0.0:
            return np.ones_like(tau), np.zeros_like(tau), np.zeros_like(tau)
        up, up_1, up_2 = smooth_step(tau / ramp)
        down, down_1, down_2 = smooth_step((self.times.motion_s - tau) / ramp)
        return (
            up * down,
            (up_1 * down - up * down_1) / ramp,
            (up_2 * down - 2.0 * up_1 * down_1 + up * down_2) / ramp**2,
        )
