"""The points the integrator steps on: the output grid, divided or joined, and the breaks."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model.method import Method
from model.motion import Motion

Array = NDArray[np.float64]

MOST_STEPS = 3_000_000
"""The drive's table of a run this long takes 2.3 GB with the 16 stages of dop853."""

SAME_POINT_S = 1e-9
"""A break this close to a point of the grid is that point."""


@dataclass(frozen=True)
class Steps:
    """A division of the run into steps.

    Parameters
    ----------
    point_s
        Ends of the steps, shape (n + 1,), s.
    output_s
        Times of the outputs, shape (rows,), s.
    first_row
        Rows ``first_row[p]`` to ``first_row[p + 1]`` lie in the step that starts at point p, shape
        (n + 2,); the last point has the last row.
    share
        How far into its step each row lies, 0 to 1, shape (rows,); exactly 0 at a point.
    jump_point
        The point at which the state jumps: where the motion does as it starts, else where the
        initial disturbances act.
    """

    point_s: Array
    output_s: Array
    first_row: NDArray[np.int64]
    share: Array
    jump_point: int

    @property
    def step_s(self) -> Array:
        """Lengths of the steps, shape (n,), s."""
        return np.diff(self.point_s)

    @property
    def middle_s(self) -> Array:
        """A time inside each step, shape (n, 1), s: says which side of a break it lies on."""
        return (0.5 * (self.point_s[:-1] + self.point_s[1:]))[:, None]

    def rows_kept(self, points: int, culprit: int) -> int:
        """How many outputs are sound: after a blow-up at a point, those up to the point before."""
        if culprit < 0:
            return self.output_s.size
        last_s = self.point_s[points - 1] if points else -np.inf
        return int(np.searchsorted(self.output_s, last_s + SAME_POINT_S))

    def evaluations(self, method: Method, steps: int) -> int:
        """How often the right-hand side is evaluated in the first steps, however many."""
        needed = method.step_weights.size * steps
        inside = np.add.reduceat(np.append(self.share > 0.0, False), self.first_row[:steps])
        inside[np.diff(self.first_row[: steps + 1]) == 0] = 0
        extra = method.nodes.size - method.step_weights.size
        return needed + extra * int(np.count_nonzero(inside))


@lru_cache(maxsize=64)
def jumps_at_s(motion: Motion) -> float:
    """When the state jumps: X_p0 and X_w0 act with the jump of a motion that starts at once."""
    start_s = np.array(motion.start_s)
    before = motion.at(start_s, start_s - SAME_POINT_S)
    after = motion.at(start_s, start_s + SAME_POINT_S)
    at_once = any(np.any(one != other) for one, other in zip(before[:2], after[:2], strict=True))
    return motion.start_s if at_once else motion.disturbed_s


def steps_a_row(output_rate_hz: float, longest_step_s: float, *, join: bool) -> tuple[int, int]:
    """Steps between two outputs, and outputs passed in a step; one of them is 1."""
    outputs_a_step = output_rate_hz * longest_step_s
    divisions = max(1, int(np.ceil(1.0 / outputs_a_step - SAME_POINT_S)))
    joined = max(1, int(np.floor(outputs_a_step + SAME_POINT_S))) if join else 1
    return divisions, joined


def divide(
    motion: Motion, output_rate_hz: float, longest_step_s: float, *, join: bool = False
) -> Steps:
    """Divide a motion into steps no longer than asked, that meet every break of it.

    Parameters
    ----------
    motion
        Gives duration, start and breaks.
    output_rate_hz
        Outputs a second; the first is at 0.
    longest_step_s
        Upper bound of a step, s.
    join
        Whether a step may pass over outputs; else the steps meet each of them.

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
    divisions, joined = steps_a_row(output_rate_hz, longest_step_s, join=join)
    if outputs * divisions > MOST_STEPS:
        raise UsageError(
            f"a run of {motion.duration_s:g} s would take {outputs * divisions} steps",
            allowed=f"{MOST_STEPS} steps",
            remedy="take a longer step, a lower output rate, or a shorter motion",
        )
    output_s = np.arange(outputs + 1) / output_rate_hz
    point_s = np.arange(outputs * divisions + 1) / (output_rate_hz * divisions)
    if joined > 1:
        point_s = np.append(point_s[:-1:joined], point_s[-1])
    for moment_s in motion.breaks_s:
        at = int(np.searchsorted(point_s, moment_s))
        around = point_s[max(0, at - 1) : at + 1]
        if 0 < at < point_s.size and np.abs(around - moment_s).min() > SAME_POINT_S:
            point_s = np.insert(point_s, at, moment_s)
    first_row = np.searchsorted(output_s, point_s - SAME_POINT_S)
    step_of_row = np.searchsorted(point_s, output_s + SAME_POINT_S, side="right") - 1
    start_s = point_s[step_of_row]
    length_s = np.append(np.diff(point_s), 1.0)[step_of_row]
    share = np.where(output_s - start_s > SAME_POINT_S, (output_s - start_s) / length_s, 0.0)
    return Steps(
        point_s=point_s,
        output_s=output_s,
        first_row=np.append(first_row, output_s.size).astype(np.int64),
        share=share,
        jump_point=int(np.abs(point_s - jumps_at_s(motion)).argmin()),
    )
