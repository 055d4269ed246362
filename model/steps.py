"""The points the integrator steps on: the output grid, divided, and the breaks of the motion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model.motion import Motion

Array = NDArray[np.float64]

MOST_STEPS = 3_000_000
"""The drive's table of a run this long takes 1.7 GB with the 12 stages of dop853."""

SAME_POINT_S = 1e-9
"""A break this close to a point of the grid is that point."""


@dataclass(frozen=True)
class Steps:
    """A division of the run into steps.

    Parameters
    ----------
    point_s
        Ends of the steps, shape (n + 1,), s.
    row_of_point
        Output row of each point, -1 where it is not an output, shape (n + 1,).
    jump_point
        The point at which the motion starts and the initial disturbances act.
    """

    point_s: Array
    row_of_point: NDArray[np.int64]
    jump_point: int

    @property
    def step_s(self) -> Array:
        """Lengths of the steps, shape (n,), s."""
        return np.diff(self.point_s)

    @property
    def middle_s(self) -> Array:
        """A time inside each step, shape (n, 1), s: says which side of a break it lies on."""
        return (0.5 * (self.point_s[:-1] + self.point_s[1:]))[:, None]

    @property
    def output_s(self) -> Array:
        """Times of the outputs, s."""
        return self.point_s[self.row_of_point >= 0]

    def stage_s(self, nodes: Array) -> Array:
        """Times of a method's stages, shape (n, stages), s."""
        return self.point_s[:-1, None] + nodes * self.step_s[:, None]


def divide(motion: Motion, output_rate_hz: float, longest_step_s: float) -> Steps:
    """Divide a motion into steps no longer than asked, that meet every output and every break.

    Parameters
    ----------
    motion
        Gives duration, start and breaks.
    output_rate_hz
        Outputs a second; the first is at 0.
    longest_step_s
        Upper bound of a step, s.

    Raises
    ------
    UsageError
        Rate or step is not positive, the run has no second output, or too many steps.
    """
    if not (output_rate_hz > 0 and longest_step_s > 0):
        raise UsageError(
            f"output rate {output_rate_hz} Hz, step {longest_step_s} s", allowed="both above 0"
        )
    outputs = int(np.floor(motion.duration_s * output_rate_hz + SAME_POINT_S))
    if outputs < 1:
        raise UsageError(
            f"a run of {motion.duration_s} s has no second output at {output_rate_hz} Hz",
            allowed="an output rate of at least one over the duration",
        )
    divisions = max(1, int(np.ceil(1.0 / (output_rate_hz * longest_step_s) - SAME_POINT_S)))
    if outputs * divisions > MOST_STEPS:
        raise UsageError(
            f"a run of {motion.duration_s:g} s would take {outputs * divisions} steps",
            allowed=f"{MOST_STEPS} steps",
            remedy="take a longer step, a lower output rate, or a shorter motion",
        )
    point_s = np.arange(outputs * divisions + 1) / (output_rate_hz * divisions)
    row_of_point = np.full(point_s.size, -1, dtype=np.int64)
    row_of_point[::divisions] = np.arange(outputs + 1)
    for moment_s in motion.breaks_s:
        at = int(np.searchsorted(point_s, moment_s))
        around = point_s[max(0, at - 1) : at + 1]
        if 0 < at < point_s.size and np.abs(around - moment_s).min() > SAME_POINT_S:
            point_s = np.insert(point_s, at, moment_s)
            row_of_point = np.insert(row_of_point, at, -1)
    jump_point = int(np.abs(point_s - motion.start_s).argmin())
    return Steps(point_s, row_of_point, jump_point)
