"""How sure the numbers of a hypothesis are that was led: as all samples tell, ring and all."""

import numpy as np

from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.refine import Refiner


def as_sure(refiner: Refiner, fitted: Fitted, led: Followed, noise: float) -> Fitted:
    """A fitted hypothesis with standard deviations of its own numbers as all samples tell them.

    Lines without the ring tell less, by far. All other numbers are free within what is known of
    them, but for parameters that a number of it is itself: it is said of both together.

    Parameters
    ----------
    refiner
        Of the system.
    fitted, led
        The hypothesis, and as it was led.
    noise
        The variance along each direction, error of form and all.
    """
    if led.information is None or led.state is None:
        return fitted
    known, count = led.known(led.information / noise), len(led.nuisance)
    single = {(one.candidate, one.terms) for one in led.state.numbers}
    same = [(one.cause or "", (one.term or "",)) in single for one in refiner.system.nuisances]
    keep = np.concatenate([~np.array(same, dtype=bool), np.ones(len(known) - count, dtype=bool)])
    known, count = known[np.ix_(keep, keep)], int(keep[:count].sum())
    scale = np.sqrt(np.diag(known))
    scale[scale == 0.0] = 1.0
    covariance = np.linalg.pinv(known / np.outer(scale, scale), hermitian=True)
    spread = np.sqrt(np.maximum(np.diag(covariance)[count:], 0.0)) / scale[count:]
    return fitted.as_sure(spread)
