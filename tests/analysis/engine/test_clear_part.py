"""The part of the time that a cause foretells, where a law that is not exact is lost at the end."""

import numpy as np
import pytest

from analysis.engine.clear_part import MOST, clear_part
from analysis.engine.followed import Followed
from analysis.engine.ring_samples import Samples
from tests.analysis.engine.test_ring_fit import DAMPING, T_S, LetGo, ring, state_of

NOISE, RATE = 0.02, 0.1


def foretold(off: float, end: float) -> float:
    """Of the time, where samples are rough by so many noises more, and by far more from then on."""
    more = NOISE * np.where(end * T_S[-1] > T_S, off, 20.0)
    rough = np.random.default_rng(2).standard_normal(len(T_S))
    system = LetGo(ring(0.0, RATE, 0.0, 0.0) + (rough * more)[:, None], noise=NOISE)
    led = Followed(np.zeros(1), state_of(DAMPING, RATE), share=0.99)
    found = clear_part(Samples(system, everything=True), led)
    return 0.0 if found is None else found.share


def test_what_explains_to_the_noise_is_looked_at_in_that_alone() -> None:
    assert foretold(0.0, 0.4) == pytest.approx(0.4, abs=0.02)


def test_a_law_that_is_nearly_right_over_most_of_the_time_is_looked_at_in_that() -> None:
    assert foretold(0.7, 0.85) == pytest.approx(0.85, abs=0.02)
    assert foretold(0.7, 0.85) > MOST


@pytest.mark.parametrize(("off", "end"), [(0.7, 0.5), (0.9, 0.85)])
def test_a_law_that_is_off_over_more_or_by_more_is_not(off: float, end: float) -> None:
    assert foretold(off, end) < 0.1
