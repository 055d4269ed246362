"""What a number of the machine has moved by is its cause's, where that is on."""

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.known import Known
from analysis.engine.relieved import relieved
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.way import Way
from tests.analysis.engine.test_freed import RATE, Detuned, beside_damping
from tests.analysis.engine.test_ring_fit import SIGMA, ring


def led(system: Detuned, sigmas: float, share: float) -> Followed:
    """A tone that is off by so many sigmas as a nuisance, and by so much as a cause."""
    known = {one.name: one for one in system.candidates}
    on = Hypothesis({"tone": Part(("share",))})
    return Followed(np.array([sigmas]), State.at(on, {("tone", "share"): share}, known))


def simulated(system: Detuned, at: Followed) -> Array:
    """What it leaves."""
    (found,) = Samples(system, everything=True).residuals([at.point])
    return found


@pytest.mark.parametrize(("sigmas", "share"), [(5.0, 0.0), (-2.0, 3.0 * SIGMA)])
def test_all_of_it_is_the_cause_s_and_the_simulation_is_the_same(
    sigmas: float, share: float
) -> None:
    system = Detuned(ring(0.0, 0.0, 0.0, 0.0))
    at = led(system, sigmas, share)
    found = relieved(system, at)
    assert found.strain == pytest.approx(0.0, abs=1e-20)
    assert found.state is not None
    assert found.state.term_values()["tone", "share"] == pytest.approx(share + sigmas * SIGMA)
    assert simulated(system, found) == pytest.approx(simulated(system, at), abs=1e-9)


def test_a_cause_takes_no_more_than_is_plausible() -> None:
    system = Detuned(ring(0.0, 0.0, 0.0, 0.0))
    (term,) = next(one for one in system.candidates if one.name == "tone").terms
    beyond = 2.0
    found = relieved(system, led(system, term.high / SIGMA + beyond, 0.0))
    assert found.nuisance == pytest.approx([beyond])


def test_what_is_not_on_takes_nothing() -> None:
    system = Detuned(ring(0.0, RATE, 0.0, 0.0))
    at = beside_damping(system, 3.0)
    assert relieved(system, at) is at
    alone = Followed(np.array([3.0]), None)
    assert relieved(system, alone) is alone


def test_where_a_number_is_held_it_stays() -> None:
    system = Detuned(ring(0.0, 0.0, 0.0, 0.0))
    at = led(system, 5.0, 0.0)
    assert Way(Samples(system, everything=True), at).at.strain == pytest.approx(0.0, abs=1e-20)
    held = Known(at.numbers, np.eye(len(at.numbers)))
    assert Way(Samples(system, everything=True), at, known=held).at is at
