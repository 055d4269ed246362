"""The commanded motion X*(t) with its two derivatives (Eq. 20 and design, section 4)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile.excitation import Ending, Excitation, Ramp

Array = NDArray[np.float64]
Command = tuple[Array, Array, Array]

AXES = ("roll", "pitch", "yaw")


class Motion(Protocol):
    """Any motion the platform can be commanded to follow, told from others by its numbers."""

    def __hash__(self) -> int:
        """Equal where motions are."""
        ...

    @property
    def start_s(self) -> float:
        """When the motion starts."""
        ...

    @property
    def disturbed_s(self) -> float:
        """When X_p0 and X_w0 act: as it starts, unless a drive is late."""
        ...

    @property
    def duration_s(self) -> float:
        """How long the whole lasts, rest included."""
        ...

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """Times where X* or a derivative is not smooth: the integrator steps on them."""
        ...

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """Where amplitudes are taken."""
        ...

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*'' at given times.

        Parameters
        ----------
        time_s
            Any shape, s.
        within_s
            Times that say which side of a break is meant, broadcast against `time_s`; default:
            `time_s` itself, and at a break the side that follows it.

        Returns
        -------
        pose, rate, acceleration
            X, Y, Z in m and roll, pitch, yaw in rad on a last axis of 6; their derivatives.
        """
        ...


@dataclass(frozen=True)
class RampedSine:
    """A w(tau) sin(2 pi f tau) about one axis, tau counted from the start; rest before and after.

    Parameters
    ----------
    axis
        0 roll, 1 pitch, 2 yaw.
    amplitude_rad, frequency_hz
        A and f.
    start_s, motion_s
        Start and length of the motion.
    ramp_s
        Over this time w rises from 0 to 1; 0 for w = 1 throughout.
    duration_s
        With the rest before and after.
    phase_rad
        Added to 2 pi f tau.
    ramp
        The law by which w rises and, mirrored, falls.
    ending
        Whether it falls over the last `ramp_s` of the motion, over as long after it, or at once.
    """

    axis: int
    amplitude_rad: float
    frequency_hz: float
    start_s: float
    motion_s: float
    ramp_s: float
    duration_s: float
    phase_rad: float = 0.0
    ramp: Ramp = "quintic"
    ending: Ending = "ramp_within"

    @classmethod
    def from_excitation(cls, excitation: Excitation) -> Self:
        """The motion of a rig file's [excitation]."""
        return cls(
            axis=AXES.index(excitation.axis),
            amplitude_rad=float(np.deg2rad(excitation.amplitude_deg)),
            frequency_hz=excitation.frequency_hz,
            start_s=excitation.start_s,
            motion_s=excitation.motion_s,
            ramp_s=excitation.ramp_s,
            duration_s=excitation.duration_s,
            ramp=excitation.ramp,
            ending=excitation.ending,
        )

    @property
    def disturbed_s(self) -> float:
        """See `Motion`."""
        return self.start_s

    @property
    def end_s(self) -> float:
        """When the motion ends, with its last ramp."""
        return self.start_s + self.motion_s + self.ramp_s * (self.ending == "ramp_beyond")

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """Start and end of the motion and of its ramps."""
        return (self.start_s, *self.steady_window_s, self.end_s)

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """From the end of the first ramp to the start of the last, if there is one."""
        return self.start_s + self.ramp_s, self.end_s - self.ramp_s * (self.ending != "at_once")

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*''; see `Motion.at`."""
        time_s = np.asarray(time_s, dtype=float)
        within = time_s if within_s is None else within_s
        moving = np.broadcast_to((within >= self.start_s) & (within <= self.end_s), time_s.shape)
        tau = time_s - self.start_s
        window, window_1, window_2 = self._window(tau, within - self.start_s)
        circular = 2.0 * np.pi * self.frequency_hz
        angle_rad = circular * tau + self.phase_rad
        sine, cosine = np.sin(angle_rad), np.cos(angle_rad)
        angle = window * sine
        rate = window_1 * sine + circular * window * cosine
        acceleration = window_2 * sine + 2.0 * circular * window_1 * cosine
        acceleration -= circular**2 * window * sine
        return (
            self._about_axis(moving * angle),
            self._about_axis(moving * rate),
            self._about_axis(moving * acceleration),
        )

    def _about_axis(self, values: Array) -> Array:
        pose = np.zeros((*values.shape, 6))
        pose[..., 3 + self.axis] = self.amplitude_rad * values
        return pose

    def _window(self, tau: Array, within: Array) -> Command:
        """w, w' and w'': up over the first ramp, down over the last."""
        if self.ramp_s == 0.0:
            return np.ones_like(tau), np.zeros_like(tau), np.zeros_like(tau)
        up, up_1, up_2 = self._rise(tau, within)
        if self.ending == "at_once":
            return up, up_1, up_2
        length_s = self.end_s - self.start_s
        down, down_1, down_2 = self._rise(length_s - tau, length_s - within)
        return up * down, up_1 * down - up * down_1, up_2 * down - 2.0 * up_1 * down_1 + up * down_2

    def _rise(self, tau: Array, within: Array) -> Command:
        """One ramp and its derivatives in time; beyond it, it does not bend."""
        rise, rise_1, rise_2 = RAMPS[self.ramp](np.clip(tau / self.ramp_s, 0.0, 1.0))
        bends = (within >= 0.0) & (within <= self.ramp_s)
        return rise, rise_1 / self.ramp_s, bends * rise_2 / self.ramp_s**2


def smooth_step(x: Array) -> Command:
    """10 x^3 - 15 x^4 + 6 x^5 on [0, 1] and its derivatives: two of them vanish at both ends."""
    x = np.clip(x, 0.0, 1.0)
    return (
        x**3 * (10.0 - 15.0 * x + 6.0 * x**2),
        30.0 * x**2 * (1.0 - x) ** 2,
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )


def raised_cosine_step(x: Array) -> Command:
    """(1 - cos pi x)/2 on [0, 1] and its derivatives: the second is not zero at the ends."""
    angle = np.pi * x
    return 0.5 - 0.5 * np.cos(angle), 0.5 * np.pi * np.sin(angle), 0.5 * np.pi**2 * np.cos(angle)


def cubic_step(x: Array) -> Command:
    """3 x^2 - 2 x^3 on [0, 1] and its derivatives: the second is not zero at the ends."""
    return x**2 * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x), 6.0 - 12.0 * x


def septic_step(x: Array) -> Command:
    """35 x^4 - 84 x^5 + 70 x^6 - 20 x^7 on [0, 1]: three derivatives vanish at both ends."""
    return (
        x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3),
        140.0 * x**3 * (1.0 - x) ** 3,
        420.0 * x**2 * (1.0 - x) ** 2 * (1.0 - 2.0 * x),
    )


RAMPS: dict[Ramp, Callable[[Array], Command]] = {
    "quintic": smooth_step,
    "raised_cosine": raised_cosine_step,
    "cubic": cubic_step,
    "septic": septic_step,
}
"""How w rises from 0 to 1, with its first and second derivative."""
