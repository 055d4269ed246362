"""What changes span, in few orthonormal directions: white noise stays white in them."""

import numpy as np

from analysis.engine.array import Array
from analysis.engine.labels import Labels
from analysis.engine.variance import SPREAD

UNEXPLAINED = 0.2
"""Of what nothing explains, this share may lie where candidates are looked for."""

FORMS = 20
"""An error of form lies in few directions, and in which is not known: in each it may be as large as
if there were so many."""

INEXACT = 0.015
"""Two simulators of the same laws differ by as much, rms, in units of a sample's noise: by nothing
in a thousand samples, and in fifty thousand by more than a cause has to explain."""

INDEPENDENT = 1e-9
"""Directions that hold less than this share of the strongest one's power are rounding."""


def compressed(changes: Array, residual: Array, allowed: float = 1.0) -> tuple[Array, Array, float]:
    """Changes and residual, in the directions that the changes span.

    Parameters
    ----------
    changes, residual
        Shapes (k, n) and (n,).
    allowed
        What noise may leave of a squared sample, on average: its variance may be known from few.

    Returns
    -------
    Array, Array, float
        Shapes (f, k) and (f,), and the variance of noise there: more than one where the residual
        holds what nothing spans, and where samples are many.
    """
    norms = np.linalg.norm(changes, axis=1)
    norms[norms == 0.0] = 1.0
    values, vectors = np.linalg.eigh((changes @ changes.T) / np.outer(norms, norms))
    kept = values > INDEPENDENT * values[-1]
    roots, vectors = np.sqrt(values[kept]), vectors[:, kept]
    inside = (roots[:, None] * vectors.T) * norms
    residual_inside = (vectors.T @ (changes @ residual / norms)) / roots
    free = max(len(residual) - len(roots), 1)
    left = float(residual @ residual - residual_inside @ residual_inside) / free
    spread = UNEXPLAINED * max(left - allowed, 0.0) * len(residual) / len(roots)
    known = max(min(left, allowed), 1.0) + inexact(len(residual))
    return inside, residual_inside, known + spread


def inexact(count: int) -> float:
    """What a simulator's own error adds to the variance along each direction that is looked at.

    Parameters
    ----------
    count
        Samples.
    """
    return INEXACT**2 * count / FORMS


def all_alike(size: int) -> Labels:
    """One group of directions that are all alike: an error of form may lie in any of them.

    Parameters
    ----------
    size
        How many.
    """
    zeros, flags = np.zeros(size, dtype=np.int64), np.zeros(size, dtype=bool)
    return Labels(
        bundle=zeros,
        channel=zeros,
        segment=zeros,
        line=np.ones(size),
        ringing=flags,
        growth=np.ones(size),
        quadrature=zeros,
        order=zeros,
        held_out=flags,
        group=zeros,
        stretch=zeros,
        samples=np.full(size, round(SPREAD * FORMS)),
        free=~flags,
        every=~flags,
        sealed=flags,
    )
