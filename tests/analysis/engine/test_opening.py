"""A long recording of an oscillator: its first part leads, and the whole says what there is."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine.opening import from_opening, opening_of
from analysis.engine.search import search
from analysis.engine.system import Array, Bundle, Nuisance, Point, Prediction, Segment
from analysis.engine.until import Until
from tests.analysis.engine.test_ring_fit import DAMPING, SIGMA, STEP, TONE_HZ

NOISE, DAMPING_1_PER_S, HIGH, MOMENT_S = 0.02, 0.05, 0.3, 20.0

SPAN_S = {"long": 60.0, "short": 20.0}


class LetGoLong:
    """An oscillator of which the tone is known to a share; counts how long it was simulated."""

    name = "let go long"
    nuisances: Sequence[Nuisance] = (Nuisance("tone", SIGMA, "1"),)
    candidates = (DAMPING, STEP)

    def __init__(self, span: str, damping_1_per_s: float = 0.0, high: float = 0.0) -> None:
        self.t_s = np.arange(0.0, SPAN_S[span], 0.02)
        value = self._ring(2.0 * SIGMA, damping_1_per_s, high, MOMENT_S)
        value += NOISE * np.random.default_rng(1).standard_normal(value.shape)
        end_s = SPAN_S[span]
        self.bundles: tuple[Bundle, ...] = (
            Bundle(
                ("y",), ("V",), self.t_s, value, np.eye(1) * NOISE**2,
                (Segment(0.0, 1.0, None, 20.0, name="rest"), Segment(1.0, end_s, None, 20.0)),
                tones_hz=(TONE_HZ,),
            ),
        )  # fmt: skip
        self.whole, self.part = 0, 0

    def _ring(self, tone: float, damping: float, high: float, moment_s: float) -> Array:
        since = np.maximum(self.t_s - 1.0, 0.0)
        value = np.exp(-damping * since) * np.sin(2.0 * np.pi * TONE_HZ * (1.0 + tone) * since)
        return np.asarray(value + high * (moment_s <= self.t_s))[:, None]

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point)]) for point in points]

    def _one(self, point: Point) -> Array:
        whole = point.upto == 1.0
        self.whole, self.part = self.whole + whole, self.part + (not whole)
        damping, step = point.effects.get("damping"), point.effects.get("step")
        return self._ring(
            SIGMA * float(point.nuisance[0]),
            damping.values["rate"] if damping else 0.0,
            step.values["high"] if step else 0.0,
            step.shapes["moment"] if step else 0.0,
        )


def test_only_a_long_recording_has_an_opening() -> None:
    assert opening_of(LetGoLong("short")) is None
    opening = opening_of(LetGoLong("long"))
    assert opening is not None
    # Seventy turns of the tone, from when it was let go.
    assert opening.end_s == pytest.approx(14.0, abs=0.1)
    assert opening_of(opening) is None


def test_what_repeats_slowly_needs_a_longer_opening() -> None:
    system = LetGoLong("long")
    (bundle,) = system.bundles
    repeats = Segment(2.0, 60.0, 0.8)
    system.bundles = (
        Bundle(
            bundle.names, bundle.units, bundle.t_s, bundle.value, bundle.covariance,
            (repeats,), tones_hz=bundle.tones_hz,
        ),
    )  # fmt: skip
    opening = opening_of(system)
    assert opening is not None
    assert opening.end_s == pytest.approx(2.0 + 20.0 / 0.8, abs=0.1)


def test_what_the_opening_names_is_led_through_the_whole() -> None:
    system = LetGoLong("long", DAMPING_1_PER_S)
    found = search(system)
    assert not isinstance(found.system, Until)
    assert found.fitted[0].hypothesis.names == ("damping",)
    damping = found.fitted[0].values["damping", "rate"]
    assert damping == pytest.approx(DAMPING_1_PER_S, rel=0.01)
    assert found.fitted[0].left == pytest.approx(1.0, abs=0.05)
    assert system.part > system.whole


def test_what_comes_after_the_opening_is_found_in_the_whole() -> None:
    found = search(LetGoLong("long", high=HIGH))
    assert found.fitted[0].hypothesis.names == ("step",)
    assert found.fitted[0].values["step", "high"] == pytest.approx(HIGH, rel=0.02)


def test_where_parameters_alone_explain_the_opening_they_begin_the_whole() -> None:
    system = LetGoLong("long")
    opening = opening_of(system)
    assert opening is not None
    told = search(opening)
    start = from_opening(system, told.fitted)
    assert start is not None
    assert not start.hypotheses
    assert start.nuisance[0] == pytest.approx(2.0, abs=0.05)
    assert from_opening(system, ()) is None
