"""A cell's lag is what it is said to be, however short: a tone comes late by so much."""

from collections.abc import Callable

import numpy as np
import pytest

from analysis.challenge.outsider.cells import _lagging
from analysis.challenge.plant.sensors import Array, _slow

STEP_S, TONE_HZ = 4e-4, 5.0


@pytest.mark.parametrize("lagging", [_slow, _lagging], ids=["first plant", "outsider"])
@pytest.mark.parametrize("lag_s", [1e-4, 3.7e-4, 2e-3])
def test_a_tone_is_late_by_the_lag(
    lagging: Callable[[Array, float, float], Array], lag_s: float
) -> None:
    t_s = np.arange(0.0, 2.0, STEP_S)
    turns = 2.0 * np.pi * TONE_HZ * t_s
    seen = lagging(3.0 + np.sin(turns), lag_s, STEP_S)
    settled = t_s > 1.0
    columns = np.stack([np.sin(turns), np.cos(turns), np.ones_like(t_s)], axis=1)[settled]
    sine, cosine, mean = np.linalg.lstsq(columns, seen[settled], rcond=None)[0]
    late_s = -np.arctan2(cosine, sine) / (2.0 * np.pi * TONE_HZ)
    assert late_s == pytest.approx(lag_s, rel=3e-3, abs=1e-7)
    assert mean == pytest.approx(3.0, abs=1e-9)
    assert seen[0] == pytest.approx(3.0, abs=1e-12)
