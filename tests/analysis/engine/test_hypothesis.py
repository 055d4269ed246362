"""What a hypothesis costs beforehand."""

from math import exp, log

import pytest

from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.hypothesis import LOG_COST_SHAPE, Part, part_log_prior

PLACES = "12345678"
TERMS = tuple(Term(f"size@{p}", "size", "N", p, 0.0, 5.0, 0.3) for p in PLACES)


def group(places: str) -> tuple[str, ...]:
    return tuple(f"size@{p}" for p in places)


def law(*groups: str) -> Candidate:
    return Candidate("law", "law", "plant", TERMS, combinations=tuple(map(group, groups)))


def chosen(candidate: Candidate, places: str) -> float:
    """How likely a choice of places is beforehand, beside one place that needs no choosing."""
    alone = Candidate("law", "law", "plant", TERMS[:1])
    part = part_log_prior(candidate, Part(group(places), shared=True))
    return exp(part - part_log_prior(alone, Part(group("1"))))


def test_all_places_are_as_likely_as_all_other_groups_together() -> None:
    known = law(PLACES, "1234", "5678")
    four = [chosen(known, one) for one in ("1234", "5678")]
    assert chosen(known, PLACES) == pytest.approx(0.25)
    assert sum(four) == pytest.approx(0.25)
    assert four[0] == pytest.approx(four[1])


def test_groups_without_all_places_share_as_much() -> None:
    known = law("1234", "5678")
    assert chosen(known, "1234") == pytest.approx(0.25)
    assert chosen(law(PLACES), PLACES) == pytest.approx(0.5)


def test_any_other_choice_shares_the_rest() -> None:
    known = law(PLACES, "1234", "5678")
    assert log(chosen(known, "3")) == pytest.approx(-log(2 * 8 * 8))
    assert log(chosen(known, "37")) == pytest.approx(-log(2 * 8 * 28))


def test_shapes_that_are_only_looked_at_cost_the_choice_of_a_look() -> None:
    size = Term("size", "size", "V", "", 0.0, 1.0, 0.1)
    slow = Shape("slow_s", "s", 1.0, 0.1, 10.0, grid=(0.3, 3.0))
    bend = Shape("bend", "1", 0.5, 0.0, 1.0)
    plain = Candidate("law", "law", "plant", (size,))
    shaped = Candidate("law", "law", "plant", (size,), (slow, bend))
    part = Part(("size",), shapes={"slow_s": 0.3, "bend": 0.5})
    without = part_log_prior(plain, Part(("size",)), moved=False)
    assert without == part_log_prior(plain, Part(("size",))), "there is no shape"
    assert part_log_prior(shaped, part, moved=False) == pytest.approx(without - log(2.0))
    assert part_log_prior(shaped, part) == pytest.approx(without - 2.0 * LOG_COST_SHAPE)


def test_what_a_place_begins_with_counts_once_of_however_many_recordings() -> None:
    def begun(records: int) -> Candidate:
        shapes = tuple(
            Shape(f"bent@{place} in run {record}", "1", 0.0, -1.0, 1.0, term=f"size@{place}")
            for place in PLACES
            for record in range(records)
        )
        return Candidate("law", "law", "plant", TERMS, shapes=shapes)

    part = Part(group("38"), shared=True)
    several, one, none = (part_log_prior(begun(count), part) for count in (6, 1, 0))
    assert several == one
    assert none - one == pytest.approx(2 * LOG_COST_SHAPE)
