"""The ring itself: parameters moved until a simulation rings in the recording's own phase.

Naming what is strong leaves rings out, for their phase is lost where parameters are a little off.
Where what is left is small, parameters can be led to the phase: over a short stretch first, in
which none is far off, and then over longer ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analysis.engine.sensitivity import BATCH
from analysis.engine.state import State
from analysis.engine.system import Array, Bundle, Point, Prediction, System

WINDOWS = (0.15, 0.25, 0.4, 0.6, 0.8, 1.0, 1.0)
"""Shares of the time over which the ring is followed, one after the other."""

WINDOWS_OF_MANY = (0.4, 1.0, 1.0)
"""The same for several recordings, which know the parameters better."""

THERE = 1.02
"""A squared misfit of a sample below this, on average, needs no further step."""

STEP = 0.02
"""Of the difference that tells what a parameter does, in sigmas: longer ones turn the phase."""

SHORTER, SHORTEST = 0.4, 3
"""A step that went too far is taken again, this much of it, and so often."""

LOST = 30.0
"""Where a sample is off by more than this, squared and on average, there is no phase to follow."""

FASTEST_HZ = 80.0
"""Faster samples are averaged in blocks down to about this."""

Mask = list[NDArray[np.bool_]]


@dataclass(frozen=True)
class Followed:
    """Where following the ring has led to.

    Attributes
    ----------
    nuisance
        In sigmas, shape (p,).
    state
        The free numbers of what is on; None: nothing is.
    """

    nuisance: Array
    state: State | None

    @property
    def point(self) -> Point:
        """What is to be simulated, ring and all."""
        if self.state is None:
            return Point(self.nuisance, ring="as_is")
        return replace(self.state.point(self.nuisance), ring="as_is")

    def moved(self, change: Array, share: float) -> "Followed":
        """A share of a step further."""
        count = len(self.nuisance)
        state = self.state
        if state is not None:
            state = state.moved(change[count:], share)
        return Followed(self.nuisance + share * change[:count], state)

    def neighbours(self) -> tuple[list[Point], Array]:
        """A point for each free number, moved a little, and by how much, shape (numbers,)."""
        points, steps = [], []
        for i in range(len(self.nuisance)):
            nuisance = self.nuisance.copy()
            nuisance[i] += STEP
            points.append(replace(self, nuisance=nuisance).point)
            steps.append(STEP)
        if self.state is not None:
            for k in range(len(self.state.free)):
                points.append(replace(self, state=self.state.bumped(k)).point)
                steps.append(self.state.signed_step(k))
        return points, np.array(steps)


def follow_ring(
    system: System,
    nuisance: Array,
    state: State | None = None,
    *,
    held: str = "",
    everything: bool = False,
    near: bool = False,
) -> Followed:
    """Free numbers at which the simulation, ring and all, fits best.

    Parameters
    ----------
    system
        What is simulated.
    nuisance, state
        From where.
    held
        A recording that is kept back, but for its rest.
    everything
        Use what is kept back, too; what is sealed never is.
    near
        The phase is near enough for the whole of the time at once.
    """
    best = Followed(nuisance, state)
    many = len({bundle.record for bundle in system.bundles}) > 1
    windows = WINDOWS_OF_MANY if many else WINDOWS
    for share in windows[-2:] if near else windows:
        mask = [seen(one, share=share, held=held, everything=everything) for one in system.bundles]
        moved = _step(system, best, mask)
        if moved is None and share == 1.0:
            break
        best = moved or best
    return best


def _step(system: System, start: Followed, mask: Mask) -> Followed | None:
    """One Gauss-Newton step over the samples of a mask; None where it leads nowhere."""

    def residual(prediction: Prediction) -> Array:
        return residuals(system.bundles, prediction, mask)

    at = start.nuisance
    (here,) = system.simulate([start.point], residual)
    if not THERE * len(here) < float(here @ here) < LOST * len(here):
        return None
    points, steps = start.neighbours()
    rows: list[Array] = []
    for first in range(0, len(points), BATCH):
        rows += system.simulate(points[first : first + BATCH], residual)
    columns = (here[None, :] - np.stack(rows)) / steps[:, None]
    prior = np.concatenate([np.ones(len(at)), np.zeros(len(steps) - len(at))])
    matrix = columns @ columns.T + np.diag(prior + 1e-9)
    right = columns @ here
    right[: len(at)] -= at
    target = np.linalg.solve(matrix, right)
    share, before = 1.0, float(here @ here + at @ at)
    for _ in range(SHORTEST):
        there = start.moved(target, share)
        (left,) = system.simulate([there.point], residual)
        if float(left @ left + there.nuisance @ there.nuisance) < before:
            return there
        share *= SHORTER
    return None


def seen(
    bundle: Bundle, *, share: float = 1.0, held: str = "", everything: bool = False
) -> NDArray[np.bool_]:
    """Which samples count.

    Parameters
    ----------
    bundle
        Of which.
    share
        Those up to this share of the time.
    held
        A recording that is kept back, but for its rest.
    everything
        What is kept back, too; what is sealed never.
    """
    chosen = np.zeros(len(bundle.t_s), dtype=bool)
    for one in bundle.segments:
        kept_back = one.held_out or (bundle.record == held and one.name != "rest")
        if not one.sealed and (everything or not kept_back):
            chosen |= (bundle.t_s >= one.start_s) & (bundle.t_s < one.end_s)
    places = np.flatnonzero(chosen)
    chosen[places[int(np.ceil(share * len(places))) :]] = False
    return chosen


def residuals(bundles: Sequence[Bundle], prediction: Prediction, mask: Mask) -> Array:
    """Residuals of the masked samples in units of their noise, one after the other.

    Parameters
    ----------
    bundles, prediction
        What was recorded, and what is simulated.
    mask
        For each bundle, which samples.
    """
    parts = []
    for bundle, seen, chosen in zip(bundles, prediction, mask, strict=True):
        whiten = np.linalg.inv(np.linalg.cholesky(bundle.covariance))
        rest = (bundle.value[chosen] - seen[chosen]) @ whiten.T
        length_s = bundle.t_s[-1] - bundle.t_s[0]
        block = max(int(len(bundle.t_s) / (FASTEST_HZ * length_s)), 1)
        whole = len(rest) // block * block
        rest = rest[:whole].reshape(-1, block, rest.shape[1]).sum(axis=1) / np.sqrt(block)
        parts.append(rest.reshape(-1))
    return np.concatenate(parts)
