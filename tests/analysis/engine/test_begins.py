"""What begins at once was left out; what grows out of the noise may not have been."""

import numpy as np
import pytest

from analysis.engine import diagnose
from analysis.engine.begins import begins
from analysis.engine.system import Point
from analysis.engine.until import Until
from tests.analysis.engine.test_ring_fit import SIGMA, T_S, LetGo, ring
from tests.analysis.engine.test_until import grown

BLOW_S, SIZE = 12.0, 1.0


def blown(value: np.ndarray) -> np.ndarray:
    """With another tone that rings from a time on, as after a blow."""
    more = SIZE * np.sin(2.0 * np.pi * 7.7 * (T_S - BLOW_S))
    return np.asarray(value + np.where(T_S > BLOW_S, more, 0.0)[:, None])


def right() -> np.ndarray:
    return ring(0.0, 0.0, 0.0, 0.0)


def test_a_blow_is_told_with_when_and_where() -> None:
    system = LetGo(blown(right()))
    found = begins(system, Point(np.zeros(1)), 0.4)
    assert found is not None
    assert found.t_s == pytest.approx(BLOW_S, abs=0.3)
    assert found.channel == system.bundles[0].names[0]


@pytest.mark.parametrize("value", [right(), grown(right(), 0.05)], ids=["nothing", "growth"])
def test_noise_and_what_grows_do_not_begin_at_once(value: np.ndarray) -> None:
    assert begins(LetGo(value), Point(np.zeros(1)), 0.4) is None


def test_what_began_before_does_not_begin_later() -> None:
    assert begins(LetGo(blown(right())), Point(np.zeros(1)), 0.8) is None


def test_a_recording_in_which_something_begins_at_once_is_not_told_as_nothing() -> None:
    found = diagnose(LetGo(blown(ring(2.0 * SIGMA, 0.0, 0.0, 0.0))))
    assert isinstance(found.system, Until)
    assert found.verdict == "unexplained"
    assert found.judgement is not None
    assert not found.judgement.causes
    assert any("begins at once" in note for note in found.notes)
