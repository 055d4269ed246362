"""Lines above the noise are found with their amplitude, and none where there is only noise."""

import numpy as np
import pytest

from analysis.spectrum import SampleTimes


def test_two_lines_are_told_and_nothing_else() -> None:
    generator = np.random.default_rng(0)
    t_s = np.arange(1400) / 130 + generator.uniform(-0.002, 0.002, 1400)
    value = 1.9 * np.sin(2 * np.pi * 2.06 * t_s + 0.3) + 0.05 * np.sin(2 * np.pi * 6.18 * t_s)
    value += 0.02 * generator.standard_normal(1400)
    lines = SampleTimes(t_s).lines(value, 0.02)
    assert [round(line.frequency_hz, 2) for line in lines] == [2.06, 6.18]
    assert lines[0].amplitude == pytest.approx(1.9, abs=0.005)
    assert lines[1].amplitude == pytest.approx(0.05, abs=0.005)


def test_noise_alone_has_no_lines() -> None:
    generator = np.random.default_rng(1)
    times = SampleTimes(np.arange(176) / 16)
    found = [len(times.lines(0.02 * generator.standard_normal(176), 0.02)) for _ in range(50)]
    assert sum(found) == 0


def test_the_noise_level_is_the_mean_amplitude_of_noise() -> None:
    generator = np.random.default_rng(2)
    times = SampleTimes(np.sort(generator.uniform(0, 11, 500)))
    mean = np.mean([times.amplitude(0.3 * generator.standard_normal(500)) for _ in range(20)])
    assert times.noise_level(0.3) == pytest.approx(mean, rel=0.05)
