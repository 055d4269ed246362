"""Noise as samples have it, where that is not what is stated."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine import diagnose
from analysis.engine.array import Array
from analysis.engine.louder import Louder, louder_than_stated
from analysis.engine.system import Point
from tests.analysis.engine.test_ring_fit import SIGMA, T_S, LetGo, ring

NOTHING = Point(np.zeros(1), {}, "as_is")
NOISE = 0.02


def _stated(times: float, left: Array | float = 0.0, known_from: int = 0) -> LetGo:
    """Samples of which the noise is so many times what is stated, in sigma."""
    system = LetGo(ring(0.0, 0.0, 0.0, 0.0) + left, noise=NOISE)
    (bundle,) = system.bundles
    covariance = bundle.covariance / times**2
    system.bundles = (replace(bundle, covariance=covariance, noise_from=known_from),)
    return system


def _told(system: LetGo) -> Louder:
    found = louder_than_stated(system, NOTHING)
    assert found is not None
    return found


@pytest.mark.parametrize("times", [1.2, 1.4])
def test_a_noise_that_is_too_small_is_told_by_differences(times: float) -> None:
    found = _told(_stated(times))
    assert found.times[0] == pytest.approx(times, rel=0.05)
    assert found.bundles[0].covariance[0, 0] == pytest.approx(NOISE**2, rel=0.1)
    assert f"is {found.times[0]:.2f} times" in found.note


@pytest.mark.parametrize("times", [1.0, 0.7, 3.0], ids=["right", "too large", "another world"])
def test_a_noise_is_as_it_is_stated_where_nothing_says_that_it_is_larger(times: float) -> None:
    assert louder_than_stated(_stated(times), NOTHING) is None


def test_what_is_left_out_is_no_noise_where_samples_are_close() -> None:
    slow = 3.0 * NOISE * np.sin(2.0 * np.pi * 1.3 * T_S)[:, None]
    assert louder_than_stated(_stated(1.0, slow), NOTHING) is None
    assert _told(_stated(1.2, slow)).times[0] == pytest.approx(1.2, rel=0.05)


def test_a_line_is_no_noise() -> None:
    fast = 1.5 * NOISE * np.sin(2.0 * np.pi * 10.0 * T_S)[:, None]
    assert louder_than_stated(_stated(1.0, fast), NOTHING) is None


@pytest.mark.parametrize("times", [1.2, 0.8])
def test_a_noise_from_few_samples_is_told_by_all_of_them(times: float) -> None:
    found = _told(_stated(times, known_from=200))
    assert found.times[0] == pytest.approx(times, rel=0.075)
    assert found.bundles[0].noise_from > 500
    assert louder_than_stated(_stated(1.04, known_from=60), NOTHING) is None, "it may well be"


def test_a_noise_that_is_too_small_is_nothing_left_out_and_said() -> None:
    found = diagnose(_stated(1.2))
    assert (found.verdict, found.judgement and found.judgement.causes) == ("none", ())
    assert any("the noise of samples is" in one for one in found.notes)


def test_where_it_is_told_is_where_parameters_alone_have_led() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0), noise=NOISE)
    assert diagnose(system).verdict == "none"


def test_what_explains_best_may_have_been_what_was_rough() -> None:
    system = _stated(1.0)
    assert Louder(system, [np.array([1.3**2])], [500]).beside(NOTHING) is system
    louder = _stated(1.2)
    assert _told(louder).beside(NOTHING) is None, "the same noise is left"
    less = Louder(louder, [np.array([1.5**2])], [500]).beside(NOTHING)
    assert isinstance(less, Louder)
    assert less.times[0] == pytest.approx(1.2, rel=0.05)
