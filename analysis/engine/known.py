"""What is known of free numbers before samples are looked at, and what recordings add to it."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.part import Part

LOOSE = 0.02
"""What is on is held where it is as if its number were known to its step over this."""


class Known(NamedTuple):
    """What is known of free numbers before samples are looked at: nuisances, then what is on.

    Attributes
    ----------
    at
        Where they are likeliest, shape (numbers,).
    information
        The inverse of their covariance, shape (numbers, numbers).
    """

    at: Array
    information: Array

    @classmethod
    def priors(cls, start: Followed) -> "Known":
        """Each nuisance by its own sigma, and nothing of what is on."""
        nuisances = np.arange(len(start.numbers)) < len(start.nuisance)
        return cls(np.zeros(len(nuisances)), np.diag(nuisances.astype(float)))

    def cost(self, numbers: Array) -> float:
        """How far numbers are from there, squared, in standard deviations."""
        off = numbers - self.at
        return float(off @ self.information @ off)


class Told:
    """What recordings told of all free numbers so far: nuisances of the whole, then what is on."""

    def __init__(self, start: Followed) -> None:
        self.at = start
        known = Known.priors(start).information
        if start.state is not None:
            steps = np.array([start.state.signed_step(k) for k in range(len(start.state.free))])
            own = np.arange(len(start.nuisance), len(known))
            known[own, own] = (LOOSE / steps) ** 2
        self._covariance = np.linalg.inv(known)

    def of(self, part: Part) -> Known:
        """What is known of a part's numbers, whatever the others are."""
        places = self._places(part)
        covariance = self._covariance[np.ix_(places, places)]
        return Known(self.at.numbers[places], np.linalg.inv(covariance))

    def add(self, part: Part, found: Followed, information: Array) -> None:
        """What a part tells of its numbers, and through them of the others."""
        places, before = self._places(part), self._covariance
        inside = before[np.ix_(places, places)]
        follows = np.linalg.solve(inside, before[places]).T
        moved = follows @ (found.numbers - self.at.numbers[places])
        # Numbers of the part itself are where they were led to: a law's may be held by its range.
        self.at = replace(self.at.moved(moved, 1.0), state=found.state)
        surer = np.linalg.inv(np.linalg.inv(inside) + information)
        self._covariance = before + follows @ (surer - inside) @ follows.T

    def _places(self, part: Part) -> NDArray[np.int64]:
        every, count = np.arange(len(self.at.numbers)), len(self.at.nuisance)
        return np.concatenate([part.places, every[count:]])
