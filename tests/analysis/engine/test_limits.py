"""From which size on a cause does not go unnoticed, where nothing was left out."""

import pytest

from analysis.engine import diagnose
from analysis.engine.limits import Limit
from tests.analysis.engine.test_by_ring import Tuned
from tests.analysis.engine.test_ring_fit import ring


@pytest.fixture(scope="module")
def limits() -> dict[str, Limit]:
    found = diagnose(Tuned(ring(0.0, 0.0, 0.0, 0.0)))
    assert found.verdict == "none"
    assert found.search is not None
    return {one.parameter: one for one in found.search.limits}


def test_each_number_of_what_may_be_left_out_has_a_limit(limits: dict[str, Limit]) -> None:
    assert {"rate", "share"} <= set(limits)
    assert all(one.in_one is None for one in limits.values())


@pytest.mark.parametrize(("times", "verdict"), [(2.5, "explained"), (0.3, "none")])
def test_what_is_above_it_is_told_and_what_is_far_below_is_not(
    limits: dict[str, Limit], times: float, verdict: str
) -> None:
    rate = times * limits["rate"].everywhere
    assert diagnose(Tuned(ring(0.0, rate, 0.0, 0.0))).verdict == verdict
