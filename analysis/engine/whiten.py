"""Residuals in units of their noise: that of values, and that of the instants they are of."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.bundle import TOGETHER_S, Bundle

Chosen = NDArray[np.bool_] | NDArray[np.int64] | slice
"""Which samples of a bundle: a mask, their places, or all from one to another."""


class Whiten:
    """Brings residuals of a bundle's samples to units of their noise.

    A value that changes at rate v, and whose instant is known to s, is off by v s as well: all
    channels of a sample together, and all samples for a while whose instants are off alike.

    Parameters
    ----------
    bundle
        The samples.
    chosen
        Which of them; None: all.
    """

    def __init__(self, bundle: Bundle, chosen: Chosen | None = None) -> None:
        self._root = np.linalg.inv(np.linalg.cholesky(bundle.covariance)).T
        self._along: Array | None = None
        self._alike: _Alike | None = None
        if bundle.jitter is not None:
            along = (bundle.jitter if chosen is None else bundle.jitter[chosen]) @ self._root
            power = (along**2).sum(axis=1, keepdims=True)
            self._along, self._shrunk = along, along * _shrinks(power)
        if bundle.late is not None:
            late = self._singly(bundle.late if chosen is None else bundle.late[chosen])
            self._alike = _Alike(bundle.t_s if chosen is None else bundle.t_s[chosen], late)

    def __call__(self, residual: Array) -> Array:
        """Of the chosen samples, shape (n, m)."""
        white = self._singly(residual)
        if self._alike is not None:
            self._alike.take_off(white)
        return white

    def _singly(self, residual: Array) -> Array:
        """As if samples had nothing in common."""
        # One channel is scaled: a product of matrices takes ten times as long.
        white = residual * self._root[0, 0] if len(self._root) == 1 else residual @ self._root
        if self._along is not None and white.shape[1] == 1:
            white -= white * self._along * self._shrunk
        elif self._along is not None:
            white -= (white * self._along).sum(axis=1, keepdims=True) * self._shrunk
        return np.asarray(white)


class _Alike:
    """What samples for a while have in common: one error of all their instants.

    Parameters
    ----------
    t_s
        Of the samples, shape (n,).
    late
        What one standard deviation of it does to each, in units of their own noise, shape (n, m).
    """

    def __init__(self, t_s: Array, late: Array) -> None:
        self._first, self._while = whiles(t_s)
        self._late = late
        power = np.add.reduceat((late**2).sum(axis=1), self._first)
        self._shrunk = late * _shrinks(power)[self._while, None]

    def take_off(self, white: Array) -> None:
        """Shrink the part of it that this may be, in place; shape (n, m)."""
        found = np.add.reduceat((white * self._late).sum(axis=1), self._first)
        white -= found[self._while, None] * self._shrunk


def whiles(t_s: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First sample of each stretch of `TOGETHER_S`, and the stretch that each sample is in.

    Parameters
    ----------
    t_s
        Of the samples, shape (n,), in their order.
    """
    number = np.floor(t_s / TOGETHER_S).astype(np.int64)
    begins = np.concatenate([[True], np.diff(number) != 0])
    return np.flatnonzero(begins), np.cumsum(begins) - 1


def _shrinks(power: Array) -> Array:
    """By what share of a a^T, of that squared size: (1 + a a^T)^(-1/2) is 1 less that."""
    power = np.maximum(power, np.finfo(float).tiny)
    return np.asarray(-np.expm1(-0.5 * np.log1p(power)) / power)


def sigmas_of(bundle: Bundle) -> Array:
    """Standard deviation of each sample by itself, its instant's included, shape (n, m).

    Parameters
    ----------
    bundle
        The samples.
    """
    power = np.zeros_like(bundle.value) if bundle.jitter is None else bundle.jitter**2
    return np.asarray(np.sqrt(np.diag(bundle.covariance) + power))


def covariance_over(bundle: Bundle, inside: NDArray[np.bool_] | NDArray[np.int64]) -> Array:
    """Covariance of the noise of one sample, that of instants included, on average, shape (m, m).

    Not that by which samples are late together: that is no noise of one.

    Parameters
    ----------
    bundle, inside
        Over which samples of it.
    """
    if bundle.jitter is None:
        return bundle.covariance
    jitter = bundle.jitter[inside]
    return np.asarray(bundle.covariance + jitter.T @ jitter / max(len(jitter), 1))


def noise_leaves(bundles: Sequence[Bundle]) -> float:
    """The squared misfit of a sample that noise leaves, on average, as well as it is known.

    A variance that was taken from n samples is off by the square root of 2 / n, and its inverse is
    too large by 2 / n on average: all of a bundle's residuals share that. One standard deviation
    is allowed, and what instants may be less sure than they were estimated to be.

    Parameters
    ----------
    bundles
        With their samples.
    """
    weights, freedom = _known_from(bundles)
    count = sum(one.value.size for one in bundles)
    unsure = np.array([one.jitter_unsure * _of_jitter(one) for one in bundles])
    spread = float(np.sqrt(2.0 / count + np.sum(weights**2 * 2.0 / freedom)))
    return noise_expected(bundles) + spread + float(weights @ unsure)


def noise_expected(bundles: Sequence[Bundle]) -> float:
    """The same, and none allowed for chance: the inverse of a variance is too large on average.

    Parameters
    ----------
    bundles
        With their samples.
    """
    weights, freedom = _known_from(bundles)
    return float(weights @ (1.0 / (1.0 - 2.0 / freedom)))


def _known_from(bundles: Sequence[Bundle]) -> tuple[Array, Array]:
    """Share of all values that each bundle has, and from how many values its noise is known."""
    counts = np.array([one.value.size for one in bundles], dtype=float)
    freedom = np.array([max(one.noise_from - 2.0, 3.0) if one.noise_from else np.inf
                        for one in bundles])  # fmt: skip
    return counts / counts.sum(), freedom


def _of_jitter(bundle: Bundle) -> float:
    """Share of the variance of a bundle's samples that their instants give."""
    if bundle.jitter is None:
        return 0.0
    along = bundle.jitter @ np.linalg.inv(np.linalg.cholesky(bundle.covariance)).T
    power = (along**2).sum(axis=1)
    return float(np.mean(power / (1.0 + power)) / len(bundle.names))
