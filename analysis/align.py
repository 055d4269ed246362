"""Putting a simulation on the time of a recording: when the motion started."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags

from analysis.series import Series

Array = NDArray[np.float64]

GRID_S = 0.005
"""Grid of the correlation; a fraction of a millisecond is then won by interpolation."""


def find_start_shift(simulated_t_s: Array, simulated: Array, measured: Series) -> float:
    """By how much a simulation must be moved to lie on a recording.

    Used where the recording does not know when the motion was commanded. The whole series is
    correlated, ramps and rest included, since within the steady motion every period looks alike.

    Parameters
    ----------
    simulated_t_s, simulated
        The simulated series, shape (n,).
    measured
        The same quantity, recorded.

    Returns
    -------
    float
        Seconds to add to the simulation's times.
    """
    grid = np.arange(measured.t_s[0], measured.t_s[-1], GRID_S)
    recorded = np.interp(grid, measured.t_s, measured.value)
    own_grid = np.arange(simulated_t_s[0], simulated_t_s[-1], GRID_S)
    expected = np.interp(own_grid, simulated_t_s, simulated)
    match = correlate(recorded, expected, mode="full", method="fft")
    lags = correlation_lags(len(recorded), len(expected), mode="full")
    best = int(np.argmax(match))
    fraction = 0.0
    if 0 < best < len(match) - 1:
        left, top, right = match[best - 1 : best + 2]
        bend = left - 2.0 * top + right
        fraction = 0.5 * (left - right) / bend if bend else 0.0
    return float(grid[0] - own_grid[0] + (lags[best] + fraction) * GRID_S)
