"""How much noise there is in samples of a motion, where nothing was recorded at rest."""

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile.excitation import Excitation

Array = NDArray[np.float64]

HARMONICS = 4
"""Of the drive, that are fitted and taken off before anything else."""

BAND = 0.45
"""Of the mean rate of the samples: harmonics above it would be folded."""

FEWEST = 48
"""A stretch of fewer samples has too few lines for a median of them."""

SLOWEST = 2
"""Lines, of the lowest frequencies, that a drift widens: they are not asked."""


def noise_floor(t_s: Array, value: Array, excitation: Excitation, shift_s: float = 0.0) -> float:
    """Standard deviation of the noise of one sample: an estimate that errs upward.

    The drive's harmonics are fitted at the samples' own times; of the lines of what is left, half
    are below the median, wherever some stand out: a ring and a drift are a few lines, noise is all
    of them. Of noise alone a line's power is exponentially distributed, with a median of log 2 of
    its mean. Where neighbours bend less than that, as those of quick samples do, they are believed.

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
    left = _without_drive(t_s[steady], value[steady], excitation.frequency_hz)
    taper = np.hanning(len(left))
    power = np.abs(np.fft.rfft(left * taper)) ** 2 / float(taper @ taper)
    of_lines = float(np.sqrt(np.median(power[SLOWEST:-1]) / np.log(2.0)))
    return min(of_lines, _about_bend(value))


def _without_drive(t_s: Array, value: Array, frequency_hz: float) -> Array:
    """What a constant, a drift and the drive's harmonics leave."""
    span_s = float(np.ptp(t_s))
    tau = t_s - t_s[0]
    columns = [np.ones_like(tau), tau / span_s]
    for harmonic in range(1, HARMONICS + 1):
        if harmonic * frequency_hz < BAND * (len(t_s) - 1) / span_s:
            angle = 2.0 * np.pi * harmonic * frequency_hz * tau
            columns += [np.cos(angle), np.sin(angle)]
    design = np.column_stack(columns)
    return np.asarray(value - design @ np.linalg.lstsq(design, value, rcond=None)[0])


def _about_bend(value: Array) -> float:
    """Standard deviation of samples about their neighbours' mean, outliers aside."""
    bend = value[1:-1] - (value[:-2] + value[2:]) / 2.0
    return float(np.median(np.abs(bend)) / 0.6745 / np.sqrt(1.5))
