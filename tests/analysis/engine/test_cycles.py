"""A faint tone that is a turn out of phase at the end: the valley beside the lowest."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate
from analysis.engine.cycles import TURNS_RAD, information_of, valley
from analysis.engine.followed import Followed
from analysis.engine.part import Part
from analysis.engine.ring_fit import follow_ring
from analysis.engine.system import Nuisance, Point, Prediction, Ringing

TONE_HZ, SHARE, SECONDS, NOISE = 5.0, 0.02, 20.0, 0.02
T_S = np.arange(0.0, SECONDS, 0.02)
RAD = 2.0 * np.pi * TONE_HZ * SHARE * SECONDS
"""By how much one sigma of the tone turns it until the end."""

TRUTH = 0.4


class Sings:
    """A tone that never dies, known to a share, and a zero."""

    name = "sings"
    nuisances: Sequence[Nuisance] = (Nuisance("tone", SHARE, "1"), Nuisance("zero", 1.0, "V"))
    candidates: Sequence[Candidate] = ()

    def __init__(self, energy: float) -> None:
        self.height = float(np.sqrt(2.0 * energy * NOISE**2 / len(T_S)))
        self.simulated = 0
        truth = self._one(np.array([TRUTH, 0.3]))
        noisy = truth + NOISE * np.random.default_rng(2).standard_normal(truth.shape)
        self.bundles = (
            Bundle(
                ("y",), ("V",), T_S, noisy, np.eye(1) * NOISE**2,
                (Segment(0.0, SECONDS, None, 20.0),), record="only", tones_hz=(TONE_HZ,),
            ),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        self.simulated += len(points)
        return [reduce([self._one(point.nuisance)]) for point in points]

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return np.array([TONE_HZ * (1.0 + SHARE * float(point.nuisance[0]))])

    def _one(self, nuisance: Array) -> Array:
        turn = 2.0 * np.pi * TONE_HZ * (1.0 + SHARE * nuisance[0])
        return np.asarray(self.height * np.cos(turn * T_S) + nuisance[1])[:, None]


class Silent:
    """The same, and nobody knows how its numbers move its tone."""

    def __init__(self, system: Sings) -> None:
        self.name, self.bundles = system.name, system.bundles
        self.nuisances, self.candidates = system.nuisances, system.candidates
        self.simulate = system.simulate


def led_from(system: Any, turns_rad: float) -> Followed:
    start = np.array([TRUTH + turns_rad / RAD, 0.3])
    return follow_ring(system, start, everything=True, near=True)


@pytest.mark.parametrize("turn_rad", [one * sign for one in TURNS_RAD for sign in (1, -1)])
def test_a_faint_tone_is_led_back_over_the_ridge(turn_rad: float) -> None:
    system = Sings(energy=200.0)
    beside = led_from(system, turn_rad)
    assert beside.nuisance[0] * RAD == pytest.approx(TRUTH * RAD + turn_rad, abs=1.0)
    found = valley(system, beside).led
    assert found.nuisance[0] == pytest.approx(TRUTH, abs=0.02)
    assert found.misfit < beside.misfit - 100.0


def test_what_is_in_the_lowest_valley_stays_there() -> None:
    system = Sings(energy=200.0)
    led = led_from(system, 0.0)
    assert valley(system, led).led.nuisance == pytest.approx(led.nuisance)


def test_a_tone_that_may_be_a_turn_off_as_well_is_not_told() -> None:
    faint, clear = Sings(energy=40.0), Sings(energy=4000.0)
    for system, told in ((faint, False), (clear, True)):
        led = led_from(system, 0.0)
        sigmas = 1.0 / np.sqrt(np.diag(valley(system, led).information))
        as_narrow = 1.0 / np.sqrt(np.diag(information_of(system, led)))
        assert as_narrow[0] * RAD < 0.5
        if told:
            assert sigmas == pytest.approx(as_narrow)
        else:
            # Prior and recording together know it to ten rad.
            assert sigmas[0] * RAD > 9.0
            assert sigmas[1] == pytest.approx(as_narrow[1], rel=0.1)


def test_the_tone_is_asked_of_the_system_and_of_its_parts_where_they_know_it() -> None:
    system = Sings(energy=200.0)
    point = Point(np.array([1.0, 0.0]))
    assert isinstance(system, Ringing)
    assert Part(system, ("only",)).tones_hz(point) == pytest.approx(TONE_HZ * (1.0 + SHARE))
    assert Part(Silent(system), ("only",)).tones_hz(point).shape == (0,)


def test_where_nobody_knows_the_tone_the_valley_is_the_one_it_was_led_to() -> None:
    system = Silent(Sings(energy=200.0))
    beside = led_from(system, TURNS_RAD[0])
    for silent in (system, Part(system, ("only",))):
        assert valley(silent, beside).led is beside
