"""Loops from one value to the next that NumPy has no word for: compiled, see `model.compiled`."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def between_rows(time_s: Array, values: Array, read_s: Array, seen: Array) -> None:
    """Cubics through the four rows about each time; before and after the rows, their ends.

    Parameters
    ----------
    time_s, values
        The rows, two or more: shapes (n,) and (n, c).
    read_s
        When each column is read, shape (m, c); quickest where times rise.
    seen
        Filled, shape (m, c).
    """
    last = time_s.size - 2
    for column in range(values.shape[1]):
        row = 0
        for k in range(read_s.shape[0]):
            at_s = min(max(read_s[k, column], time_s[0]), time_s[last + 1])
            while row < last and time_s[row + 1] <= at_s:
                row += 1
            while row > 0 and time_s[row] > at_s:
                row -= 1
            part = (at_s - time_s[row]) / (time_s[row + 1] - time_s[row])
            one, other = values[row, column], values[row + 1, column]
            # At the ends a row is continued in a straight line.
            before = values[row - 1, column] if row > 0 else 2.0 * one - other
            after = values[row + 2, column] if row < last else 2.0 * other - one
            bent = 2.0 * before - 5.0 * one + 4.0 * other - after
            twisted = 3.0 * (one - other) + after - before
            value = one + 0.5 * part * (other - before + part * (bent + part * twisted))
            seen[k, column] = other if part == 1.0 else value


def follow_play(changes: Array, play: float, lag: Array) -> None:
    """What a value with play to either side lags by: it stands until the other stop is reached.

    Parameters
    ----------
    changes
        Of the value, from row to row, shape (n - 1,).
    play
        To either side, above zero.
    lag
        Filled from the second row on, shape (n,).
    """
    z = 0.0
    for k in range(changes.size):
        z = min(max(z + changes[k], -play), play)
        lag[k + 1] = z
