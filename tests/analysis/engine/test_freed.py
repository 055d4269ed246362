"""Parameters that were bent far beside a cause are led as a cause of their own."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.all_samples import cost_of, parameters_of
from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.kin import lead_from
from analysis.engine.look import look
from analysis.engine.moved import freed
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring, is_far
from analysis.engine.system import Point
from tests.analysis.engine.test_by_ring import Tuned
from tests.analysis.engine.test_ring_fit import DAMPING, SIGMA, ring, state_of

OFF, RATE = 14.0, 0.3
"""By how many sigmas the tone is off, and the damping, 1/s."""


class Detuned(Tuned):
    """With the tone's own share simulated."""

    def _one(self, point: Point) -> Array:
        tone, damping = point.effects.get("tone"), point.effects.get("damping")
        share = SIGMA * float(point.nuisance[0]) + (tone.values["share"] if tone else 0.0)
        return ring(share, damping.values["rate"] if damping else 0.0, 0.0, 0.0)


def beside_damping(system: Detuned, off: float) -> Followed:
    """The damping led to the end, the tone bent for it."""
    state = state_of(DAMPING, RATE)
    return follow_ring(system, np.array([off]), state, everything=True, near=True)


def search_of(system: Detuned) -> FollowedSearch:
    """A search that has led nothing yet."""
    nothing = follow_ring(system, np.zeros(1), everything=True)
    return FollowedSearch(Refiner(system, *look(system)), nothing, 2)


def test_what_was_bent_as_far_where_it_began_is_asked_where_it_led_to() -> None:
    system = Detuned(ring(OFF * SIGMA, RATE, 0.0, 0.0))
    near = beside_damping(system, OFF)
    assert near.to_end
    assert is_far(near)
    assert near.about is None
    windows = follow_ring(system, np.zeros(1), state_of(DAMPING, RATE), everything=True)
    assert windows.to_end
    assert is_far(windows)
    assert windows.about is not None, "before it was bent, something was told"
    assert not is_far(windows.about)


def test_what_is_freed_is_the_same_simulation_without_its_strain() -> None:
    system = Detuned(ring(OFF * SIGMA, RATE, 0.0, 0.0))
    led = beside_damping(system, OFF)
    known = {one.name: one for one in system.candidates}
    found = freed(system, known, led, "tone")
    assert led.strain > 150.0
    assert found.names == ("damping", "tone")
    assert found.strain == 0.0
    assert system._one(found.point) == pytest.approx(system._one(led.point), abs=1e-12)


@pytest.mark.parametrize(("off", "names"), [(OFF, ("damping", "tone")), (5.0, ("damping",))])
def test_parameters_bent_far_beside_a_cause_are_led_as_one_however_much_was_tried(
    off: float, names: tuple[str, ...]
) -> None:
    system = Detuned(ring(off * SIGMA, RATE, 0.0, 0.0))
    search = search_of(system)
    search._keep(beside_damping(system, off))
    search._lead_freed()
    best = search._best
    assert best.names == names
    if best.state is not None and "tone" in names:
        assert best.state.term_values()["tone", "share"] == pytest.approx(off * SIGMA, rel=1e-2)
        assert best.strain < 1.0


def test_each_of_what_came_as_close_as_the_best_is_led_alone() -> None:
    system = Detuned(ring(0.0, RATE, 0.0, 0.0))
    search = search_of(system)
    known = {one.name: one for one in system.candidates}
    both = freed(system, known, beside_damping(system, 3.0), "tone")
    assert both.state is not None
    search._keep(lead_from(system, both, both.state))
    (pair,) = search._as_close()
    assert pair.names == ("damping", "tone")
    search._one_less(pair)
    assert ("damping",) in {one.names for one in search._led}
    assert search._as_close() == [pair]
    led = len(search._led)
    search._one_less(pair)
    assert len(search._led) == led


def test_without_a_cause_that_is_a_parameter_it_begins_where_the_parameter_does_the_same() -> None:
    system = Detuned(ring(0.0, RATE, 0.0, 0.0))
    known = {one.name: one for one in system.candidates}
    pair = freed(system, known, beside_damping(system, OFF), "tone")
    assert pair.state is not None
    start = parameters_of(system, pair, ("tone",))
    alone = Followed(start, pair.state.without("tone"))
    assert start[0] != pytest.approx(pair.nuisance[0])
    assert system._one(alone.point) == pytest.approx(system._one(pair.point), abs=1e-12)
    assert parameters_of(system, pair, ("damping",)) == pytest.approx(pair.nuisance)


def test_what_stayed_far_behind_without_a_cause_needs_it_from_about_as_good_a_place() -> None:
    system = Detuned(ring(0.0, RATE, 0.0, 0.0))
    search = search_of(system)
    known = {one.name: one for one in system.candidates}
    start = freed(system, known, beside_damping(system, 3.0), "tone")
    assert start.state is not None
    pair = lead_from(system, start, start.state)
    search._one_less(pair)
    led = [one.names for one in search._led]
    assert sorted(led) == [("damping",), ("tone",)]
    # The tone alone loses the ring that dies away; the damping alone comes as close as both.
    search._one_less(replace(pair, effort=0.0))
    assert [one.names for one in search._led] == led
    search._led.clear()
    search._one_less(replace(pair, misfit=pair.misfit - 1e4))
    assert ("tone",) in {one.names for one in search._led}


def test_what_had_made_up_for_something_is_led_from_the_likeliest_parameters() -> None:
    system = Detuned(ring(OFF * SIGMA, RATE, 0.0, 0.0))
    bent = beside_damping(system, OFF)
    assert bent.is_bent
    known = {one.name: one for one in system.candidates}
    start = freed(system, known, bent, "tone")
    assert start.state is not None
    led = lead_from(system, bent, start.state, np.array([OFF]))
    assert led.to_end
    assert abs(float(led.nuisance[0])) < 1.0
    assert led.left == pytest.approx(1.0, abs=0.1)


def test_what_a_cause_is_worth_to_first_order_is_what_it_costs_to_be_without_it() -> None:
    system = Detuned(ring(0.0, RATE, 0.0, 0.0))
    known = {one.name: one for one in system.candidates}
    start = freed(system, known, beside_damping(system, 3.0), "tone")
    assert start.state is not None
    pair = lead_from(system, start, start.state)
    assert pair.state is not None
    fewer = lead_from(system, pair, pair.state.without("tone"))
    assert pair.rises_without("tone") == pytest.approx(cost_of(fewer) - cost_of(pair), abs=3.0)
    assert pair.rises_without("damping") > 1e3
    assert replace(pair, information=None).rises_without("tone") == np.inf


def test_few_parameters_far_off_make_up_for_nothing_many_a_little_off_do() -> None:
    far, many = np.zeros(20), np.full(20, 1.6)
    far[0] = 100.0
    assert [Followed(one, None).is_bent for one in (far, many)] == [True, True]
    assert [Followed(one, None).is_bent_throughout for one in (far, many)] == [False, True]
