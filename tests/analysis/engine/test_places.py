"""In which places a cause is, told at the end."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.all_samples import AS_LIKELY, all_samples_say
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.faint import faint
from analysis.engine.faint_search import ASKS, nuisances_of
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.look import look
from analysis.engine.places import as_likely_in, is_placed, placed_again
from analysis.engine.refine import Refiner
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, Prediction

TIMES_S = np.arange(0.0, 1.0, 0.005)
NOISE = 0.1
TONES = {
    place: np.sin(2.0 * np.pi * k * TIMES_S) for place, k in zip("abc", (1, 3, 8), strict=True)
}
THERE = 40.0
"""What is there does so many times the noise: its error of form alone may be more than noise."""

WIDTH = Shape("width", "1", 2.0, 0.5, 8.0, (1.0, 4.0))
EVERY = tuple(Term(f"size@{one}", "size", "V", one, 0.0, 90.0, 1.0) for one in TONES)
LAW = Candidate("law", "law", "plant", EVERY, (WIDTH,), form_share=0.12)
KNOWN = {"law": LAW}


class _Places:
    """A law is there in two places; a parameter can stand for one of them."""

    name = "places"
    nuisances = (Nuisance("b", 2.0, "V"),)
    candidates = (LAW,)

    def __init__(self, slight: float = 0.0) -> None:
        noise = NOISE * np.random.default_rng(5).normal(size=len(TIMES_S))
        there = THERE * (TONES["a"] + TONES["b"]) + slight * TONES["c"]
        seen = NOISE * there + noise
        whole = (Segment(0.0, 1.0, None, 20.0),)
        self.bundles = (
            Bundle(("y",), ("V",), TIMES_S, seen[:, None], np.eye(1) * NOISE**2, whole),
        )

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._seen(one)[:, None]]) for one in points]

    def _seen(self, point: Point) -> Array:
        seen = NOISE * 2.0 * point.nuisance[0] * TONES["b"]
        for setting in point.effects.values():
            for place, tone in TONES.items():
                seen = seen + NOISE * setting.values.get(f"size@{place}", 0.0) * tone
        return np.asarray(seen)


class _Loose(_Places):
    """The parameter is hardly known."""

    nuisances = (Nuisance("b", 200.0, "V"),)

    def _seen(self, point: Point) -> Array:
        return super()._seen(replace(point, nuisance=100.0 * point.nuisance))


def led(nuisance: float, places: str, *, shared: bool = True) -> Followed:
    """Led to the end, the law in these places."""
    terms = tuple(f"size@{one}" for one in places)
    on = Hypothesis({"law": Part(terms, shared and len(terms) > 1, {"width": 3.0})})
    state = State.at(on, {("law", one): THERE for one in terms}, KNOWN)
    misfit = float(len(TIMES_S))
    cost = misfit + nuisance**2
    return Followed(np.array([nuisance]), state, misfit=misfit, left=1.0, costs={1.0: cost})


def test_a_place_that_a_parameter_stood_for_is_found_at_the_end() -> None:
    system = _Places()
    wrong = led(THERE / 2.0, "a")
    found = faint(system, wrong, [LAW])
    ((ahead, one),) = placed_again(found, KNOWN)
    part = one.hypothesis.parts["law"]
    assert ahead > 100.0
    assert (part.terms, part.shared, part.shapes) == (("size@a", "size@b"), True, {"width": 3.0})
    assert one.values["law", "size@b"] == pytest.approx(THERE, rel=0.02)
    assert nuisances_of(found, one)[0] == pytest.approx(0.0, abs=0.5)


def test_what_an_error_of_form_may_be_is_no_other_place() -> None:
    system = _Places(slight=0.8)
    found = faint(system, led(0.0, "ab"), [LAW])
    ((_, one),) = placed_again(found, KNOWN)
    assert "size@c" in one.hypothesis.parts["law"].terms
    assert placed_again(found, KNOWN, noise=50.0) == []


def test_where_all_is_in_place_nothing_is_promised() -> None:
    system = _Places()
    assert placed_again(faint(system, led(0.0, "ab"), [LAW]), KNOWN) == []


def test_other_places_that_are_as_likely_are_told() -> None:
    # The parameter does what the law does in b: whether it is there as well, nothing tells.
    system = _Places()
    found = faint(system, led(0.0, "ab"), [LAW])
    assert as_likely_in(found, KNOWN, 1.0, AS_LIKELY) == []
    loose = faint(_Loose(), led(0.0, "ab"), [LAW])
    (other,) = as_likely_in(loose, KNOWN, 1.0, AS_LIKELY)
    assert set(other["law"]) == {"size@a"}
    assert other["law"]["size@a"] == pytest.approx(THERE, rel=0.02)


def test_what_needs_fewer_numbers_is_asked_for_however_little_it_promises() -> None:
    system = _Places()
    ((ahead, one),) = placed_again(faint(system, led(0.0, "ab", shared=False), [LAW]), KNOWN)
    part = one.hypothesis.parts["law"]
    assert 0.0 < ahead < ASKS
    assert (part.terms, part.shared) == (("size@a", "size@b"), True)


def test_what_is_on_alone_has_the_columns_of_all_its_places() -> None:
    system = _Places()
    found = faint(system, led(0.0, "ab"), [LAW])
    (columns,) = found.terms.values()
    norms = np.linalg.norm(columns, axis=0)
    assert norms == pytest.approx([np.linalg.norm(one) for one in TONES.values()], rel=0.02)


def test_of_one_set_of_causes_the_likeliest_counts_rather_than_the_closest() -> None:
    system = _Places()
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    alike, closer = led(0.0, "ab"), led(0.0, "abc", shared=False)
    closer = replace(closer, misfit=closer.misfit - 2.0)
    nothing = Followed(np.zeros(1), None, misfit=1e4)
    for both in ([alike, closer], [closer, alike]):
        first, _ = all_samples_say(refiner, both, nothing, len(TIMES_S))
        assert first.hypothesis.parts["law"].shared


@pytest.mark.parametrize("how", ["fixed", "together", "grows"])
def test_what_is_there_as_a_whole_is_in_no_places(how: str) -> None:
    assert is_placed(LAW)
    assert not is_placed(Candidate("whole", "whole", "plant", EVERY, **{how: True}))
