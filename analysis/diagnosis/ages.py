"""How old values are when they are asked for, and what neighbours have in common of that.

An amplifier that runs on its own puts out a value each period, and tells the newest: that is up to
a period old. Where requests come at uneven times, each age is another. Where they keep step with
the period (every 40 ms, of 3.333 ms), an age stays what it is, and creeps as clocks differ: that is
no noise of single samples, and no mean over them is rid of it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.engine.whiten import whiles

Array = NDArray[np.float64]

CRYSTAL_PPM = np.linspace(-100.0, 100.0, 41)
"""By how much an amplifier's clock and the host's may differ."""

PHASES = np.arange(4) / 4.0
"""Of an amplifier's outputs, as shares of its period: unknown."""

LEAST = 0.05
"""Less in common than this share of the variance is nothing: requests are spread over periods."""


class Ages(NamedTuple):
    """The variance of ages, over that of one age.

    Attributes
    ----------
    singly
        What each sample has by itself.
    together
        What samples have in common for `TOGETHER_S`; with that by itself, 1.
    throughout
        Of the mean over all samples.
    """

    singly: float
    together: float
    throughout: float


SINGLY = Ages(1.0, 0.0, 0.0)
"""Each sample has an age of its own."""


def ages(asked_s: Array, period_s: float) -> Ages:
    """How ages vary, over clocks and phases that are not known.

    Parameters
    ----------
    asked_s
        When values were asked for, shape (n,), in order.
    period_s
        Between two outputs of the amplifier.
    """
    first, number = whiles(asked_s - asked_s[0])
    count = np.bincount(number)
    full = count > 0.5 * count.max()
    by_chance = float(np.mean(1.0 / count[full]))
    if count.max() < 2:
        return SINGLY
    of_stretch, of_all = [], []
    for ppm in CRYSTAL_PPM:
        turns = asked_s / (period_s * (1.0 + 1e-6 * ppm))
        for phase in PHASES:
            age = np.mod(turns + phase, 1.0) - 0.5
            means = np.add.reduceat(age, first)[full] / count[full]
            of_stretch.append(np.mean(means**2))
            of_all.append(np.mean(means) ** 2)
    # Uniform ages have a variance of 1/12, and a mean of n independent ones has 1/n of that.
    common = (12.0 * float(np.mean(of_stretch)) - by_chance) / (1.0 - by_chance)
    if common < LEAST:
        return SINGLY
    common = min(common, 1.0)
    return Ages(1.0 - common, common, 12.0 * float(np.mean(of_all)))
