"""Normal equations: their root, and their solution within bounds."""

import numpy as np
from scipy.linalg import cholesky

from analysis.engine.array import Array


def root_beside_one(columns: Array) -> Array:
    """The lower triangular root of 1 + J^T J, shape (p, p), for J of shape (f, p)."""
    one = np.eye(columns.shape[1])
    try:
        found: Array = cholesky(one + columns.T @ columns, lower=True, check_finite=False)
    except np.linalg.LinAlgError:
        # Where columns are so large that their squares lose the one, theirs do not.
        upper = np.asarray(np.linalg.qr(np.vstack([columns, one]), mode="r"))
        found = (upper * np.where(np.diag(upper) < 0.0, -1.0, 1.0)[:, None]).T
    return found


def bounded(matrix: Array, right: Array, lows: Array | None, highs: Array | None) -> Array:
    """The minimum of the quadratic form within bounds: those that leave them are held there."""
    count = len(right)
    estimate = np.zeros(count)
    if not count:
        return estimate
    low = np.full(count, -np.inf) if lows is None else lows
    high = np.full(count, np.inf) if highs is None else highs
    free = np.ones(count, dtype=bool)
    for _ in range(count + 1):
        if not free.any():
            break
        rest = right[free] - matrix[np.ix_(free, ~free)] @ estimate[~free]
        part = matrix[np.ix_(free, free)]
        # Of each number its own: units may differ by ten powers of ten.
        ridge = 1e-10 * np.diag(part) + 1e-300
        solved = np.linalg.solve(part + np.diag(ridge), rest)
        held = np.clip(solved, low[free], high[free])
        outside = held != solved
        estimate[free] = held
        if not outside.any():
            break
        # One a round, the farthest out: a neighbour may come back in once it is held.
        places = np.flatnonzero(free)
        scale = np.sqrt(np.maximum(np.diag(part), 1e-300))
        worst = int(np.argmax(np.abs(solved - held) * scale))
        free[places[worst]] = False
    return estimate
