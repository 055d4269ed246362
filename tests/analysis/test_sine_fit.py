"""The sine fit finds what was put in, and its uncertainties are those of repeated draws."""

import numpy as np
import pytest

from analysis.sine_fit import fit_sine, phase_at


def drawn(generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    t_s = np.sort(generator.uniform(1.5, 12.5, 176))
    value = 1.9 * np.sin(2 * np.pi * 2.06 * t_s + 0.3) + 0.1
    return t_s, value + 0.02 * generator.standard_normal(176)


def test_a_clean_sine_is_found_to_rounding() -> None:
    t_s = np.arange(0, 5, 1 / 16)
    fit = fit_sine(t_s, 1.9 * np.sin(2 * np.pi * 2.06 * t_s + 0.3) + 0.1, 2.0)
    assert fit.amplitude == pytest.approx(1.9, rel=1e-9)
    assert fit.frequency_hz == pytest.approx(2.06, rel=1e-9)
    assert fit.phase_rad == pytest.approx(0.3, abs=1e-7)
    assert fit.offset == pytest.approx(0.1, abs=1e-9)


def test_stated_uncertainties_are_the_spread_of_repeated_draws() -> None:
    generator = np.random.default_rng(3)
    fits = [fit_sine(*drawn(generator), 2.06) for _ in range(300)]
    for name in ("amplitude", "frequency_hz", "phase_rad"):
        spread = np.std([getattr(fit, name) for fit in fits])
        stated = np.mean([getattr(fit, f"sigma_{name}") for fit in fits])
        assert stated == pytest.approx(spread, rel=0.15), name


def test_phase_of_a_known_frequency() -> None:
    t_s, value = drawn(np.random.default_rng(5))
    phase, sigma = phase_at(t_s, value, 2.06)
    assert abs(phase - 0.3) < 4 * sigma
    assert sigma == pytest.approx(0.02 * np.sqrt(2 / 176) / 1.9, rel=0.2)


def test_the_unit_does_not_matter() -> None:
    t_s, value = drawn(np.random.default_rng(6))
    small = fit_sine(t_s, 1e-6 * value, 2.06)
    large = fit_sine(t_s, value, 2.06)
    assert 1e6 * small.amplitude == pytest.approx(large.amplitude, rel=1e-9)
