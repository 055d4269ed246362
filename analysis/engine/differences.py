"""What each free number does to all samples, by differences as fine as each asks for."""

import numpy as np

from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.ring_samples import Samples

COARSE = 1.5
"""A difference that moves all samples together by more than this, in units of noise, may have
turned the phase too far: what it is off by grows as its square."""


def differences(
    samples: Samples, at: Followed, here: Array, share: float = 1.0, known: int = 0
) -> tuple[Array, Array]:
    """What one unit of each free number does to all samples.

    A tone of which one standard deviation of a number takes many turns is moved by less, and both
    ways: the error is then of third order.

    Parameters
    ----------
    samples
        By which it is told.
    at, here
        About where, and what is left there, shape (n,).
    share
        Of the time that is simulated.
    known
        So many of the numbers, the first, are not asked.

    Returns
    -------
    Array, Array
        Columns, shape (numbers - known, n), and the differences of all numbers, shape (numbers,).
    """
    points, steps = at.neighbours()
    if len(points) == known:
        return np.zeros((0, len(here))), steps
    rows = np.stack(samples.residuals(points[known:], share))
    columns = np.asarray((here - rows) / steps[known:, None])
    far = np.linalg.norm(here - rows, axis=1)
    coarse = np.flatnonzero(far > COARSE).tolist()
    ends: list[Followed] = []
    for k in coarse:
        change = np.zeros(len(steps))
        change[known + k] = steps[known + k] * COARSE / far[k]
        ends += [at.moved(change, sign) for sign in (1.0, -1.0)]
    left = samples.residuals([one.point for one in ends], share)
    for k, up, down, above, below in zip(
        coarse, ends[::2], ends[1::2], left[::2], left[1::2], strict=True
    ):
        columns[k] = (below - above) / (up.numbers[known + k] - down.numbers[known + k])
    return columns, steps
