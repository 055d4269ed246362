"""Who simulates what: points in shares for processes."""

import numpy as np
import pytest

from analysis.diagnosis.sharing import Alike, Share, shares
from analysis.engine.candidate import Setting
from analysis.engine.system import Point
from model.library.lanes import LANES


def asked(count: int, effect: str | None = None, first: int = 0) -> list[Alike]:
    """So many simulations of one run, each of one point."""
    effects = {} if effect is None else {effect: Setting({}, {})}
    point = Point(np.zeros(1), effects)
    return [Alike({first + i: point}, 1) for i in range(count)]


def sizes(found: list[Share]) -> list[tuple[int, int]]:
    return [(one.record, len(one.points)) for one in found]


def test_what_is_asked_of_one_run_is_divided_among_processes() -> None:
    assert sizes(shares([asked(12)], 2)) == [(0, 6), (0, 6)]


def test_of_several_runs_each_is_left_whole_where_lanes_are_filled() -> None:
    assert sizes(shares([asked(12), asked(12)], 2)) == [(0, 12), (1, 12)]


def test_laws_of_pulleys_fill_lanes_sooner() -> None:
    few = [asked(6, "pulley_coulomb")] * 2
    assert sizes(shares(few, 2)) == [(0, 6), (1, 6)]
    odd = [asked(2)] * 3
    assert sizes(shares(odd, 2)) == [(0, 1), (0, 1), (1, 1), (1, 1), (2, 1), (2, 1)]


@pytest.mark.parametrize("processes", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 17, 40])
def test_every_point_is_in_one_share_and_no_share_is_longer_than_lanes(
    processes: int, count: int
) -> None:
    every = [asked(count), asked(3), asked(count, "cable_slack", first=100)]
    found = shares(every, processes)
    for record, one in enumerate(every):
        places = [place for share in found if share.record == record for place in share.points]
        assert sorted(places) == sorted(place for alike in one for place in alike.points)
    assert all(len(one.points) <= LANES for one in found)


def test_what_is_only_looked_at_stays_together() -> None:
    point = Point(np.zeros(1))
    looked_at = Alike(dict.fromkeys(range(50), point), 1)
    (one,) = shares([[looked_at]], 2)
    assert len(one.points) == 50
