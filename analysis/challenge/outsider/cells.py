"""Force cells and their faults, none of them noise."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NONE = np.zeros(8)


@dataclass(frozen=True)
class CellFault:
    """Faults of the force cells, each of shape (8,) where not said.

    Parameters
    ----------
    gain_share
        Relative.
    zero_n
        N.
    drift_n, drift_s
        Asymptote of f (1 - exp(-t / tau)), N, and tau, one number, s.
    lag_s
        Time constant of a first-order low-pass, s.
    limit_n
        Where a cell stands still without a flag, N; 0: nowhere.
    seen_by
        Index of the cable that each channel shows.
    """

    gain_share: Array = field(default_factory=NONE.copy)
    zero_n: Array = field(default_factory=NONE.copy)
    drift_n: Array = field(default_factory=NONE.copy)
    drift_s: float = 10.0
    lag_s: Array = field(default_factory=NONE.copy)
    limit_n: Array = field(default_factory=NONE.copy)
    seen_by: tuple[int, ...] = tuple(range(8))


SOUND_CELLS = CellFault()


def read_cells(time_s: Array, tension_n: Array, fault: CellFault) -> Array:
    """What the cells would report at every row, without noise; channels swapped last.

    Parameters
    ----------
    time_s
        Evenly spaced, shape (n,), s.
    tension_n
        Shape (n, 8), N.
    fault
        Of the cells.

    Returns
    -------
    Array
        Shape (n, 8), N.
    """
    step_s = float(time_s[1] - time_s[0])
    seen = tension_n.copy()
    for i in range(8):
        if fault.lag_s[i] > 0.0:
            seen[:, i] = _lagging(seen[:, i], fault.lag_s[i], step_s)
        if fault.limit_n[i] > 0.0:
            seen[:, i] = np.minimum(seen[:, i], fault.limit_n[i])
    warm = 1.0 - np.exp(-time_s / fault.drift_s)
    seen = seen * (1.0 + fault.gain_share) + fault.zero_n + fault.drift_n * warm[:, None]
    return np.asarray(seen[:, list(fault.seen_by)])


def _lagging(values: Array, lag_s: float, step_s: float) -> Array:
    """A first-order low-pass that starts settled, exact for what is straight between samples."""
    from scipy.signal import lfilter

    keep = np.exp(-step_s / lag_s)
    before = (1.0 - keep) * lag_s / step_s
    taken = [1.0 - before, before - keep]
    return np.asarray(values[0] + lfilter(taken, [1.0, -keep], values - values[0]))
