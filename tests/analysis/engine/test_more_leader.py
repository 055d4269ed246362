"""One cause more: what no error of form would look like is led, however large that may be."""

from math import log

import pytest

from analysis.engine.more_leader import by_chance
from analysis.engine.span import FORMS


def test_the_more_of_what_is_left_a_cause_explains_the_less_likely_that_is_chance() -> None:
    chances = [by_chance(share, 1) for share in (0.1, 0.5, 0.75, 0.9)]
    assert chances == sorted(chances)
    assert chances[2] == pytest.approx(0.5 * (FORMS - 1) * log(4.0))


def test_many_numbers_explain_much_by_chance() -> None:
    assert by_chance(0.75, 8) < by_chance(0.75, 1)
    assert by_chance(0.75, FORMS) == 0.0


def test_what_is_promised_to_explain_more_than_there_is_is_as_likely_as_all_of_it() -> None:
    assert by_chance(1.4, 1) == by_chance(1.0, 1)
