"""Smooth steps from pose to pose."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model.motion import Command, smooth_step
from model.motions.pose import Pose

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Staircase:
    """From pose to pose and back to rest, by smooth steps with a stay after each.

    Parameters
    ----------
    poses
        Where to go, in turn; m and rad. The last step leads back to rest.
    rise_s, stay_s
        Length of a step, and of the stay after it.
    start_s, rest_s
        Before and after.
    """

    poses: tuple[Pose, ...]
    rise_s: float = 0.5
    stay_s: float = 1.0
    start_s: float = 1.0
    rest_s: float = 1.0

    def __post_init__(self) -> None:
        if not self.poses or self.rise_s <= 0 or min(self.stay_s, self.start_s, self.rest_s) < 0:
            raise UsageError(
                f"{len(self.poses)} poses, rise {self.rise_s:g} s, stay {self.stay_s:g} s",
                allowed="at least one pose, a rise above 0 s, no negative time",
            )

    @property
    def disturbed_s(self) -> float:
        """See `Motion`."""
        return self.start_s

    @property
    def moments_s(self) -> Array:
        """When each step starts, shape (poses + 1,), s."""
        steps = np.arange(len(self.poses) + 1)
        return np.asarray(self.start_s + steps * (self.rise_s + self.stay_s))

    @property
    def end_s(self) -> float:
        """When the platform is back at rest."""
        return float(self.moments_s[-1]) + self.rise_s

    @property
    def duration_s(self) -> float:
        """Rest, motion and rest."""
        return self.end_s + self.rest_s

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """The whole motion: every step counts."""
        return self.start_s, self.end_s

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """Start and end of every step."""
        return tuple(float(at) for start in self.moments_s for at in (start, start + self.rise_s))

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:  # noqa: ARG002  # as `Motion.at` is called
        """X*, X*' and X*''; see `model.motion.Motion.at`. All three are continuous."""
        time_s = np.asarray(time_s, dtype=float)
        levels = np.vstack([np.zeros(6), np.array(self.poses), np.zeros(6)])
        command = np.zeros((3, *time_s.shape, 6))
        for moment, leap in zip(self.moments_s, np.diff(levels, axis=0), strict=True):
            parts = smooth_step((time_s - moment) / self.rise_s)
            for order, part in enumerate(parts):
                command[order] += part[..., None] * leap / self.rise_s**order
        return command[0], command[1], command[2]
