"""The ring itself: parameters moved until a simulation rings in the recording's own phase.

Naming leaves rings out, for their phase is lost where parameters are a little off. Once a cause is
chosen, the parameters are near enough to be led to it: over a short stretch first, in which no
phase is far off, and then over longer ones.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis.engine.sensitivity import BATCH
from analysis.engine.system import Array, Bundle, Point, Prediction, System

WINDOWS = (0.25, 0.4, 0.7, 1.0)
"""Shares of the used time over which the ring is followed, one after the other."""

STEP = 0.02
"""Of the difference that tells what a parameter does, in sigmas: longer ones turn the phase."""

SHORTER, SHORTEST = 0.4, 3
"""A step that went too far is taken again, this much of it, and so often."""

LOST = 30.0
"""Where a sample is off by more than this, squared and on average, there is no phase to follow."""

Mask = list[NDArray[np.bool_]]


def follow_ring(system: System, point: Point, held: str = "") -> Point:
    """The same point with its nuisances where the simulation, ring and all, fits best.

    Parameters
    ----------
    system, point
        What is simulated, and from where.
    held
        A recording that is kept back, but for its rest.

    Returns
    -------
    Point
        With `ring` "as_is".
    """
    best = replace(point, ring="as_is")
    for share in WINDOWS:
        moved = _step(system, best, [_used(one, share, held) for one in system.bundles])
        if moved is None:
            break
        best = moved
    return best


def _step(system: System, start: Point, mask: Mask) -> Point | None:
    """One Gauss-Newton step over the samples of a mask; None where it leads nowhere."""

    def residual(prediction: Prediction) -> Array:
        return _residual(system.bundles, prediction, mask)

    at = start.nuisance
    (here,) = system.simulate([start], residual)
    if float(here @ here) > LOST * len(here):
        return None
    points = []
    for i in range(len(at)):
        moved = at.copy()
        moved[i] += STEP
        points.append(replace(start, nuisance=moved))
    rows: list[Array] = []
    for first in range(0, len(points), BATCH):
        rows += system.simulate(points[first : first + BATCH], residual)
    columns = (here[None, :] - np.stack(rows)) / STEP
    target = np.linalg.solve(np.eye(len(at)) + columns @ columns.T, columns @ here - at)
    share, before = 1.0, float(here @ here + at @ at)
    for _ in range(SHORTEST):
        there = at + share * target
        (left,) = system.simulate([replace(start, nuisance=there)], residual)
        if float(left @ left + there @ there) < before:
            return replace(start, nuisance=there)
        share *= SHORTER
    return None


def _used(bundle: Bundle, share: float, held: str) -> NDArray[np.bool_]:
    """The samples up to a share of the time that is not kept back."""
    chosen = np.zeros(len(bundle.t_s), dtype=bool)
    for one in bundle.segments:
        kept_back = one.held_out or one.sealed or (bundle.record == held and one.name != "rest")
        if not kept_back:
            chosen |= (bundle.t_s >= one.start_s) & (bundle.t_s < one.end_s)
    places = np.flatnonzero(chosen)
    chosen[places[int(np.ceil(share * len(places))) :]] = False
    return chosen


def _residual(bundles: Sequence[Bundle], prediction: Prediction, mask: Mask) -> Array:
    """Residuals of the masked samples in units of their noise, one after the other."""
    parts = []
    for bundle, seen, chosen in zip(bundles, prediction, mask, strict=True):
        whiten = np.linalg.inv(np.linalg.cholesky(bundle.covariance))
        parts.append(((bundle.value[chosen] - seen[chosen]) @ whiten.T).reshape(-1))
    return np.concatenate(parts)
