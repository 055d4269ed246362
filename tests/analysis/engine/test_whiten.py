"""Residuals in units of noise, where the instants of samples are known to some accuracy."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.whiten import Whiten, covariance_over, noise_leaves, sigmas_of

NOISE, INSTANT_S, TONE_HZ = 0.01, 5e-4, 20.0
T_S = np.arange(0.0, 40.0, 0.01)


def swinging(channels: int) -> tuple[Bundle, Array]:
    """Channels that swing together, read at instants that are a little off, and what is exact."""
    generator = np.random.default_rng(7)
    size = np.arange(1.0, channels + 1.0)
    off_s = INSTANT_S * generator.standard_normal(len(T_S))

    def value(t_s: Array) -> Array:
        return np.sin(2.0 * np.pi * TONE_HZ * t_s)[:, None] * size

    rate = 2.0 * np.pi * TONE_HZ * np.cos(2.0 * np.pi * TONE_HZ * T_S)[:, None] * size
    noisy = value(T_S + off_s) + NOISE * generator.standard_normal((len(T_S), channels))
    names = tuple(f"y{i}" for i in range(channels))
    bundle = Bundle(
        names, ("V",) * channels, T_S, noisy, np.eye(channels) * NOISE**2, (),
        jitter=INSTANT_S * rate,
    )  # fmt: skip
    return bundle, noisy - value(T_S)


@pytest.mark.parametrize("channels", [1, 3])
def test_steep_and_flat_samples_are_alike_once_their_instants_count(channels: int) -> None:
    bundle, residual = swinging(channels)
    white = Whiten(bundle)(residual)
    assert np.atleast_2d(np.cov(white.T)) == pytest.approx(np.eye(channels), abs=0.1)
    assert np.mean((residual / sigmas_of(bundle)) ** 2, axis=0) == pytest.approx(1.0, abs=0.1)
    assert bundle.jitter is not None
    steep = np.abs(bundle.jitter[:, 0]) > np.median(np.abs(bundle.jitter[:, 0]))
    assert np.mean(white[steep] ** 2) == pytest.approx(np.mean(white[~steep] ** 2), rel=0.15)


def test_instants_that_are_taken_for_exact_look_like_physics() -> None:
    bundle, residual = swinging(1)
    white = Whiten(replace(bundle, jitter=None))(residual)
    assert np.mean(white**2) > 10.0


def test_what_was_chosen_is_whitened_as_in_the_whole() -> None:
    bundle, residual = swinging(3)
    chosen = T_S > 20.0
    part = Whiten(bundle, chosen)(residual[chosen])
    assert part == pytest.approx(Whiten(bundle)(residual)[chosen])


def test_over_a_stretch_it_is_the_covariance_that_samples_have() -> None:
    bundle, residual = swinging(3)
    inside = np.ones(len(T_S), dtype=bool)
    seen = residual.T @ residual / len(T_S)
    assert covariance_over(bundle, inside) == pytest.approx(seen, rel=0.1, abs=2e-5)
    assert covariance_over(replace(bundle, jitter=None), inside) is bundle.covariance


def test_instants_that_were_estimated_may_leave_more_than_those_that_are_stated() -> None:
    bundle, _ = swinging(1)
    assert bundle.jitter is not None
    estimated = replace(bundle, jitter_unsure=0.2)
    more = noise_leaves([estimated]) - noise_leaves([bundle])
    variance = bundle.jitter[:, 0] ** 2
    share = np.mean(variance / (variance + bundle.covariance[0, 0]))
    assert more == pytest.approx(0.2 * share)
    assert noise_leaves([replace(estimated, jitter=None)]) == noise_leaves([bundle])
