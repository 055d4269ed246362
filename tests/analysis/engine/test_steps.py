"""Steps in valleys that turn: differences promise too little there, or too much."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Nuisance, Point, Prediction
from analysis.engine.way import WORTH_A_STEP

T_S = np.arange(0.0, 10.0, 0.01)


class Valley:
    """One channel in which two numbers act along a valley that turns; both are one sigma off."""

    name = "valley"
    nuisances: Sequence[Nuisance] = (Nuisance("along", 1.0, "1"), Nuisance("across", 1.0, "1"))
    candidates: Sequence[Candidate] = ()

    def __init__(self, steep: float) -> None:
        self._steep = steep
        noise = 0.5 * np.random.default_rng(2).standard_normal((len(T_S), 1))
        self.bundles = (
            Bundle(
                ("y",), ("V",), T_S, self._one(np.array([1.0, 1.0])) + noise, np.eye(1) * 0.5**2,
                (Segment(0.0, 1.0, None, 10.0, name="rest"), Segment(1.0, 10.0, None, 10.0)),
                tones_hz=(5.0,),
            ),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point.nuisance)]) for point in points]

    def _one(self, at: Array) -> Array:
        """Every second sample tells how far across the valley, the others how far along."""
        across = self._steep * (at[1] - at[0] ** 2)
        samples = np.where(np.arange(len(T_S)) % 2 == 0, across, at[0])
        return np.asarray(samples[:, None])


@pytest.mark.parametrize("steep", [5.0, 20.0])
@pytest.mark.parametrize("start", [(0.0, 0.0), (3.0, -3.0)])
def test_a_valley_that_turns_is_followed_to_its_lowest_point(
    steep: float, start: tuple[float, float]
) -> None:
    valley = Valley(steep)
    found = follow_ring(valley, np.array(start), everything=True)
    (truth,) = Samples(valley, everything=True).residuals([Point(np.array([1.0, 1.0]))])
    # The truth is within its noise of the lowest point; so is what is no more than a step worse.
    assert found.misfit + found.strain < float(truth @ truth) + 2.0 + WORTH_A_STEP
    assert found.nuisance[0] == pytest.approx(1.0, abs=0.1)
    assert found.left == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("start", [(0.0, 0.0), (2.0, 4.0), (3.0, 9.0)])
def test_along_a_steep_valley_steps_lead_out_of_it_and_back(start: tuple[float, float]) -> None:
    # Damped steps, which stay in it, stop far from its lowest point, or creep.
    valley = Valley(100.0)
    found = follow_ring(valley, np.array(start), everything=True, near=True)
    (truth,) = Samples(valley, everything=True).residuals([Point(np.array([1.0, 1.0]))])
    assert found.misfit + found.strain < float(truth @ truth) + 2.0 + WORTH_A_STEP
