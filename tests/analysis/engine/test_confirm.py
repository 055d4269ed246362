"""What is held against the chosen hypothesis is a fit, and what foretells less is not believed."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Term, diagnose
from analysis.engine.array import Array
from analysis.engine.system import Prediction
from tests.analysis.engine.test_check import Line

T_S = np.arange(0.0, 30.0, 0.05)
NOISE, HELD_FROM = 0.01, 20.0


class Growth:
    """What grows at a rate that is roughly known, and a drift that may be left out.

    Of a rate that makes up for the drift straight lines promise what no whole step keeps.
    """

    name = "growth"
    nuisances = (Nuisance("rate", 0.5, "1"), Nuisance("start", 0.1, "1"))
    candidates = (
        Candidate("drift", "drift", "cell", (Term("drift", "drift", "V/s", "", 0.0, 1.0, 0.1),)),
    )

    def __init__(self, rate: float, drift: float, late: float | None = None) -> None:
        value = self.model(np.array([rate, 0.5]), drift)
        value += (late or 0.0) * np.maximum(T_S - HELD_FROM, 0.0)
        value += np.random.default_rng(3).normal(0.0, NOISE, len(T_S))
        stretches = (
            Segment(0.0, HELD_FROM, name="first"),
            Segment(HELD_FROM, 30.0, name="last", held_out=True, sealed=late is not None),
        )
        bundle = Bundle(
            ("x",), ("V",), T_S, value[:, None], np.array([[NOISE**2]]), stretches, kind="x"
        )
        self.bundles: Sequence[Bundle] = (bundle,)

    def model(self, z: Array, drift: float) -> Array:
        rate, start = 0.05 * np.exp(0.5 * z[0]), np.exp(0.1 * z[1])
        return np.asarray(start * np.exp(rate * T_S) + drift * T_S)

    def predict(self, point: Point) -> Prediction:
        on = point.effects.get("drift")
        return [self.model(point.nuisance, 0.0 if on is None else on.values["drift"])[:, None]]

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        return [reduce(self.predict(point)) for point in points]

    def fitted(self) -> float:
        """Of parameters alone, by SciPy: what is left of the used part, in noise."""
        used = T_S < HELD_FROM
        (bundle,) = self.bundles

        def left(z: Array) -> Array:
            off = (bundle.value[:, 0] - self.model(z, 0.0))[used] / NOISE
            return np.concatenate([off, z])

        starts = (np.array([one, 0.0]) for one in (-1.0, -0.5, 0.0, 0.5, 1.0))
        best = min((least_squares(left, one) for one in starts), key=lambda one: float(one.cost))
        return float(np.sqrt(np.mean(left(best.x)[:-2] ** 2)))


@pytest.mark.parametrize(("rate", "drift"), [(0.0, 0.2), (0.0, 0.8)])
def test_before_is_parameters_where_they_fit(rate: float, drift: float) -> None:
    system = Growth(rate, drift=drift)
    found = diagnose(system)
    assert found.confirmation is not None
    assert found.confirmation.before["used"]["x"] < 1.05 * system.fitted()
    assert found.confirmation.after["used"]["x"] < 1.1
    assert found.verdict == "explained"


def test_what_foretells_worse_than_nothing_is_as_likely_something_else() -> None:
    # What comes after the used part, which only the proof sees, grows on as no drift does.
    system = Growth(0.0, drift=0.1, late=0.5)
    found = diagnose(system)
    assert found.judgement is not None
    assert found.verdict == "ambiguous"
    assert max(one.probability for one in found.judgement.causes) <= 0.5
    assert any("did not use, x is off by" in one for one in found.notes)


def test_beside_a_parameter_that_moved_far_what_is_named_is_not_sure() -> None:
    system = Line()
    (bundle,) = system.bundles
    bundle.value[:] += np.sin(2.0 * np.pi * bundle.t_s / 5.0)[:, None]
    assert diagnose(system).verdict == "explained"
    bundle.value[:] += 6.0 * system.nuisances[0].sigma
    found = diagnose(system)
    assert found.verdict == "ambiguous"
    assert any("'offset' fits +5." in one or "'offset' fits +6." in one for one in found.notes)
