"""What else explains about as well what a cause does."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine import exchange, rival_leader
from analysis.engine.all_samples import cost_of
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.exchange import Exchange, exchanged, fresh, plainest, rivals
from analysis.engine.faint import Faint, faint
from analysis.engine.faint_search import kin_beside, others_beside
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, Prediction

TIMES_S = np.arange(0.0, 1.0, 0.005)
NOISE = 0.1


def tone(hertz: float) -> Array:
    """Shape (n,)."""
    return np.asarray(np.sin(2.0 * np.pi * hertz * TIMES_S))


LEVEL, THERE, ELSE = tone(1.0), tone(3.0), tone(8.0)


def cause(name: str, *shapes: Shape, fixed: bool = False) -> Candidate:
    term = Term("size", "size", "V", "", -9.0, 9.0, 1.0)
    return Candidate(name, name, "cell", (term,), shapes, form_share=0.01, fixed=fixed)


BENT, TRUE, OTHER = cause("bent"), cause("true"), cause("other")
DOUBLE = cause("double")
NEAR, RAISED = cause("near"), cause("raised")
DOES = {
    "bent": THERE + LEVEL,
    "true": THERE,
    "other": ELSE,
    "double": 2.0 * THERE,
    "near": THERE + 0.03 * ELSE,
    "raised": LEVEL,
}
WHICH = cause("which", Shape("way", "1", 0.0, 0.0, 1.0, (0.0, 1.0), False, True), fixed=True)


class _Straight:
    """One cause was there; another can be it where a parameter is bent."""

    name = "straight"
    nuisances = (Nuisance("level", 0.05, "V"),)

    def __init__(self, *candidates: Candidate, raised: float = 0.0) -> None:
        self.candidates = candidates
        noise = NOISE * np.random.default_rng(5).normal(size=len(TIMES_S))
        seen = (THERE + raised * LEVEL + noise)[:, None]
        whole = (Segment(0.0, 1.0, None, 20.0),)
        self.bundles = (Bundle(("y",), ("V",), TIMES_S, seen, np.eye(1) * NOISE**2, whole),)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._seen(one)[:, None]]) for one in points]

    def _seen(self, point: Point) -> Array:
        seen = 0.05 * point.nuisance[0] * LEVEL
        for name, setting in point.effects.items():
            size = setting.values.get("size", 0.0)
            if name == "which":
                seen = seen + (size > 0.0) * (THERE if setting.shapes["way"] else ELSE)
            else:
                seen = seen + size * DOES[name]
        return np.asarray(seen)

    @property
    def bent(self) -> Followed:
        """Led to the end: what is on explains, with the parameter at twenty sigmas."""
        known = {one.name: one for one in self.candidates}
        state = State.at(Hypothesis({"bent": Part(("size",))}), {("bent", "size"): 1.0}, known)
        cost = float(len(TIMES_S)) + 400.0
        return Followed(np.array([-20.0]), state, misfit=cost - 400.0, costs={1.0: cost})


def test_what_needs_no_parameter_bent_is_promised_in_the_place_of_what_does() -> None:
    system = _Straight(BENT, TRUE, OTHER)
    known = {one.name: one for one in system.candidates}
    found = faint(system, system.bent, [TRUE, OTHER])
    ((ahead, one),) = exchanged(found, known)
    assert ahead > 0.0
    assert one.hypothesis.names == ("true",)
    assert one.values["true", "size"] == pytest.approx(1.0, abs=0.05)


def test_it_is_led_from_there_and_costs_as_much_less_as_the_parameter_did() -> None:
    system = _Straight(BENT, TRUE, OTHER)
    known = {one.name: one for one in system.candidates}
    found = faint(system, system.bent, [TRUE, OTHER])
    promised = exchanged(found, known)
    (led,) = rivals(system, found, known, fresh(promised, [system.bent]))
    assert led.names == ("true",)
    assert cost_of(led) < cost_of(system.bent) - 350.0
    assert fresh(promised, [system.bent, led]) == [], "it was led"


def test_one_that_straight_lines_lose_is_led_once_more_as_strong_as_the_cause_was(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A parameter takes a part of what a rival does: about the cause itself that part is missed."""
    system = _Straight(BENT, DOUBLE)
    known = {one.name: one for one in system.candidates}
    begun: list[tuple[float, float]] = []

    def lost(
        _: object, law: Followed, state: State, nuisance: Array, *, again: bool = False
    ) -> Followed:
        begun.append((state.term_values()["double", "size"], float(nuisance[0])))
        return replace(law, state=state, left=100.0, misfit=1e6)

    monkeypatch.setattr(exchange, "lead_from", lost)
    found = faint(system, system.bent, [DOUBLE])
    list(rivals(system, found, known, fresh(exchanged(found, known), [system.bent])))
    (promised, moved), (as_strong, stays) = begun
    assert promised == pytest.approx(0.5, abs=0.03)
    assert moved == pytest.approx(0.0, abs=2.0)
    assert as_strong == pytest.approx(0.75, rel=0.1), "the level that the parameter stands for too"
    assert stays == system.bent.nuisance[0]


def test_what_is_there_or_not_is_asked_as_a_whole_in_each_of_its_ways() -> None:
    system = _Straight(BENT, WHICH)
    known = {one.name: one for one in system.candidates}
    found = faint(system, system.bent, [WHICH])
    ((_, one),) = exchanged(found, known)
    assert one.hypothesis.parts["which"].shapes == {"way": 1.0}
    assert one.values["which", "size"] == 1.0


@pytest.mark.parametrize("more", [True, False])
def test_rivals_of_what_explains_to_the_noise_wait_for_one_cause_more(
    monkeypatch: pytest.MonkeyPatch, more: bool
) -> None:
    """A second cause that a parameter stands for is led first; without one, rivals are."""
    system = _Straight(TRUE, NEAR, RAISED, raised=1.0 if more else 0.0)
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    order: list[tuple[str, ...]] = []

    def asked(_: object, found: Faint, *__: object) -> Iterator[Followed]:
        order.append(found.followed.names)
        return iter(())

    monkeypatch.setattr(rival_leader, "rivals", asked)
    nothing = replace(follow_ring(system, np.zeros(1), everything=True), lends=None)
    search = FollowedSearch(refiner, nothing, 2)
    known = {one.name: one for one in system.candidates}
    state = State.at(Hypothesis({"true": Part(("size",))}), {("true", "size"): 1.0}, known)
    search.follow([Guess(state, np.zeros(1))], [])
    found = search.fitted()
    assert found is not None
    assert found[0].hypothesis.names == (("raised", "true") if more else ("true",))
    assert order[0] == found[0].hypothesis.names


@pytest.mark.parametrize("close", [True, False])
def test_rivals_that_waited_are_led_where_they_promise_to_come_close(
    monkeypatch: pytest.MonkeyPatch, close: bool
) -> None:
    """One cause more may have come far beside a wrong law."""
    system = _Straight(TRUE, NEAR, RAISED, raised=1.0)
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    asked: list[tuple[str, ...]] = []

    def led(
        _: object, found: Faint, __: object, promised: Sequence[Exchange]
    ) -> Iterator[Followed]:
        asked.extend(one.scored.hypothesis.names for one in promised)
        return iter(())

    monkeypatch.setattr(rival_leader, "rivals", led)
    monkeypatch.setattr(rival_leader, "CLOSE", 1e4 if close else 0.0)
    nothing = replace(follow_ring(system, np.zeros(1), everything=True), lends=None)
    search = FollowedSearch(refiner, nothing, 2)
    known = {one.name: one for one in system.candidates}
    state = State.at(Hypothesis({"near": Part(("size",))}), {("near", "size"): 1.0}, known)
    search.follow([Guess(state, np.zeros(1))], [])
    assert (("true",) in asked) == close


def test_a_second_law_of_one_thing_is_asked_in_the_place_of_another_second_cause() -> None:
    """Not in the place of its own kin, which is led from where that came."""
    losses = (replace(one, family="loss") for one in (OTHER, TRUE, BENT))
    system = _Straight(*losses, RAISED)
    known = {one.name: one for one in system.candidates}
    hypothesis = Hypothesis({"other": Part(("size",)), "raised": Part(("size",))})
    state = State.at(hypothesis, {("other", "size"): 0.1, ("raised", "size"): 1.0}, known)
    led = Followed(np.zeros(1), state, misfit=200.0, costs={1.0: 200.0})
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    kin = kin_beside(refiner, led)
    assert {one.name for one in kin} == {"true", "bent"}
    assert not {one.name for one in others_beside(refiner, led)} & {"true", "bent"}
    promised = exchanged(faint(system, led, kin), known)
    for one in promised:
        assert "other" in one.scored.hypothesis.names, "its kin stands in no place of it"
    assert ("bent", "other") in {one.scored.hypothesis.names for one in promised}


def test_of_what_comes_as_far_the_fewest_causes_are_asked() -> None:
    system = _Straight(BENT, TRUE, WHICH)
    known = {one.name: one for one in system.candidates}

    def led(cost: float, *names: str) -> Followed:
        parts = {name: Part(("size",)) for name in names}
        values = {(name, "size"): 1.0 for name in names}
        state = State.at(Hypothesis(parts), values, known)
        return Followed(np.zeros(1), state, misfit=cost, costs={1.0: cost})

    both, one, far = led(100.0, "bent", "true"), led(120.0, "true"), led(500.0, "bent")
    assert plainest([both, one, far], 130.0, known) is one
    assert plainest([both, led(120.0, "which")], 130.0, known) is None, "nothing to exchange"


def two(name: str) -> Candidate:
    """Acts at two places, of its own size at each."""
    terms = tuple(Term(f"size@{k}", "size", "V", k, -9.0, 9.0, 1.0) for k in "ab")
    return Candidate(name, name, "cell", terms, form_share=0.01)


class _AtTwo(_Straight):
    """Two causes that do the same at two places; a parameter does what each does at the second."""

    def _seen(self, point: Point) -> Array:
        seen = 0.05 * point.nuisance[0] * ELSE
        for setting in point.effects.values():
            seen = seen + setting.values.get("size@a", 0.0) * THERE
            seen = seen + setting.values.get("size@b", 0.0) * ELSE
        return np.asarray(seen)


def test_a_rival_in_few_places_that_bends_parameters_is_led_in_all_of_the_causes_places() -> None:
    system = _AtTwo(two("law"), two("rival"))
    (bundle,) = system.bundles
    system.bundles = (replace(bundle, value=bundle.value + ELSE[:, None]),)
    known = {one.name: one for one in system.candidates}
    both = Hypothesis({"law": Part(("size@a", "size@b"))})
    law = State.at(both, {("law", "size@a"): 1.0, ("law", "size@b"): 1.0}, known)
    end = follow_ring(system, np.zeros(1), law, everything=True)
    found = faint(system, end, [known["rival"]])
    few = Hypothesis({"rival": Part(("size@a",))})
    (promised,) = exchanged(found, known)
    at_one = replace(promised.scored, hypothesis=few, values={("rival", "size@a"): 1.0})
    (led,) = rivals(system, found, known, [Exchange(promised.ahead, at_one)])
    assert led.state is not None
    assert led.state.term_values() == pytest.approx(
        {("rival", "size@a"): 1.0, ("rival", "size@b"): 1.0}, abs=0.1
    )
    assert cost_of(led) < cost_of(end) + 10.0


class _AsOne(_AtTwo):
    """And a third that acts at both places alike."""

    def _seen(self, point: Point) -> Array:
        both = sum(one.values.get("size", 0.0) for one in point.effects.values())
        return np.asarray(super()._seen(point) + both * (THERE + ELSE))


def test_a_rival_in_few_places_of_a_cause_that_has_none_is_led_in_all_of_its_own_too() -> None:
    system = _AsOne(cause("law"), two("rival"))
    (bundle,) = system.bundles
    system.bundles = (replace(bundle, value=bundle.value + ELSE[:, None]),)
    known = {one.name: one for one in system.candidates}
    law = State.at(Hypothesis({"law": Part(("size",))}), {("law", "size"): 1.0}, known)
    end = follow_ring(system, np.zeros(1), law, everything=True)
    found = faint(system, end, [known["rival"]])
    few = Hypothesis({"rival": Part(("size@a",))})
    (promised,) = exchanged(found, known)
    at_one = replace(promised.scored, hypothesis=few, values={("rival", "size@a"): 1.0})
    in_few, in_all = rivals(system, found, known, [Exchange(promised.ahead, at_one)])
    assert cost_of(in_few) > cost_of(end) + 100.0, "a parameter makes up for the other place"
    assert in_all.state is not None
    assert in_all.state.term_values() == pytest.approx(
        {("rival", "size@a"): 1.0, ("rival", "size@b"): 1.0}, abs=0.1
    )
    assert cost_of(in_all) < cost_of(end) + 10.0
