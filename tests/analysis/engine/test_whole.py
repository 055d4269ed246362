"""Two channels that may be plugged into each other's place, and gains that hide it."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.all_samples import cost_of
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.faint import faint
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, Prediction
from analysis.engine.whole import whole_beside, whole_guesses, whole_onward

T_S = np.arange(0.0, 10.0, 0.01)
NOISE = 0.02
KNOWN, LOOSE = 0.01, 0.1
"""How well the gain of either channel is known, as shares."""

TONES = np.column_stack([np.sin(2.0 * np.pi * T_S)] * 2)
LATE = np.column_stack([(T_S > 9.5) * 0.06, 0.0 * T_S])
"""A glitch that straight lines tell all of."""


def there_or_not(name: str) -> Candidate:
    form = Shape("form", "1", 0.0, 0.0, 1.0, (0.0, 1.0), logarithmic=False, whole=True)
    return Candidate(name, name, "cell", (Term("on", "on", "1", "", 0.0, 1.0, 1.0),), (form,),
                     fixed=True)  # fmt: skip


SLOW = np.column_stack([T_S / T_S[-1]] * 2)
DRIFTS = Candidate("slow", "slow", "cell", (Term("size", "size", "V", "", -1.0, 1.0, 0.1),))


class Channels:
    """Two that see one tone, each with its gain."""

    name = "channels"
    nuisances = (Nuisance("gain 1", KNOWN, "1"), Nuisance("gain 2", LOOSE, "1"))
    candidates = (there_or_not("swapped"), there_or_not("glitch"), DRIFTS)
    glitch = LATE

    def __init__(self, value: Array) -> None:
        noisy = value + NOISE * np.random.default_rng(7).standard_normal(value.shape)
        segments = (Segment(0.0, 10.0, None, 20.0),)
        self.bundles = (
            Bundle(("a", "b"), ("V", "V"), T_S, noisy, np.eye(2) * NOISE**2, segments,
                   tones_hz=(1.0,)),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._seen(one)]) for one in points]

    def _seen(self, point: Point) -> Array:
        seen = TONES * (1.0 + point.nuisance * [KNOWN, LOOSE])
        swapped, glitch = point.effects.get("swapped"), point.effects.get("glitch")
        if swapped is not None and swapped.shapes["form"]:
            seen = seen[:, ::-1]
        slow = point.effects.get("slow")
        if slow is not None:
            seen = seen + slow.values["size"] * SLOW
        return np.asarray(
            seen + self.glitch if glitch is not None and glitch.shapes["form"] else seen
        )


def guessed(value: Array) -> list[tuple[tuple[str, ...], float, Array]]:
    system = Channels(value)
    refiner = Refiner(system, *look(system))
    nothing = follow_ring(system, np.zeros(2), everything=True, near=True)
    assert nothing.to_end
    found = faint(system, replace(nothing, about=None), system.candidates)
    return [
        (one.hypothesis.names, one.hypothesis.parts[one.hypothesis.names[0]].shapes["form"],
         one.nuisance)
        for one in whole_guesses(system, refiner.candidates, found)
    ]  # fmt: skip


def test_swapped_channels_are_led_out_of_the_gains_that_hid_it() -> None:
    """Told apart by what is known of the gains alone: 0.5 % and 20 % where 1 % and 10 % are."""
    truly = TONES * [1.2, 1.005]
    ((names, form, nuisance),) = guessed(truly)
    assert (names, form) == (("swapped",), 1.0)
    assert nuisance == pytest.approx([0.5, 2.0], abs=0.3)


def test_channels_in_their_own_place_are_not_guessed_to_be_swapped() -> None:
    assert guessed(TONES * [1.005, 1.2]) == []


@pytest.mark.parametrize("swapped", [True, False])
def test_beside_what_is_on_they_are_led_out_of_the_gains_as_well(swapped: bool) -> None:
    truly = TONES * ([1.2, 1.005] if swapped else [1.005, 1.2])
    system = Channels(truly + 0.3 * SLOW)
    known = {one.name: one for one in system.candidates}
    state = State.at(Hypothesis({"slow": Part(("size",))}), {("slow", "size"): 0.3}, known)
    on = follow_ring(system, np.zeros(2), state, everything=True, near=True)
    found = faint(system, replace(on, about=None), [known["swapped"], known["glitch"]])
    led = list(whole_beside(system, known, found))
    closer = [one for one in led if cost_of(one) < cost_of(on) - 10.0]
    if not swapped:
        assert closer == []
        return
    (one,) = closer
    assert one.names == ("slow", "swapped")
    assert one.nuisance == pytest.approx([0.5, 2.0], abs=0.3)


def test_what_does_as_straight_lines_say_is_not_led() -> None:
    assert guessed(TONES + LATE) == []


class Breaking(Channels):
    """One of them is off from 6 s on."""

    glitch = np.column_stack([(T_S > 6.0) * 1.0, 0.0 * T_S])


@pytest.mark.parametrize(
    ("truly", "reached", "told"),
    [
        (TONES + Breaking.glitch, 0.5, ["glitch"]),
        (TONES + Breaking.glitch, 0.2, []),
        (TONES + Breaking.glitch, 0.0, []),
        (TONES, 0.5, []),
    ],
    ids=["begins then", "begins later", "nothing is foretold", "nothing begins"],
)
def test_what_is_there_as_a_whole_from_then_on_is_looked_for_where_parameters_foretell_no_more(
    truly: Array, reached: float, told: list[str]
) -> None:
    system = Breaking(truly)
    known = {one.name: one for one in system.candidates}
    nothing = Followed(np.zeros(2), None, share=reached, costs={reached: 100.0})
    guesses = whole_onward(system, known, nothing)
    assert [name for one in guesses for name in one.hypothesis.names] == told
    assert all(one.log_score > 1000.0 for one in guesses)
