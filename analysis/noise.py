"""What noise and sampling alone do to an amplitude: the yardstick for a difference."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DRAWS = 400
COVERAGE = 0.99


def amplitude_interval(
    simulated_t_s: Array,
    simulated: Array,
    t_s: Array,
    noise: float,
    generator: np.random.Generator,
) -> tuple[float, float]:
    """Where max |measured| would lie if the simulation were the truth.

    The simulation is sampled at the measured times, moved by up to half a sample interval (the
    phase of the samples in the cycle is chance), and noise of the measured size is added.

    Parameters
    ----------
    simulated_t_s, simulated
        The simulated series, shape (m,).
    t_s
        Measured sample times, shape (n,).
    noise
        Standard deviation of one sample.
    generator
        Source of the draws.

    Returns
    -------
    low, high
        Bounds that hold `COVERAGE` of the draws.
    """
    interval = float(np.median(np.diff(t_s)))
    peaks = np.empty(DRAWS)
    for draw in range(DRAWS):
        shift = generator.uniform(-0.5, 0.5) * interval
        drawn = np.interp(t_s + shift, simulated_t_s, simulated)
        peaks[draw] = np.abs(drawn + noise * generator.standard_normal(len(t_s))).max()
    low, high = np.quantile(peaks, [(1 - COVERAGE) / 2, (1 + COVERAGE) / 2])
    return float(low), float(high)
