"""Another law of the same thing in the place of one that is on."""

import pytest

from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.kin import instead
from analysis.engine.state import State
from analysis.engine.system import Candidate, Shape, Term


def law(name: str, step: float, places: str, *shapes: Shape) -> Candidate:
    terms = tuple(Term(f"size@{p}", "size", "N", p, 0.0, 100.0, step) for p in places)
    return Candidate(name, name, "plant", terms, shapes, family="friction")


DRY = law("dry", 0.3, "123", Shape("way", "m", 5e-5, 1e-5, 2e-4))
CAPSTAN = law(
    "capstan", 0.02, "123", Shape("way", "m", 5e-5, 1e-4, 1e-3), Shape("ratio", "1", 1.4, 1.0, 3.0)
)
ELSEWHERE = law("elsewhere", 0.3, "45")
CANDIDATES = {one.name: one for one in (DRY, CAPSTAN, ELSEWHERE)}


def dry_on(**values: float) -> State:
    hypothesis = Hypothesis({"dry": Part(tuple(values), False, {"way": 8e-5})})
    given = {("dry", term): value for term, value in values.items()}
    return State.at(hypothesis, given, CANDIDATES)


def test_it_is_as_strong_in_the_same_places() -> None:
    found = instead(dry_on(**{"size@1": 0.6, "size@3": 0.15}), "dry", "capstan")
    assert found is not None
    assert found.hypothesis.names == ("capstan",)
    assert found.term_values() == {
        ("capstan", "size@1"): pytest.approx(0.04),
        ("capstan", "size@3"): pytest.approx(0.01),
    }


def test_numbers_of_shape_that_both_have_stay_as_far_as_they_may() -> None:
    found = instead(dry_on(**{"size@2": 0.3}), "dry", "capstan")
    assert found is not None
    assert found.hypothesis.parts["capstan"].shapes == {
        "way": pytest.approx(1e-4),
        "ratio": pytest.approx(1.4),
    }


def test_a_law_that_has_no_such_places_is_none() -> None:
    assert instead(dry_on(**{"size@2": 0.3}), "dry", "elsewhere") is None
