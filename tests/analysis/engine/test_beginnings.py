"""A short stretch of a ring fits in several valleys; the next tells which of them goes on."""

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.beginnings import TOLD, begun_otherwise
from analysis.engine.by_ring import _nothing
from analysis.engine.found import Start
from analysis.engine.ring_fit import FAINT, follow_ring
from analysis.engine.system import Nuisance, Point
from tests.analysis.engine.test_ring_fit import T_S, TONE_HZ, LetGo, ring

RISE = 0.05
"""By how much the tone rises, 1/s, for one sigma: it turns the first stretch, of 0.6 s, by 0.6 rad,
and the next one by many turns."""


def rising(sigmas: float) -> Array:
    """Let go at 1 s, with a tone that rises, shape (n, 1)."""
    since = np.maximum(T_S - 1.0, 0.0)
    return np.asarray(np.sin(2.0 * np.pi * TONE_HZ * (since + RISE * sigmas * since**2)))[:, None]


class Rising(LetGo):
    """An oscillator of which the tone may rise."""

    nuisances = (Nuisance("rise", 1.0, "1"),)

    def _one(self, point: Point) -> Array:
        return rising(float(point.nuisance[0]))


@pytest.mark.parametrize(("true", "at"), [(0.0, -1.5), (0.0, 1.5), (-1.0, 1.5)])
def test_parameters_that_took_a_wrong_turn_at_the_beginning_are_led_to_the_right_one(
    true: float, at: float
) -> None:
    system, start = Rising(rising(true), noise=0.5), np.array([at])
    assert follow_ring(system, start, everything=True).left > FAINT
    begun = begun_otherwise(system, start)
    assert begun is not None
    assert begun.nuisance[0] == pytest.approx(true, abs=0.03)
    assert _nothing(system, Start(start)).left == pytest.approx(1.0, abs=0.1)


def test_what_parameters_do_not_foretell_at_all_is_not_begun_otherwise() -> None:
    system = LetGo(ring(0.0, 0.0, 3.0, 1.1), noise=0.05)
    assert begun_otherwise(system, np.zeros(1)) is None


def test_where_no_draw_goes_on_none_is_taken() -> None:
    system = LetGo(ring(0.0, 0.0, 1.0, 20.0 * (TOLD - 0.1)), noise=0.05)
    assert follow_ring(system, np.zeros(1), everything=True).left > FAINT
    assert begun_otherwise(system, np.zeros(1)) is None
