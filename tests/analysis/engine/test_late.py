"""Noise of samples whose instants are off together for a while."""

import numpy as np
import pytest

from analysis.engine.bundle import TOGETHER_S, Bundle, Segment
from analysis.engine.lens import Lens
from analysis.engine.variance import base_variance
from analysis.engine.whiten import Whiten

DRAWS, COUNT = 4000, 60
T_S = np.linspace(0.0, 2.4 * TOGETHER_S, COUNT)
RATE = np.stack([np.cos(9.0 * T_S), 0.5 + np.sin(7.0 * T_S)], axis=1)
COVARIANCE = np.array([[1.0, 0.3], [0.3, 0.5]])


def bundle(jitter: float, late: float) -> Bundle:
    """Two channels, their instants off singly and together by so much."""
    return Bundle(
        names=("a", "b"), units=("m", "m"), t_s=T_S, value=np.zeros((COUNT, 2)),
        covariance=COVARIANCE, segments=(Segment(0.0, 3.0, None, 10.0, name="all"),),
        jitter=jitter * RATE if jitter else None, late=late * RATE if late else None,
    )  # fmt: skip


def drawn(jitter: float, late: float) -> np.ndarray:
    """Noise as it is stated, shape (draws, n, 2)."""
    random = np.random.default_rng(0)
    noise = random.normal(size=(DRAWS, COUNT, 2)) @ np.linalg.cholesky(COVARIANCE).T
    singly = jitter * random.normal(size=(DRAWS, COUNT, 1))
    whiles = np.floor(T_S / TOGETHER_S).astype(int)
    together = late * random.normal(size=(DRAWS, whiles.max() + 1, 1))[:, whiles]
    return np.asarray(noise + (singly + together) * RATE)


@pytest.mark.parametrize(("jitter", "late"), [(0.0, 0.0), (1.5, 0.0), (0.0, 2.0), (1.5, 2.0)])
def test_noise_is_white_of_unit_size_once_whitened(jitter: float, late: float) -> None:
    whiten = Whiten(bundle(jitter, late))
    white = np.array([whiten(one).reshape(-1) for one in drawn(jitter, late)])
    found = white.T @ white / DRAWS
    assert np.abs(found - np.eye(2 * COUNT)).max() < 6.0 / np.sqrt(DRAWS)


def test_some_samples_are_whitened_as_samples_of_their_own() -> None:
    chosen = np.zeros(COUNT, dtype=bool)
    chosen[10:45] = True
    whiten = Whiten(bundle(1.5, 2.0), chosen)
    white = np.array([whiten(one[chosen]).reshape(-1) for one in drawn(1.5, 2.0)])
    assert np.abs(white.T @ white / DRAWS - np.eye(70)).max() < 6.0 / np.sqrt(DRAWS)


def test_features_are_as_unsure_as_instants_that_are_late_together_make_them() -> None:
    lens = Lens([bundle(0.0, 2.0)])
    seen = np.array([lens([one]) for one in drawn(0.0, 2.0)])
    none = np.zeros(lens.size)
    told = base_variance(lens, none, none)
    assert np.abs(np.log(seen.var(axis=0) / told)).max() < 0.2
    assert told.max() > 20.0
