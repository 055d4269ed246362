"""What is left, where it is not the noise that is stated, is said; and nothing else is."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine import Point
from analysis.engine.array import Array
from analysis.engine.leftover import leftover
from tests.analysis.engine.test_check import NOISE, T_S, Line

DRAWN = np.random.default_rng(3).normal(0.0, NOISE, len(T_S))


def said(noise: Array, *, explained: bool = True) -> tuple[str, ...]:
    """Of a line with such noise."""
    system = Line()
    (bundle,) = system.bundles
    system.bundles = (replace(bundle, value=(T_S + noise)[:, None]),)
    return leftover(system, Point(np.zeros(2)), explained=explained)


@pytest.mark.parametrize("times", [0.8, 1.0, 1.2])
def test_nothing_is_said_of_noise_about_as_stated(times: float) -> None:
    assert said(times * DRAWN) == ()


def test_noise_that_goes_on_from_sample_to_sample_is_told_as_such() -> None:
    slow = np.zeros_like(DRAWN)
    for i in range(1, len(T_S)):
        slow[i] = 0.9 * slow[i - 1] + np.sqrt(1.0 - 0.81) * DRAWN[i]
    (one,) = said(slow)
    assert one.startswith("the noise of 'x' is not white")
    assert said(slow, explained=False) == ()


def test_noise_that_is_stated_too_large_is_said() -> None:
    (one,) = said(0.3 * DRAWN)
    assert one.startswith("what is left of 'x' is 0.3")


@pytest.mark.parametrize("explained", [True, False])
def test_samples_that_are_far_off_by_themselves_are_said(explained: bool) -> None:
    noise = DRAWN.copy()
    noise[[50, 120]] += 30.0 * NOISE
    (one,) = said(noise, explained=explained)
    assert one.startswith("2 of 200 samples of 'x' are far off by themselves, first that at 5 s")


def test_what_is_left_out_is_no_outlier() -> None:
    assert said(DRAWN + 30.0 * NOISE * np.sin(T_S), explained=False) == ()
    assert said(DRAWN + 30.0 * NOISE * (T_S > 10.0), explained=False) == ()
