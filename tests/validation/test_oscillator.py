"""The engine on a system that does not ring, of which all is known: what it may say, what not."""

import numpy as np
import pytest

from analysis.engine import Diagnosis, diagnose
from tests.validation.oscillator import COUNT, Oscillator, two_levels
from tests.validation.shared import named

OFF = {"stiff": 0.03, "damped": -0.3, "gain": 0.02}
"""Parameters one standard deviation off."""

AT_REST = np.zeros(COUNT)
LET_GO = {"forces": (AT_REST,) * 3, "starts": ((0.5, 0.0), (0.25, 1.0), (0.4, -0.5))}


def values(found: Diagnosis) -> dict[str, float]:
    assert found.judgement is not None
    return {one.name: one.values[one.name] for one in found.judgement.causes}


def left(found: Diagnosis) -> float:
    assert found.judgement is not None
    return found.judgement.chosen.left


@pytest.mark.parametrize("noise_db", [30.0, 50.0])
def test_where_nothing_was_left_out_nothing_is_named(noise_db: float) -> None:
    found = diagnose(Oscillator(OFF, noise_db))
    assert found.verdict == "none"
    assert left(found) == pytest.approx(1.0, abs=0.12)
    assert found.confirmation is not None
    assert found.confirmation.before["used"][""] == pytest.approx(1.0, abs=0.06)


def test_three_decays_of_which_nothing_was_left_out() -> None:
    found = diagnose(Oscillator({"stiff": 0.03, "damped": -0.3}, 45.0, **LET_GO))
    assert found.verdict == "none"


@pytest.mark.long
def test_the_drag_of_three_decays_with_its_size() -> None:
    found = diagnose(Oscillator({"stiff": 0.02, "drag": 0.5}, 45.0, **LET_GO))
    assert named(found) == {"drag"}
    assert values(found)["drag"] == pytest.approx(0.5, rel=0.03)
    assert found.confirmation is not None
    assert found.confirmation.held_record == "", "nothing else tells where it starts"


def test_two_laws_at_a_high_signal_over_noise_are_both_named() -> None:
    found = diagnose(Oscillator({**OFF, "coulomb": 0.5, "cubic": 20.0}, 45.0))
    assert found.verdict == "explained"
    assert named(found) == {"coulomb", "cubic"}
    assert values(found)["coulomb"] == pytest.approx(0.5, rel=0.1)
    assert values(found)["cubic"] == pytest.approx(20.0, rel=0.1)


def test_a_law_that_is_not_in_the_list_is_not_explained() -> None:
    found = diagnose(Oscillator({**OFF, "coulomb": 0.5}, 45.0, ("coulomb", "hysteresis")))
    assert found.verdict == "unexplained"
    assert found.remains is not None
    assert found.remains.significant


@pytest.mark.long
def test_hysteresis_is_named() -> None:
    found = diagnose(Oscillator({**OFF, "hysteresis": 12.0, "beta": 30.0}, 40.0))
    assert found.verdict == "explained"
    assert named(found) == {"hysteresis"}
    assert values(found)["hysteresis"] == pytest.approx(12.0, rel=0.1)


def test_a_dead_zone_under_a_force_of_one_size_is_found_at_its_size() -> None:
    """There it is but a gain, which parameters take back in part."""
    found = diagnose(Oscillator({**OFF, "dead_zone": 0.6}, 40.0, forces=(two_levels(),)))
    assert named(found) == {"dead_zone"}
    assert values(found)["dead_zone"] == pytest.approx(0.6, rel=0.15)
