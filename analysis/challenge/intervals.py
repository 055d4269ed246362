"""How sure a figure of the challenge is: 95 % confidence intervals."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Interval = tuple[float, float]

Z_95 = 1.959964
"""Two-sided 95 % of a normal distribution."""

DRAWS = 2000


def wilson(hits: int, of: int) -> Interval:
    """Interval of a proportion (Wilson, J. Am. Stat. Assoc. 22 (1927) 209).

    Parameters
    ----------
    hits, of
        How many of how many.
    """
    if of == 0:
        return 0.0, 1.0
    share, z2 = hits / of, Z_95**2
    middle = (share + z2 / (2 * of)) / (1 + z2 / of)
    half = Z_95 * np.sqrt(share * (1 - share) / of + z2 / (4 * of * of)) / (1 + z2 / of)
    low = 0.0 if hits == 0 else float(middle - half)
    return low, 1.0 if hits == of else float(middle + half)


def bootstrap(
    values: Sequence[Sequence[float]] | Sequence[float],
    figure: Callable[[Array], float],
    generator: np.random.Generator,
) -> Interval:
    """Interval of any figure, by drawing cases again (percentiles).

    Parameters
    ----------
    values
        One row a case.
    figure
        Of the rows.
    generator
        Source of the draws.
    """
    rows = np.asarray(values, dtype=float)
    picks = generator.integers(0, len(rows), (DRAWS, len(rows)))
    drawn = [figure(rows[pick]) for pick in picks]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return float(low), float(high)
