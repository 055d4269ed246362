"""How much noise there is in samples of a motion: what lies between the lines of their spectrum."""

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile.excitation import Excitation

Array = NDArray[np.float64]

HARMONICS = 7
"""Of the drive, taken off before the floor of a spectrum is looked for."""

LOWEST_BINS = 3
"""Of a spectrum, that hold what is left of trends."""

HALF = 0.5
"""Share of a spectrum's bins that a ring and a drift do not reach."""

FEWEST = 48
"""A stretch of fewer samples has too few lines for that."""


def noise_floor(t_s: Array, value: Array, excitation: Excitation, shift_s: float = 0.0) -> float:
    """Standard deviation of the noise of one sample that was never at rest: it errs upward.

    Where neighbours bend less than the floor, as those of quick samples do, they are believed.

    Parameters
    ----------
    t_s, value
        Samples, about evenly apart, shape (n,).
    excitation, shift_s
        What was commanded, and how much later than it says.
    """
    first, last = excitation.steady_window_s
    steady = (t_s >= first + shift_s) & (t_s <= last + shift_s)
    if np.count_nonzero(steady) < FEWEST:
        steady = np.ones(len(t_s), dtype=bool)
    if np.count_nonzero(steady) < FEWEST:
        return _about_bend(value)
    variance = floor_between_lines(t_s[steady], value[steady, None], excitation.frequency_hz, HALF)
    return min(float(np.sqrt(variance[0])), _about_bend(value))


def floor_between_lines(t_s: Array, value: Array, frequency_hz: float, quiet: float) -> Array:
    """Variance of what lies between the lines of each column's spectrum, shape (m,).

    The drive's harmonics are fitted at the samples' own times.

    Parameters
    ----------
    t_s, value
        Samples, about evenly apart, shapes (n,) and (n, m).
    frequency_hz
        Of the drive.
    quiet
        Share of the bins that no line is expected to reach.
    """
    count = len(t_s)
    nyquist_hz = 0.5 * (count - 1) / (t_s[-1] - t_s[0])
    turns = 2.0 * np.pi * frequency_hz * (t_s - t_s[0])
    waves = [np.ones(count), t_s - t_s.mean()]
    for number in range(1, HARMONICS + 1):
        if number * frequency_hz < nyquist_hz:
            waves += [np.cos(number * turns), np.sin(number * turns)]
    basis = np.stack(waves, axis=1)
    rest = value - basis @ np.linalg.lstsq(basis, value, rcond=None)[0]
    window = np.hanning(count)[:, None]
    power = np.abs(np.fft.rfft(rest * window, axis=0)) ** 2 / (window**2).sum()
    # A bin of white noise has an exponential distribution.
    return np.asarray(np.quantile(power[LOWEST_BINS:], quiet, axis=0) / -np.log1p(-quiet))


def _about_bend(value: Array) -> float:
    """Standard deviation of samples about their neighbours' mean, outliers aside."""
    bend = value[1:-1] - (value[:-2] + value[2:]) / 2.0
    return float(np.median(np.abs(bend)) / 0.6745 / np.sqrt(1.5))
