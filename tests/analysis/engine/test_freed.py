"""Parameters that were bent far beside a cause are led as a cause of their own."""

import numpy as np
import pytest

from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.look import look
from analysis.engine.moved import freed
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.system import Array, Point
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
    seen = look(system)
    refiner = Refiner(system, seen.lens, seen.data, seen.calibrated)
    search = FollowedSearch(refiner, follow_ring(system, np.zeros(1), everything=True), 2)
    search._keep(beside_damping(system, off))
    search._lead_freed()
    best = search._best
    assert best.names == names
    if best.state is not None and "tone" in names:
        assert best.state.term_values()["tone", "share"] == pytest.approx(off * SIGMA, rel=1e-2)
        assert best.strain < 1.0
