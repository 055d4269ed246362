"""What explains to the noise in some places is asked in all places alike, and its kin there too."""

from collections.abc import Sequence

import numpy as np
import pytest

from analysis.engine import Candidate, Point, Term
from analysis.engine.all_samples import all_samples_say
from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from tests.analysis.one_ring import T_S, ZERO, OneRing

PLACES = "1234"
FAINT = 0.03
"""So that two of four places explain all but a little more than noise."""

OFF = {"loss": 0.0, "kindred": 0.008}
"""How far each law is from the first."""


def law(name: str) -> Candidate:
    terms = tuple(Term(f"size@{p}", "size", "N", p, 0.0, 5.0, 0.3) for p in PLACES)
    return Candidate(name, name, "plant", terms, family="losses", form_share=0.05)


KNOWN = {name: law(name) for name in OFF}


class Summed(OneRing):
    """A ring with a loss that is the sum of what its places lose: one channel tells no place."""

    name = "summed"
    candidates: Sequence[Candidate] = tuple(KNOWN.values())

    def __init__(self) -> None:
        alike = {f"size@{p}": 0.25 for p in PLACES}
        super().__init__(State.at(part("loss", alike, True), of("loss", alike), KNOWN).point(ZERO))

    def added(self, point: Point) -> Array | float:
        """The losses."""
        found: Array | float = 0.0
        for name, on in point.effects.items():
            loss = np.sin(2.0 * np.pi * 0.7 * T_S) + OFF[name] * np.cos(2.0 * np.pi * 2.1 * T_S)
            found = found + sum(on.values.values()) * loss
        return found


def part(name: str, sizes: dict[str, float], shared: bool) -> Hypothesis:
    return Hypothesis({name: Part(tuple(sizes), shared)})


def of(name: str, sizes: dict[str, float]) -> dict[tuple[str, str], float]:
    return {(name, term): size for term, size in sizes.items()}


def test_a_law_in_all_places_alike_is_found_from_its_kin_in_some() -> None:
    system = Summed()
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    search = FollowedSearch(refiner, follow_ring(system, ZERO, everything=True), 2)
    some = {"size@2": 0.5, "size@3": 0.4}
    state = State.at(part("kindred", some, False), of("kindred", some), KNOWN)
    search.follow([Guess(state, ZERO)], [])
    found = search.fitted()
    assert found is not None
    best = found[0]
    assert best.hypothesis.names == ("loss",)
    assert best.hypothesis.parts["loss"].shared
    assert set(best.hypothesis.parts["loss"].terms) == {f"size@{p}" for p in PLACES}
    assert abs(best.values["loss", "size@1"] - 0.25) < 0.02


class Apart(Summed):
    """The same, where each place is seen by a faint tone of its own."""

    name = "apart"

    def added(self, point: Point) -> Array | float:
        """The losses."""
        found: Array | float = 0.0
        for on in point.effects.values():
            for term, size in on.values.items():
                hertz = 0.5 + 0.2 * PLACES.index(term.removeprefix("size@"))
                found = found + FAINT * size * np.sin(2.0 * np.pi * hertz * T_S)
        return found


class NothingBeside(FollowedSearch):
    """Looks no farther than what it was given."""

    def _lead_beside(self) -> None:
        """Not asked."""


def test_near_the_phase_what_leaves_more_than_noise_is_led_in_all_places_alike() -> None:
    system = Apart()
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    nothing = follow_ring(system, ZERO, everything=True)
    search = NothingBeside(refiner, nothing, 2, near=True)
    some = {"size@2": 0.25, "size@3": 0.25}
    guess = Guess(State.at(part("loss", some, True), of("loss", some), KNOWN), ZERO)
    search.follow([guess], [guess])
    found = search.fitted()
    assert found is not None
    assert set(found[0].hypothesis.parts["loss"].terms) == {f"size@{p}" for p in PLACES}
    assert found[0].values["loss", "size@1"] == pytest.approx(0.25, abs=0.02)


def test_one_cause_of_two_is_made_alike_and_the_other_stays() -> None:
    some, one = {"size@2": 0.4, "size@3": 0.4}, {"size@1": 0.3}
    both = Hypothesis({"kindred": Part(tuple(some)), "loss": Part(tuple(one))})
    state = State.at(both, of("kindred", some) | of("loss", one), KNOWN)
    parts = state.alike("kindred").hypothesis.parts
    assert parts["kindred"].shared
    assert len(parts["kindred"].terms) == len(PLACES)
    assert parts["loss"] == both.parts["loss"]
    assert state.alike("kindred").alike("kindred").hypothesis.parts == parts


def test_places_that_are_about_as_likely_are_told_beside_the_likeliest() -> None:
    """One channel tells the sum: four places alike, or one, with as much; not with far less."""
    system = Summed()
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    alike = {f"size@{p}": 0.25 for p in PLACES}

    def led(sizes: dict[str, float], misfit: float) -> Followed:
        state = State.at(part("loss", sizes, True), of("loss", sizes), KNOWN)
        return Followed(ZERO, state, misfit=misfit)

    ends = [led(alike, 1000.0), led({"size@2": 1.0}, 999.0), led({"size@3": 0.3}, 1200.0)]
    nothing = Followed(ZERO, None, misfit=90000.0)
    first, *_ = all_samples_say(refiner, ends, nothing, len(T_S))
    told = {frozenset(first.hypothesis.parts["loss"].terms)}
    told |= {frozenset(one["loss"]) for one in first.elsewhere}
    assert told == {frozenset(alike), frozenset({"size@2"})}
    assert all(sum(one["loss"].values()) == pytest.approx(1.0) for one in first.elsewhere)
