"""Another law of the same thing in the place of one that is on."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.instead import instead
from analysis.engine.kin import kin_alike, kin_left, lead_instead, part_of_the_way
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, Prediction


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


def test_what_goes_with_its_square_begins_at_the_size_it_is_screened_at() -> None:
    known = {**CANDIDATES, "capstan": replace(CAPSTAN, grows=True)}
    state = replace(dry_on(**{"size@2": 1e-3, "size@3": 3e-3}), candidates=known)
    found = instead(state, "dry", "capstan")
    assert found is not None
    assert found.term_values() == {
        ("capstan", "size@2"): pytest.approx(0.01),
        ("capstan", "size@3"): pytest.approx(0.03),
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


def test_places_alike_are_all_of_them_as_strong_on_average() -> None:
    alike = dry_on(**{"size@1": 0.6, "size@3": 0.3}).alike()
    part = alike.hypothesis.parts["dry"]
    assert part.shared
    assert part.terms == ("size@1", "size@2", "size@3")
    assert alike.term_values() == {("dry", f"size@{place}"): pytest.approx(0.3) for place in "123"}
    assert alike.alike() is alike


def test_laws_of_one_kind_are_asked_in_all_places_where_one_came_through_in_some() -> None:
    some = dry_on(**{"size@1": 0.6})
    capstan = instead(some, "dry", "capstan")
    assert capstan is not None
    both = [Guess(one, np.zeros(1)) for one in (some, capstan)]
    costs = {1.0: 5.0}
    best = Followed(np.zeros(1), some, costs=costs)
    assert kin_alike(best, both, CANDIDATES) == both
    assert kin_alike(replace(best, state=some.alike()), both, CANDIDATES) == []
    assert kin_alike(replace(best, costs={0.5: 5.0}), both, CANDIDATES) == []


def test_a_law_that_led_farther_beside_something_else_is_asked_first() -> None:
    later, other = replace(CAPSTAN, name="later"), replace(DRY, name="other", family="")
    known = CANDIDATES | {"later": later, "other": other}
    best = Followed(np.zeros(1), dry_on(**{"size@1": 0.6}), costs={1.0: 5.0})

    def led(share: float, *names: str) -> Followed:
        hypothesis = Hypothesis({name: Part(("size@1",)) for name in names})
        on = State.at(hypothesis, {(name, "size@1"): 0.6 for name in names}, known)
        return Followed(np.zeros(1), on, costs={share: 9.0})

    def order(*others: Followed) -> list[str]:
        return [name for _, name, _ in kin_left(best, [best, *others], known)]

    assert order() == ["capstan", "elsewhere", "later"]
    far = led(0.2, "later", "other")
    assert order(far) == ["later", "capstan", "elsewhere"]
    # What was tried in this very place, and was lost, comes last.
    assert order(far, led(0.3, "capstan")) == ["later", "elsewhere", "capstan"]


def test_part_of_the_way_to_one_cause_more_takes_part_of_each_step_and_of_the_new_cause() -> None:
    best = dry_on(**{"size@1": 0.6})
    with_more = Hypothesis(
        {"dry": best.hypothesis.parts["dry"], "elsewhere": Part(("size@4",), False, {})}
    )
    sizes = {("dry", "size@1"): 1.0, ("elsewhere", "size@4"): 0.4}
    half = State.at(with_more, sizes, CANDIDATES).nearer(best, 0.5)
    assert half.term_values() == {
        ("dry", "size@1"): pytest.approx(0.8),
        ("elsewhere", "size@4"): pytest.approx(0.2),
    }


def test_how_strong_another_law_is_leaves_what_is_beside_it_alone() -> None:
    both = Hypothesis(
        {"dry": Part(("size@1",), False, {"way": 8e-5}), "elsewhere": Part(("size@4",), False, {})}
    )
    state = State.at(both, {("dry", "size@1"): 0.6, ("elsewhere", "size@4"): 0.4}, CANDIDATES)
    less = state.smaller(0.5, "dry").term_values()
    assert less == {("dry", "size@1"): 0.3, ("elsewhere", "size@4"): 0.4}
    assert state.smaller(0.5).term_values()["elsewhere", "size@4"] == 0.2


class _Bent:
    """What one number does is straight, and what the cause does grows with its cube."""

    name = "bent"
    nuisances = (Nuisance("level", 1.0, "V"),)
    candidates = (ELSEWHERE,)

    def __init__(self, later: float = 0.9) -> None:
        times = np.arange(0.0, 1.0, 0.01)
        whole = (Segment(0.0, 1.0, None, 20.0),)
        value = np.where(times < 0.5, 0.9, later)[:, None]
        self.bundles = (Bundle(("y",), ("V",), times, value, np.eye(1) * 1e-4, whole),)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [
            reduce([np.full((100, 1), one.nuisance[0] + sum(
                setting.values["size@4"] ** 3 for setting in one.effects.values()))])
            for one in points
        ]  # fmt: skip


def test_where_straight_lines_promise_too_much_less_of_it_is_begun_with() -> None:
    system = _Bent()
    state = State.at(
        Hypothesis({"elsewhere": Part(("size@4",), False, {})}),
        {("elsewhere", "size@4"): 5.0},
        {"elsewhere": ELSEWHERE},
    )
    far = Followed(np.array([0.5]), state)
    begun = part_of_the_way(Samples(system), Followed(np.array([0.4]), None), far)
    assert begun.state is not None
    assert begun.state.values[0] == pytest.approx(0.05 * 5.0)
    assert begun.nuisance[0] == pytest.approx(0.405)


def test_where_they_promise_over_a_first_part_what_comes_after_it_does_not_count() -> None:
    system = _Bent(later=0.4)
    state = State.at(
        Hypothesis({"elsewhere": Part(("size@4",), False, {})}),
        {("elsewhere", "size@4"): 0.7},
        {"elsewhere": ELSEWHERE},
    )
    far, best = Followed(np.array([0.5]), state), Followed(np.array([0.4]), None)
    whole, first = (part_of_the_way(Samples(system), best, far, one) for one in (1.0, 0.45))
    assert first is far
    assert whole is not far


LONGER = Candidate(
    "longer", "", "plant", (Term("m", "m", "", "4", 0.0, 9.0, 0.1),), family="length"
)
TIGHTER = Candidate(
    "tighter", "", "plant", (Term("n", "n", "", "4", -9.0, 9.0, 0.1),), family="length"
)


class _Pulled(_Bent):
    """What makes a cable longer makes it less tight, by three times as much."""

    candidates = (LONGER, TIGHTER)

    def __init__(self) -> None:
        super().__init__()
        self.bundles = (replace(self.bundles[0], value=np.full((100, 1), -1.5)),)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        found = []
        for one in points:
            longer = one.effects["longer"].values["m"] if "longer" in one.effects else 0.0
            tighter = one.effects["tighter"].values["n"] if "tighter" in one.effects else 0.0
            found.append(reduce([np.full((100, 1), tighter - 3.0 * longer)]))
        return found


def test_what_one_law_counts_as_more_another_may_count_as_less() -> None:
    system = _Pulled()
    known = {one.name: one for one in (LONGER, TIGHTER)}
    state = State.at(Hypothesis({"longer": Part(("m",))}), {("longer", "m"): 0.5}, known)
    found = lead_instead(Samples(system), Followed(np.zeros(1), state), "longer", "tighter")
    assert found is not None
    assert found.state is not None
    assert found.state.values[0] == pytest.approx(-1.5, abs=0.01)
