"""A faint tone that was led out of tune by many turns, beside one that was not."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.all_samples import cost_of
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate
from analysis.engine.cycles import tuned, valley
from analysis.engine.followed import Followed
from analysis.engine.in_tune import in_tune
from analysis.engine.known import Known
from analysis.engine.ring_fit import follow_ring
from analysis.engine.system import Nuisance, Point, Prediction

TONES_HZ, MIXED = np.array([5.0, 8.3]), np.array([[1.0, 0.3], [-0.5, 1.0]])
SHARE, SECONDS, NOISE = 0.02, 20.0, 0.02
T_S = np.arange(0.0, SECONDS, 0.02)
TRUTH = np.array([0.4, -0.3])

TURNS = 6.0
"""By which the faint tone is off at the end."""


class Duet:
    """Two tones, each of them moved by both of two numbers; one is loud and one is faint."""

    name = "duet"
    nuisances: Sequence[Nuisance] = (Nuisance("a", SHARE, "1"), Nuisance("b", SHARE, "1"))
    candidates: Sequence[Candidate] = ()

    def __init__(self, energies: Sequence[float] = (2e5, 300.0), truth: Array = TRUTH) -> None:
        self.heights = np.sqrt(2.0 * np.array(energies) * NOISE**2 / len(T_S))
        truth = self._one(truth)
        noisy = truth + NOISE * np.random.default_rng(3).standard_normal(truth.shape)
        self.bundles = (
            Bundle(
                ("y",), ("V",), T_S, noisy, np.eye(1) * NOISE**2,
                (Segment(0.0, SECONDS, None, 20.0),), record="only", tones_hz=tuple(TONES_HZ),
            ),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point.nuisance)]) for point in points]

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return self._tones(point.nuisance)

    @staticmethod
    def _tones(nuisance: Array) -> Array:
        return np.asarray(TONES_HZ * (1.0 + SHARE * MIXED @ nuisance))

    def _one(self, nuisance: Array) -> Array:
        turns = 2.0 * np.pi * np.outer(T_S, self._tones(nuisance))
        return np.asarray(np.cos(turns) @ self.heights)[:, None]


def out_of_tune(system: Duet) -> Followed:
    """Where the loud tone is right, and the faint one some turns off."""
    off = np.array([0.0, TURNS / (TONES_HZ[1] * SHARE * SECONDS)])
    start = TRUTH + np.linalg.solve(MIXED, off)
    return follow_ring(system, start, everything=True, near=True)


def test_numbers_are_found_that_bring_one_tone_to_the_ring_that_is_left() -> None:
    system = Duet()
    led = out_of_tune(system)
    right = system.tones_hz(Point(TRUTH))
    before = system.tones_hz(led.point)
    assert abs(before[1] - right[1]) * SECONDS > TURNS - 1.0
    (there,) = in_tune(system, led, Known.priors(led))
    found = system.tones_hz(there.point)
    assert found[0] == pytest.approx(before[0], abs=1e-4)
    assert abs(found[1] - right[1]) * SECONDS < 0.3
    assert valley(system, led).led.nuisance == pytest.approx(TRUTH, abs=0.02)


def test_a_tone_is_looked_for_wherever_it_may_be_by_what_was_known_beforehand() -> None:
    truth = np.linalg.solve(MIXED, np.array([0.1, -2.5]))
    system = Duet(truth=truth)
    start = np.linalg.solve(MIXED, np.array([0.1, 2.5]))
    led = follow_ring(system, start, everything=True, near=True)
    right = system.tones_hz(Point(truth))
    # Twice as far from there as from where it was likeliest.
    assert abs(system.tones_hz(led.point)[1] - right[1]) > 4.0 * SHARE * TONES_HZ[1]
    (there,) = in_tune(system, led, Known.priors(led))
    assert abs(system.tones_hz(there.point)[1] - right[1]) * SECONDS < 0.3


def test_a_hypothesis_is_brought_in_tune_by_few_simulations() -> None:
    system = Duet()
    led = out_of_tune(system)
    found = tuned(system, led)
    assert found.nuisance == pytest.approx(TRUTH, abs=0.02)
    assert cost_of(found) < cost_of(led) - 100.0
    assert found.effort < led.effort + 50.0


def test_what_is_in_tune_stays_as_it_is() -> None:
    system = Duet()
    led = follow_ring(system, TRUTH, everything=True, near=True)
    assert tuned(system, led) is led


def test_beside_a_law_that_is_not_exact_no_ring_is_followed() -> None:
    # What is left of the law holds lines everywhere, near the tone as well.
    system = Duet()
    led = out_of_tune(system)
    assert list(in_tune(system, led, Known.priors(led)))
    bundle = system.bundles[0]
    sweep = 4.2 * NOISE * np.sin(2.0 * np.pi * (1.0 + 0.5 * T_S) * T_S)
    system.bundles = (replace(bundle, value=bundle.value + sweep[:, None]),)
    assert not list(in_tune(system, led, Known.priors(led)))


def test_what_is_in_tune_leaves_no_ring_to_follow() -> None:
    system = Duet()
    led = follow_ring(system, TRUTH, everything=True, near=True)
    assert not list(in_tune(system, led, Known.priors(led)))


def test_a_tone_that_is_known_well_is_not_looked_for_elsewhere() -> None:
    system = Duet()
    led = out_of_tune(system)
    surely = Known.priors(led)
    surely = surely._replace(information=1e4 * surely.information)
    assert not list(in_tune(system, led, surely))
