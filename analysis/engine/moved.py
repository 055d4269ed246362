"""Numbers of a machine that parameters alone moved farther than what is known of them allows.

A number that explains by itself costs, in the score, its prior odds and the choice among all
numbers that there are: four to six sigmas would be nothing. But it is not one law of forty that may
be left out: it is there, uncertain, and the fit has moved it. Where it moved by three sigmas it is
as likely off as not.
"""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2, norm

from analysis.engine.hypothesis import LOG_ODDS
from analysis.engine.system import Array, Nuisance

EVEN = 3.0
"""A number that has moved by so many sigmas is as likely off as not (design, section 6, step 2)."""


def moved_far(nuisances: Sequence[Nuisance], at: Array) -> dict[str, float]:
    """Candidates whose numbers moved by more than `EVEN` sigmas, and by how many.

    Parameters
    ----------
    nuisances
        Of a system.
    at
        Where they are likeliest with nothing left out, in sigmas, shape (nuisances,).

    Returns
    -------
    dict
        Candidate -> sigmas: of the number that moved farthest, or of all of its numbers together,
        as a normal number as unlikely.
    """
    of: dict[str, list[float]] = {}
    for one, sigmas in zip(nuisances, at, strict=True):
        if one.cause is not None:
            of.setdefault(one.cause, []).append(float(sigmas))
    found: dict[str, float] = {}
    for cause, moved in of.items():
        together = float(np.square(moved).sum())
        unlikely = max(float(chi2.sf(together, len(moved))), np.finfo(float).tiny)
        sigmas = max(float(np.abs(moved).max()), float(norm.isf(0.5 * unlikely)))
        if sigmas > EVEN:
            found[cause] = sigmas
    return found


def rise_of(sigmas: float, temper: float) -> float:
    """By how much the score of a number that moved so far is above that of nothing.

    Parameters
    ----------
    sigmas
        By how many sigmas it moved.
    temper
        By which factor scores count for less: one cause more is no likelier for that.
    """
    return 0.5 * (sigmas**2 - EVEN**2) - LOG_ODDS * (temper - 1.0)
