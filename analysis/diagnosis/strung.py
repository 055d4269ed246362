"""What a recording shows of its cables as strings, with no law on that asks for it.

A string that is set off across, or whose tone is half of one with which the platform pulls at it,
vibrates until that is seen in tensions. Where it does not, sixteen parameters need not be
simulated. Where it grows by itself, out of what nobody measured, a recording can be foretold up to
some moment only.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.recorded import looked_at
from analysis.engine.system import Point, Prediction
from analysis.engine.whiten import sigmas_of

TRIED = 16
"""A string is in tune with the platform for some values of what is uncertain only: so many are
tried."""

SHOWN = 4.0
"""Squared, and in units of the noise: what one sigma of all strings does to all samples is seen."""

PARTS, GROWS, GROWN = 32, 0.03, 30.0
"""A recording is looked at in so many parts. Where one sigma of all strings does less than the
second to any sample of the first half, in units of the noise, and more than the third to some at
the end, for most of what was tried, it grows by itself, and counts up to where it is the second."""

GROWN_WORDS = (
    "what was recorded after {until_s:.1f} s does not count: from there on strings of the cables, "
    "in tune with the platform, vibrate more and more, by what line densities and losses leave open"
)


@dataclass(frozen=True)
class Strung:
    """What one recording shows of its strings.

    Attributes
    ----------
    apart
        What one sigma of all strings does, for each of what was tried, in units of the noise: for
        each bundle of shape (tried, samples, channels).
    bundles
        Of the recording.
    """

    apart: Sequence[Array]
    bundles: Sequence[Bundle]

    def shown_in(self, bundles: Sequence[Bundle]) -> bool:
        """Whether it tells by how much strings are off.

        Parameters
        ----------
        bundles
            Of the recording, in which segments may end earlier.
        """
        told = sum(
            np.nansum(apart[:, looked_at(bundle)] ** 2, axis=(1, 2))
            for apart, bundle in zip(self.apart, bundles, strict=True)
        )
        return bool(np.max(told) > SHOWN)

    @property
    def foretold(self) -> float:
        """Share of its time up to which it can be foretold."""
        edges = np.linspace(0.0, 1.0, PARTS + 1)
        done = np.array([self._done(*two) for two in pairwise(edges)])
        if done[: PARTS // 2].max() > GROWS or done[-1] < GROWN:
            return 1.0
        return float(edges[np.flatnonzero(done > GROWS)[0]])

    def _done(self, start: float, end: float) -> float:
        """What it does to a sample between two shares of the time, for half of what was tried."""
        most = np.zeros(TRIED)
        for apart, bundle in zip(self.apart, self.bundles, strict=True):
            share = (bundle.t_s - bundle.t_s[0]) / (bundle.t_s[-1] - bundle.t_s[0])
            here = apart[:, (share >= start) & (share <= end)]
            most = np.maximum(most, np.abs(here).max(axis=(1, 2), initial=0.0))
        return float(np.nanmedian(most))


def strung(
    see: Callable[[Sequence[Point]], Sequence[Prediction]],
    strings: NDArray[np.bool_],
    bundles: Sequence[Bundle],
) -> Strung:
    """Ask a recording's simulations what strings do.

    Parameters
    ----------
    see
        What is seen of points in that recording.
    strings
        Which nuisances are of strings, shape (p,).
    bundles
        Of that recording.
    """
    drawn = np.random.default_rng(0).normal(size=(TRIED, len(strings)))
    as_stated = [Point(np.where(strings, 0.0, one), ring="as_is") for one in drawn]
    off = [replace(one, nuisance=np.where(strings, 1.0, one.nuisance)) for one in as_stated]
    seen = see([*as_stated, *off])
    apart = [
        np.array([(seen[k + TRIED][i] - seen[k][i]) / sigmas_of(bundle) for k in range(TRIED)])
        for i, bundle in enumerate(bundles)
    ]
    return Strung(apart, bundles)
