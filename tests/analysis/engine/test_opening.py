"""A long recording of an oscillator: its first part leads, and the whole says what there is."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.opening import from_opening, opening_of
from analysis.engine.search import search
from analysis.engine.system import Point
from analysis.engine.until import Until
from tests.analysis.engine.test_ring_fit import SIGMA, LetGo, ring

DAMPING_1_PER_S, HIGH, MOMENT_S = 0.05, 0.3, 20.0

SPAN_S = {"long": 60.0, "short": 20.0}


class LetGoLong(LetGo):
    """Counts of how much of the recording it was simulated."""

    bundles: tuple[Bundle, ...]

    def __init__(self, span: str, damping_1_per_s: float = 0.0, high: float = 0.0) -> None:
        t_s = np.arange(0.0, SPAN_S[span], 0.02)
        super().__init__(ring(2.0 * SIGMA, damping_1_per_s, high, MOMENT_S, t_s), t_s=t_s)
        self.whole, self.part = 0, 0

    def _one(self, point: Point) -> Array:
        whole = point.upto == 1.0
        self.whole, self.part = self.whole + whole, self.part + (not whole)
        return super()._one(point)


def test_only_a_long_recording_has_an_opening() -> None:
    assert opening_of(LetGoLong("short")) is None
    opening = opening_of(LetGoLong("long"))
    assert opening is not None
    # Seventy turns of the tone, from when it was let go.
    assert opening.end_s == pytest.approx(14.0, abs=0.1)
    assert opening_of(opening) is None


def test_what_repeats_slowly_needs_a_longer_opening() -> None:
    system = LetGoLong("long")
    system.bundles = (replace(system.bundles[0], segments=(Segment(2.0, 60.0, 0.8),)),)
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
