"""What the lens promises: white noise stays white, and each line is seen where it belongs."""

import numpy as np
import pytest

from analysis.engine.bundle import Bundle, Segment
from analysis.engine.lens import Lens


def bundle(covariance: np.ndarray, rate_hz: float = 100.0, tones=()) -> Bundle:
    t_s = np.arange(0.0, 6.0, 1.0 / rate_hz)
    channels = len(covariance)
    return Bundle(
        names=tuple(f"c{i}" for i in range(channels)),
        units=("N",) * channels,
        t_s=t_s,
        value=np.zeros((len(t_s), channels)),
        covariance=covariance,
        segments=(
            Segment(0.0, 1.0, None, 20.0, name="rest"),
            Segment(1.0, 6.0, 2.0, name="steady"),
        ),
        tones_hz=tuple(tones),
    )


def test_white_noise_of_any_covariance_becomes_independent_features_of_unit_variance() -> None:
    generator = np.random.default_rng(1)
    covariance = np.array([[4.0, 1.5], [1.5, 1.0]])
    made = bundle(covariance)
    lens = Lens([made])
    draws = np.array(
        [
            lens([generator.multivariate_normal([0, 0], covariance, len(made.t_s))])
            for _ in range(400)
        ]
    )
    assert draws.std(axis=0) == pytest.approx(np.ones(lens.size), abs=0.2)
    apart = np.corrcoef(draws.T) - np.eye(lens.size)
    assert np.abs(apart).max() < 0.3


@pytest.mark.parametrize("harmonic", [1, 3, 7])
def test_a_steady_harmonic_is_seen_on_its_own_line_only(harmonic: int) -> None:
    made = bundle(np.eye(1))
    lens = Lens([made])
    seen = lens([np.sin(2 * np.pi * 2.0 * harmonic * made.t_s)[:, None]])
    steady = lens.labels.segment == 1
    own = steady & (lens.labels.line == harmonic)
    assert np.abs(seen[own]).max() == pytest.approx(np.sqrt(500 / 2), rel=0.01)
    assert np.abs(seen[steady & ~own]).max() < 0.02 * np.abs(seen[own]).max()


def test_lines_at_a_tone_and_above_those_the_drive_cannot_reach_are_called_ringing() -> None:
    labels = Lens([bundle(np.eye(1), tones=(9.0,))]).labels
    steady = labels.segment == 1
    assert set(labels.line[steady & labels.ringing]) == {4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0}


def test_a_stretch_with_fewer_samples_than_lines_still_has_an_orthonormal_basis() -> None:
    made = bundle(np.eye(1), rate_hz=4.0)
    lens = Lens([made])
    assert lens.size <= len(made.t_s)
    features = np.array([lens([row[:, None]]) for row in np.eye(len(made.t_s))])
    assert features.T @ features == pytest.approx(np.eye(lens.size), abs=1e-9)
