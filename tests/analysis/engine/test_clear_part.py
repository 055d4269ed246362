"""The part of the time that a cause foretells, where a law that is not exact is lost at the end."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.clear_part import MOST, clear_part, most_of_it
from analysis.engine.followed import Followed
from analysis.engine.ring_samples import Samples
from tests.analysis.engine.test_ring_fit import DAMPING, T_S, LetGo, ring, state_of

NOISE, RATE = 0.02, 0.1


def off_after(share: float, off: float = 0.0) -> Samples:
    """Of a recording that is far off from some time on, and rough by so many noises until then."""
    more = NOISE * np.where(share * T_S[-1] > T_S, off, 20.0)
    rough = np.random.default_rng(2).standard_normal(len(T_S))
    system = LetGo(ring(0.0, RATE, 0.0, 0.0) + (rough * more)[:, None], noise=NOISE)
    return Samples(system, everything=True)


def led(**how: Any) -> Followed:
    """A law led to where it is right."""
    return Followed(np.zeros(1), state_of(DAMPING, RATE), **how)


def test_what_explains_to_the_noise_is_looked_at_in_that_alone() -> None:
    found = clear_part(off_after(0.4), led(share=0.99))
    assert found is not None
    assert found.share == pytest.approx(0.4, abs=0.02)


def test_a_law_that_is_nearly_right_over_most_of_the_time_is_looked_at_in_that() -> None:
    samples = off_after(0.85, 0.7)
    assert clear_part(samples, led(share=0.99)) is None
    found = most_of_it(samples, led())
    assert found is not None
    assert found.share == pytest.approx(0.85, abs=0.02)
    assert found.share > MOST


def test_where_parameters_are_bent_for_the_rest_what_came_before_counts() -> None:
    samples = off_after(0.85, 0.7)
    bent = replace(led(about=led()), nuisance=np.full(1, 20.0))
    found = most_of_it(samples, bent)
    assert found is not None
    assert found.strain == 0.0
    assert most_of_it(samples, replace(bent, about=None)) is None


@pytest.mark.parametrize(("share", "off"), [(0.5, 0.7), (0.85, 0.9), (1.1, 0.0)])
def test_what_is_off_over_more_or_by_more_or_nowhere_is_not(share: float, off: float) -> None:
    assert most_of_it(off_after(share, off), led()) is None
