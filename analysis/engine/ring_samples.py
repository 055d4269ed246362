"""The samples by which a ring is followed, in units of their noise."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.sensitivity import BATCH
from analysis.engine.system import Point, Prediction, System
from analysis.engine.whiten import Whiten, noise_leaves

FASTEST_HZ = 80.0
"""Faster samples are averaged in blocks down to about this."""

SECOND_DIFFERENCE = 6.0
"""Variance of second differences of white noise, over its own."""

OVERHEAD = 0.15
"""What the shortest simulation takes, of a whole one."""

STRETCHES = 200
"""How closely it is told up to where something leads."""


class Samples:
    """The samples by which a ring is followed.

    Parameters
    ----------
    system
        What is simulated.
    held
        A recording that is kept back, but for its rest.
    everything
        Use what is kept back, too; what is sealed never is.
    share
        Those up to this share of the time.
    """

    def __init__(
        self, system: System, *, held: str = "", everything: bool = False, share: float = 1.0
    ) -> None:
        self.system = system
        self.noise = noise_leaves(system.bundles)
        """What noise may leave of a squared sample, on average."""
        self.effort = 0.0
        """Simulations asked for so far, each as the share of a whole one's time that it took."""
        self._mask = [
            seen(one, held=held, everything=everything, share=share) for one in system.bundles
        ]
        self._parts = [
            _Part(one, chosen) for one, chosen in zip(system.bundles, self._mask, strict=True)
        ]

    def residuals(self, points: Sequence[Point], share: float = 1.0) -> list[Array]:
        """Of each point, in units of noise, shape (n,).

        Parameters
        ----------
        points
            What is simulated.
        share
            Samples after this share of them need not be: they are zero.
        """
        upto, after = self._upto(share), self.shares > share
        asked = [replace(one, upto=upto) for one in points]
        self.effort += (OVERHEAD + (1.0 - OVERHEAD) * upto) * len(asked)
        found: list[Array] = []
        for first in range(0, len(points), BATCH):
            reduce = partial(self._residual, share=share)
            found += self.system.simulate(asked[first : first + BATCH], reduce)
        for one in found:
            one[after] = 0.0
        return found

    def means(self, point: Point, share: float) -> tuple[Array, Array]:
        """Shares of the time, up to the one that is given, and what each leaves, shape (n,) both.

        That is the squared residual of a sample up to there, on average.

        Parameters
        ----------
        point
            What is simulated.
        share
            The longest stretch.
        """
        (found,) = self.residuals([point], share)
        first = float(self.shares.min())
        shares = np.arange(1, STRETCHES + 1) / STRETCHES
        shares = shares[(shares >= first) & (shares <= share)]
        return shares, np.array([np.mean(found[self.shares <= one] ** 2) for one in shares])

    def _upto(self, share: float) -> float:
        """Share of a recording's time that a share of its samples takes, of the longest."""
        longest = 0.0
        for bundle, chosen in zip(self.system.bundles, self._mask, strict=True):
            places = np.flatnonzero(chosen)
            if len(places):
                last = places[min(int(np.ceil(share * len(places))), len(places) - 1)]
                t_s = bundle.t_s
                longest = max(longest, float((t_s[last] - t_s[0]) / (t_s[-1] - t_s[0])))
        return longest

    def _residual(self, prediction: Prediction, share: float = 1.0) -> Array:
        """Residuals of the samples that count, in blocks, one bundle after the other."""
        pairs = zip(self._parts, prediction, strict=True)
        return np.concatenate([part.residual(found, share).reshape(-1) for part, found in pairs])

    @property
    def motion(self) -> float:
        """Squared deviation of a sample from its channel's mean, in units of noise, on average."""
        means = [
            np.broadcast_to(one.value[chosen].mean(axis=0), one.value.shape)
            for one, chosen in zip(self.system.bundles, self._mask, strict=True)
        ]
        return float(np.mean(self._residual(means) ** 2))

    def parts(self, residual: Array) -> Iterator[tuple[Array, Array]]:
        """Times, shape (k,), and residuals, shape (k, m), of one bundle after the other.

        Parameters
        ----------
        residual
            In units of noise, shape (n,).
        """
        at = 0
        for bundle, chosen in zip(self.system.bundles, self._mask, strict=True):
            block = _block(bundle)
            rows = int(chosen.sum()) // block
            size = rows * len(bundle.names)
            t_s = bundle.t_s[chosen][: rows * block].reshape(-1, block).mean(axis=1)
            yield t_s, residual[at : at + size].reshape(rows, -1)
            at += size

    def roughness(self, residual: Array) -> float:
        """The squared misfit of a sample as what no motion makes tells it, on average.

        That is of second differences: of white noise they are as large as it is, and of anything
        slow, as an error of form is, next to nothing (von Neumann 1941).

        Parameters
        ----------
        residual
            In units of noise, shape (n,).
        """
        total = 0.0
        for _, part in self.parts(residual):
            rough = np.diff(part, 2, axis=0)
            if rough.size:
                total += part.size * float(np.mean(rough**2)) / SECOND_DIFFERENCE
        return total / max(residual.size, 1)

    @cached_property
    def shares(self) -> Array:
        """When each is, as a share of its recording's time, shape (n,)."""
        bundles = self.system.bundles
        parts = []
        for bundle, chosen in zip(bundles, self._mask, strict=True):
            count = int(chosen.sum())
            block = _block(bundle)
            ends = np.arange(1, count // block + 1) * block / max(count, 1)
            parts.append(np.repeat(ends, len(bundle.names)))
        return np.concatenate(parts)


class _Part:
    """The samples of a bundle that count, in blocks.

    Parameters
    ----------
    bundle
        The samples.
    chosen
        Which of them, shape (n,).
    """

    def __init__(self, bundle: Bundle, chosen: NDArray[np.bool_]) -> None:
        places = np.flatnonzero(chosen)
        self._count = len(places)
        self._block = _block(bundle)
        places = places[: len(places) // self._block * self._block]
        whole = len(places) and places[-1] - places[0] + 1 == len(places)
        self._places = slice(places[0], places[-1] + 1) if whole else places
        self._value = bundle.value[self._places]
        self._whiten = Whiten(bundle, self._places)

    def residual(self, found: Array, share: float) -> Array:
        """In units of noise, shape (blocks, m), of samples up to a share of them; then nothing."""
        rest = self._value - found[self._places]
        # What was not simulated may be anything, and whitening looks at neighbours as well.
        rest[int(np.ceil(share * self._count)) :] = 0.0
        rest = self._whiten(rest)
        if self._block == 1:
            return rest
        rest = rest.reshape(-1, self._block, rest.shape[1])
        return np.asarray(np.einsum("ijk->ik", rest) / np.sqrt(self._block))


def seen(
    bundle: Bundle, *, share: float = 1.0, held: str = "", everything: bool = False
) -> NDArray[np.bool_]:
    """Which samples count.

    Parameters
    ----------
    bundle
        Of which.
    share
        Those up to this share of the time.
    held
        A recording that is kept back, but for its rest.
    everything
        What is kept back, too; what is sealed never.
    """
    chosen = np.zeros(len(bundle.t_s), dtype=bool)
    for one in bundle.segments:
        kept_back = one.held_out or (held != "" and bundle.record == held and one.name != "rest")
        if not one.sealed and (everything or not kept_back):
            chosen |= one.holds(bundle.t_s)
    places = np.flatnonzero(chosen)
    chosen[places[int(np.ceil(share * len(places))) :]] = False
    return chosen


def _block(bundle: Bundle) -> int:
    """How many samples are averaged."""
    length_s = bundle.t_s[-1] - bundle.t_s[0]
    return max(int(len(bundle.t_s) / (FASTEST_HZ * length_s)), 1)
