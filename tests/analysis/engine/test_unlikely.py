"""What is seldom meant is said: a dead channel, another unit, rounding; and nothing else is."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.unlikely import elsewhere, missing_of, rounded, unknown_kin, unlikely
from tests.analysis.engine.test_check import Line

T_S = np.arange(0.0, 10.0, 0.05)
NOISE = 0.01
MOTION = np.sin(T_S)
DRAWN = np.random.default_rng(4).normal(0.0, NOISE, len(T_S))


def said(recorded: Array, simulated: Array, segment: Segment | None = None) -> tuple[str, ...]:
    segments = (segment or Segment(0.0, 10.0),)
    covariance = np.array([[NOISE**2]])
    bundle = Bundle(("x",), ("V",), T_S, recorded[:, None], covariance, segments)
    return unlikely((bundle,), [simulated[:, None]])


@pytest.mark.parametrize("times", [1.0, 20.0, 0.1])
def test_nothing_is_said_of_what_may_be_left_out(times: float) -> None:
    assert said(times * MOTION + DRAWN, MOTION) == ()


def test_nothing_is_said_where_nothing_is_simulated_to_move() -> None:
    assert said(MOTION + DRAWN, np.zeros(len(T_S))) == ()
    assert said(DRAWN, np.zeros(len(T_S))) == ()
    assert said(MOTION + DRAWN, 1e-14 * MOTION) == (), "rounding"


@pytest.mark.parametrize("value", [0.0, 3.2])
def test_a_dead_channel_is_said(value: float) -> None:
    (one,) = said(np.full(len(T_S), value), MOTION)
    assert f"'x' is {value:g} V in all of 200 samples" in one


def test_a_channel_that_dies_outside_of_what_is_looked_at_is_none() -> None:
    recorded = np.where(T_S < 8.0, MOTION + DRAWN, 0.0)
    assert said(recorded, MOTION, Segment(0.0, 8.0)) == ()


@pytest.mark.parametrize("times", [1000.0, 0.001])
def test_another_unit_is_said(times: float) -> None:
    (one,) = said(times * (MOTION + DRAWN), MOTION)
    assert "as recorded" in one
    assert "as simulated" in one


def test_a_simulator_that_rounds_is_told_to_leave_that() -> None:
    assert "in steps of 0.01 V" in told_of_rounding(2)[0]
    assert told_of_rounding(4) == (), "far below the noise"
    assert told_of_rounding(12) == ()


def told_of_rounding(places: int) -> tuple[str, ...]:
    covariance = np.array([[NOISE**2]])
    whole = (Segment(0.0, 10.0),)
    bundle = Bundle(("x",), ("V",), T_S, (MOTION + DRAWN)[:, None], covariance, whole)
    # One of them is round by its nature.
    points = [T_S, 1.03 * T_S + 0.2 * MOTION]
    return rounded((bundle,), [[np.round(one, places)[:, None]] for one in points])


def test_what_is_far_smaller_than_a_step_was_not_rounded_to_it() -> None:
    covariance = np.array([[1e-14]])
    bundle = Bundle(("x",), ("m",), T_S, 1e-5 * MOTION[:, None], covariance, (Segment(0.0, 10.0),))
    assert rounded((bundle,), [[1e-5 * MOTION[:, None]]]) == ()


def test_a_bundle_that_is_not_looked_at_says_nothing() -> None:
    covariance = np.array([[NOISE**2]])
    bundle = Bundle(("x",), ("V",), T_S, np.zeros((len(T_S), 1)), covariance, ())
    assert unlikely((bundle,), [MOTION[:, None]]) == ()
    assert rounded((bundle,), [[MOTION[:, None]]]) == ()


def test_another_zero_is_said() -> None:
    covariance = np.array([[NOISE**2]])
    for off, many in ((273.15, 1), (5.0, 0)):
        recorded = (MOTION + DRAWN + off)[:, None]
        whole = (Segment(0.0, 10.0),)
        bundle = Bundle(("x",), ("degC",), T_S, recorded, covariance, whole)
        found = elsewhere((bundle,), [MOTION[:, None]])
        assert len(found) == many
        assert all("'x' is +273 degC from what is simulated" in one for one in found)


def test_an_empty_list_and_a_stretch_that_holds_nothing_out_are_said() -> None:
    system = Line()
    assert missing_of(system) == ()
    system.candidates = ()
    (bundle,) = system.bundles
    beyond = Segment(2e4, 3e4, held_out=True, name="last")
    system.bundles = (replace(bundle, segments=(*bundle.segments, beyond)),)
    empty, nothing = missing_of(system)
    assert "the list of candidates is empty" in empty
    assert "nothing is held out: segment 'last', from 20000 to 30000 s" in nothing


def test_a_name_in_akin_that_is_none_in_the_list_is_said() -> None:
    bend, ripple = Line.candidates
    assert unknown_kin((replace(bend, akin=("ripple",)), ripple)) == ()
    (one,) = unknown_kin((replace(bend, akin=("riple",)), ripple))
    assert "candidate 'bend': akin names 'riple'" in one
