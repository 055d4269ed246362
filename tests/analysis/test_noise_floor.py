"""The noise of samples that were never at rest."""

import numpy as np
import pytest

from analysis.noise_floor import noise_floor
from cdpr8.rigfile.excitation import Excitation

NOISE_N = 0.005
MOTION = Excitation(
    axis="pitch", amplitude_deg=2.0, frequency_hz=2.06, rest_s=0.0, motion_s=12.0, ramp_s=0.5
)


def recorded(rate_hz: float, seed: int, *, until_s: float = 12.0) -> tuple[np.ndarray, np.ndarray]:
    """A tension of 7.5 N that drifts and rings, at instants that are not quite even."""
    random = np.random.default_rng(seed)
    t_s = np.arange(0.0, until_s, 1.0 / rate_hz)
    t_s = t_s + random.uniform(-0.02, 0.02, t_s.size) / rate_hz
    clean = 7.5 * np.sin(2.0 * np.pi * 2.06 * t_s) + 0.4 * np.sin(2.0 * np.pi * 6.18 * t_s + 1.0)
    rings = 0.05 * np.cos(2.0 * np.pi * 10.9 * t_s) + 0.03 * np.cos(2.0 * np.pi * 26.6 * t_s)
    return t_s, clean + rings + 0.002 * t_s + random.normal(0.0, NOISE_N, t_s.size)


@pytest.mark.parametrize("rate_hz", [25.0, 60.0, 127.0, 600.0])
def test_noise_is_told_apart_from_a_motion_that_is_a_thousand_times_as_large(
    rate_hz: float,
) -> None:
    found = [noise_floor(*recorded(rate_hz, seed), MOTION) for seed in range(5)]
    assert 0.8 * NOISE_N < np.mean(found) < 1.4 * NOISE_N


def test_a_motion_that_began_later_than_it_says_is_looked_at_where_it_is_steady() -> None:
    t_s, value = recorded(127.0, 7)
    later = np.where(t_s < 4.0, 0.0, value)
    late = MOTION.model_copy(update={"motion_s": 7.0})
    assert noise_floor(t_s, later, late, shift_s=4.5) < 1.4 * NOISE_N


def test_of_few_samples_neighbours_tell() -> None:
    t_s, value = recorded(600.0, 3, until_s=40 / 600.0)
    assert 0.5 * NOISE_N < noise_floor(t_s, value, MOTION) < 4.0 * NOISE_N
