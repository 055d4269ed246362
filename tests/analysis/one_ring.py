"""A system of one channel in which one tone rings, for tests of what is led to its phase."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analysis.engine import Bundle, Nuisance, Point, Segment
from analysis.engine.array import Array
from analysis.engine.system import Prediction

T_S = np.arange(0.0, 20.0, 0.02)
NOISE, TONE_HZ, ZERO = 0.01, 5.0, np.zeros(1)


class OneRing:
    """A ring whose tone is known to a per cent, and what a test adds to it.

    Parameters
    ----------
    true
        What is recorded, with noise.
    """

    nuisances: Sequence[Nuisance] = (Nuisance("tone", 0.01, "1"),)

    def __init__(self, true: Point) -> None:
        value = self._one(true)
        value = value + NOISE * np.random.default_rng(5).standard_normal(value.shape)
        segments = (Segment(0.0, 20.0, None, 20.0),)
        self.bundles = (
            Bundle(("y",), ("V",), T_S, value, np.eye(1) * NOISE**2, segments, tones_hz=(TONE_HZ,)),
        )

    def added(self, point: Point) -> Array | float:
        """What is on adds, V, shape (n,)."""
        raise NotImplementedError

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point)]) for point in points]

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return np.array([TONE_HZ * (1.0 + 0.01 * float(point.nuisance[0]))])

    def _one(self, point: Point) -> Array:
        ring = np.sin(2.0 * np.pi * self.tones_hz(point)[0] * T_S)
        return np.asarray((ring + self.added(point))[:, None])
