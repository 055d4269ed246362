"""Other beginnings: over a short stretch a ring fits in several valleys, of which one goes on.

After a second of motion every tone is known to a part of a turn, and parameters that fit as well as
noise allows may lie in another valley than the one in which the next second fits, too. Such valleys
are found by drawing what the first stretch leaves open (Laplace's approximation), and leading on
from there.
"""

import numpy as np

from analysis.engine.array import Array
from analysis.engine.differences import differences
from analysis.engine.followed import Followed
from analysis.engine.ring_fit import STEPS
from analysis.engine.ring_samples import Samples
from analysis.engine.system import System
from analysis.engine.way import WINDOWS, Way

BEGINNING, TOLD = WINDOWS[0], 0.27
"""Shares of the time: what is drawn fits as well up to the first, and is held to be right where it
leaves nothing but noise up to the second."""

FAR = 30.0
"""What leaves so much of a squared sample is in no valley near by."""

TRIES = 6
"""So many are drawn. Where it was measured, four of ten found the right valley."""


def begun_otherwise(system: System, at: Array) -> Followed | None:
    """Where parameters alone leave nothing but noise for longer than the beginning, if anywhere.

    Parameters
    ----------
    system
        What is simulated.
    at
        The likeliest parameters, in sigmas, shape (p,).

    Returns
    -------
    Followed or None
        Where one of the draws has led to, up to `TOLD`. None: no draw did, or parameters do not
        even foretell the beginning.
    """
    samples = Samples(system, everything=True)
    way = _led(samples, at, BEGINNING)
    if way.left(BEGINNING) > way.allowed(BEGINNING):
        return None
    columns, _ = differences(samples, way.at, way.here, BEGINNING)
    known = columns @ columns.T + np.eye(len(columns))
    root = np.linalg.inv(np.linalg.cholesky(known)).T
    generator = np.random.default_rng(0)
    for _ in range(TRIES):
        drawn = way.at.nuisance + root @ generator.standard_normal(len(root))
        found = _led(samples, drawn, TOLD)
        if not found.strained(TOLD):
            return found.at
    return None


def _led(samples: Samples, at: Array, upto: float) -> Way:
    """Parameters alone, led over windows up to a share of the time, as long as they foretell it."""
    way = Way(samples, Followed(at, None))
    for share in WINDOWS:
        if share > upto:
            break
        for _ in range(STEPS):
            if not way.step(share, lost=FAR):
                break
        if way.left(share) > way.allowed(share):
            break
    return way
