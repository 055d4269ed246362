"""Loops from one value to the next that NumPy has no word for: compiled, see `model.compiled`."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


HANGS_N = 3e-3
"""A cable that pulls less than this hangs."""


def between_rows(time_s: Array, values: Array, read_s: Array, seen: Array) -> None:
    """Cubics through the four rows about each time; before and after the rows, their ends.

    Where a cable goes slack its tension has a corner between two rows: there it is continued as it
    was before, and is nothing from where that comes to nothing; likewise where it tightens.

    Parameters
    ----------
    time_s, values
        The rows, two or more: shapes (n,) and (n, c); tensions, N.
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
            if min(one, other, before, after) < HANGS_N:
                earlier = values[max(row - 2, 0), column]
                later = values[min(row + 3, last + 1), column]
                value = about_a_corner(earlier, before, one, other, after, later, part)
            else:
                value = cubic(before, one, other, after, part)
            seen[k, column] = other if part == 1.0 else value


def cubic(before: float, one: float, other: float, after: float, part: float) -> float:
    """Through four rows, a part of the way from the second to the third."""
    bent = 2.0 * before - 5.0 * one + 4.0 * other - after
    twisted = 3.0 * (one - other) + after - before
    return one + 0.5 * part * (other - before + part * (bent + part * twisted))


def about_a_corner(
    earlier: float,
    before: float,
    one: float,
    other: float,
    after: float,
    later: float,
    part: float,
) -> float:
    """Between the third and the fourth of six rows, some of which hang: by those that pull."""
    if one < HANGS_N and other < HANGS_N:
        return one + part * (other - one)
    if one >= HANGS_N and other >= HANGS_N:
        if before < HANGS_N and after < HANGS_N:
            return one + part * (other - one)
        if before < HANGS_N:
            before = after - 3.0 * (other - one)
        else:
            after = before + 3.0 * (other - one)
        return cubic(before, one, other, after, part)
    if one >= HANGS_N and before >= HANGS_N:
        earlier = earlier if earlier >= HANGS_N else 2.0 * before - one
        return max(onward(earlier, before, one, part), 0.0)
    if other >= HANGS_N and after >= HANGS_N:
        later = later if later >= HANGS_N else 2.0 * after - other
        return max(onward(later, after, other, 1.0 - part), 0.0)
    return one + part * (other - one)


def onward(earlier: float, before: float, last: float, part: float) -> float:
    """The parabola through three rows, continued by a part of a row."""
    curved = earlier - 2.0 * before + last
    return last + part * (last - before + 0.5 * (part + 1.0) * curved)


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
