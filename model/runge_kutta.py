"""The fixed-step integrator of Eq. 18, of any explicit Runge-Kutta method.

Plain Python like `model.kernel`, and compiled like it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.kernel import derivative

Array = NDArray[np.float64]


def advance(
    start: Array, step_s: float, weights: Array, rates: Array, count: int, result: Array
) -> None:
    """Fill `result` with start + step_s * (weights . rates), over the first `count` stages."""
    for k in range(start.size):
        result[k] = start[k]
    for stage in range(count):
        factor = step_s * weights[stage]
        if factor != 0.0:
            for k in range(start.size):
                result[k] += factor * rates[stage, k]


def evaluate(
    state: Array,
    step_s: float,
    drive: Array,
    stage_weights: Array,
    first: int,
    last: int,
    plant: Any,
    extras: Any,
    rates: Array,
    trial: Array,
) -> None:
    """Stages `first` to `last` of one step of an explicit Runge-Kutta method.

    Parameters
    ----------
    state
        At the start of the step, shape (s,).
    step_s
        Length of the step, s.
    drive
        The drive at each stage, shape (stages, 6 or 22).
    stage_weights
        a_ij, shape (stages, stages).
    first, last
        Stages from `first` up to, not including, `last`.
    plant, extras
        A `Plant` and an `Extras`.
    rates
        Filled, shape (stages, s).
    trial
        Room to work in, shape (s,).
    """
    for stage in range(first, last):
        advance(state, step_s, stage_weights[stage], rates, stage, trial)
        derivative(trial, drive[stage], plant, extras, rates[stage])


def first_beyond(state: Array, limit: Array) -> int:
    """Index of the first state beyond its limit, -1 for none; a NaN is beyond every limit."""
    for k in range(state.size):
        if not abs(state[k]) <= limit[k]:
            return k
    return -1


def integrate(
    state: Array,
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
    plant: Any,
    extras: Any,
    rates: Array,
    trial: Array,
    trajectory: Array,
) -> tuple[int, int]:
    """Integrate Eq. 18 by an explicit Runge-Kutta method over given steps.

    Points are the ends of the steps: point n is the start of step n.

    Parameters
    ----------
    state
        The state before point 0, shape (s,); left at the last state reached.
    step_s
        Length of each step, shape (n,), in s.
    drive
        The drive at every stage of every step, shape (n, stages, 6 or 22).
    jump_point, jump
        At this point `jump`, shape (s,), is added to the state.
    first_row
        Rows of `trajectory` from ``first_row[p]`` to ``first_row[p + 1]`` lie in the step from
        point p, shape (n + 2,).
    inside
        Which row of `inside_weights` gives a row of the trajectory, -1 where it is the state at
        the point itself, shape (rows,).
    inside_weights
        Weights of the stages for values inside a step, shape (any, stages).
    limit
        Magnitude beyond which a state is a blow-up, shape (s,).
    stage_weights, step_weights
        The method: a_ij, shape (stages, stages), and b_i, shape (m,), m <= stages.
    plant, extras
        A `Plant` and an `Extras`.
    rates, trial
        Room to work in, shapes (stages, s) and (s,).
    trajectory
        Filled with states, shape (rows, s).

    Returns
    -------
    points, culprit
        Points reached, and the index of the state that blew up, or -1.
    """
    stages, needed = step_weights.size, stage_weights.shape[0]
    steps = step_s.size
    for point in range(steps + 1):
        if point == jump_point:
            for k in range(state.size):
                state[k] += jump[k]
        culprit = first_beyond(state, limit)
        if culprit >= 0:
            return point, culprit
        first, last = first_row[point], first_row[point + 1]
        if first < last and inside[first] < 0:
            for k in range(state.size):
                trajectory[first, k] = state[k]
            first += 1
        if point == steps:
            break
        now = drive[point]
        evaluate(state, step_s[point], now, stage_weights, 0, stages, plant, extras, rates, trial)
        if first < last:
            evaluate(
                state,
                step_s[point],
                now,
                stage_weights,
                stages,
                needed,
                plant,
                extras,
                rates,
                trial,
            )
            for row in range(first, last):
                weights = inside_weights[inside[row]]
                advance(state, step_s[point], weights, rates, needed, trajectory[row])
        advance(state, step_s[point], step_weights, rates, stages, state)
    return steps + 1, -1
