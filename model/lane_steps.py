"""The integrator of `model.runge_kutta` for sixteen simulations side by side on the same steps."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.lanes import LANES, lane_derivative

Array = NDArray[np.float64]


def lane_advance(
    start: Array, step_s: float, weights: Array, rates: Array, count: int, result: Array
) -> None:
    """Fill `result` with start + step_s * (weights . rates), over the first `count` stages."""
    for k in range(start.size):
        result[k] = start[k]
    for stage in range(count):
        factor = step_s * weights[stage]
        if factor != 0.0:
            rate = rates[stage]
            for k in range(start.size):
                result[k] += factor * rate[k]


def keep(y: Array, trajectory: Array, row: int) -> None:
    """Store the states of all lanes, each lane's together."""
    for w in range(LANES):
        for k in range(trajectory.shape[2]):
            trajectory[w, row, k] = y[k * LANES + w]


def lay_down(
    y: Array,
    limit: Array,
    point: int,
    blown_point: NDArray[np.int64],
    culprit: NDArray[np.int64],
) -> None:
    """Note which lanes blew up, and let them lie still: nothing more is asked of them."""
    beyond = 0
    for k in range(y.size):
        beyond += 0 if abs(y[k]) <= limit[k] else 1
    if beyond == 0:
        return
    for w in range(LANES):
        for k in range(y.size // LANES):
            at = k * LANES + w
            if culprit[w] < 0 and not abs(y[at]) <= limit[at]:
                culprit[w], blown_point[w] = k, point
        if culprit[w] >= 0:
            for k in range(y.size // LANES):
                y[k * LANES + w] = 0.0


def integrate_lanes(
    y: Array,
    step_s: Array,
    drive: Array,
    jump_point: int,
    jump: Array,
    first_row: NDArray[np.int64],
    inside: NDArray[np.int64],
    inside_weights: Array,
    limit: Array,
    stage_weights: Array,
    step_weights: Array,
    q: Array,
    extras: Any,
    rates: Array,
    trial: Array,
    work: Array,
    trajectory: Array,
    blown_point: NDArray[np.int64],
    culprit: NDArray[np.int64],
    before: int,
    to_end: bool,
) -> None:
    """As `model.runge_kutta.integrate`, for `LANES` simulations on the same steps.

    Parameters
    ----------
    y, jump, limit
        As there, for each lane, shape (s * LANES,).
    step_s, jump_point, first_row, inside, inside_weights, stage_weights, step_weights
        As there.
    drive
        Shape (n, stages, 6 or 22, 1 or LANES): one for all, or each its own.
    q, extras
        The machines and the effects that are on in any of them.
    rates, trial, work
        Room to work in, shapes (stages, s * LANES), (s * LANES,) and (WORK,).
    trajectory
        Filled, shape (LANES, rows, s).
    blown_point, culprit
        Filled with where each lane blew up, and by which state; -1 for none; shape (LANES,).
    before
        Steps taken by earlier calls: a run may come in parts.
    to_end
        Whether the last point is the end of the run: else the next call treats it.
    """
    stages, needed = step_weights.size, stage_weights.shape[0]
    steps = step_s.size
    for point in range(steps + 1 if to_end else steps):
        if point == jump_point:
            for k in range(y.size):
                y[k] += jump[k]
        lay_down(y, limit, before + point, blown_point, culprit)
        first, last = first_row[point], first_row[point + 1]
        if first < last and inside[first] < 0:
            keep(y, trajectory, first)
            first += 1
        if point == steps:
            break
        h = step_s[point]
        for stage in range(stages):
            lane_advance(y, h, stage_weights[stage], rates, stage, trial)
            lane_derivative(trial, drive[point, stage], q, extras, work, rates[stage])
        if first < last:
            for stage in range(stages, needed):
                lane_advance(y, h, stage_weights[stage], rates, stage, trial)
                lane_derivative(trial, drive[point, stage], q, extras, work, rates[stage])
            for row in range(first, last):
                weights = inside_weights[inside[row]]
                lane_advance(y, h, weights, rates, needed, trial)
                keep(trial, trajectory, row)
        lane_advance(y, h, step_weights, rates, stages, y)
