"""Noise that is not what is stated, as what is left of the samples tells from one to the next.

A noise that was taken from sixty samples at rest is a tenth off, and one from a data sheet may be
half as large as it is. Eight per cent too little of it, in sigma, look like something that nothing
explains, once there are thousands of samples. But physics is smooth where samples are close:
second differences of what is left hold all of a white noise, and next to nothing of the rest (von
Neumann 1941); and where fourth differences tell the same, nothing rough is in them but that.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.restated import Restated
from analysis.engine.system import Point, System
from analysis.engine.whiten import sigmas_of

ORDERS = (2, 4)
"""Of the differences."""

SQUARES = {2: 6.0, 4: 70.0}
"""How much larger they are than white noise, squared."""

WORTH = 1.94
"""So many samples tell what one that is independent does: second differences overlap."""

SURE, LEAST, MOST = 4.0, 1.05, 2.25
"""A variance that is stated as known is off where it is larger by so many standard deviations, and
so many times at least; one that is more than the last is not its noise."""

OFTEN = 3.0
"""Variances that were taken from few samples are told anew where, together, they are off by more
than chance, by so many standard deviations."""

SAME = 4.0
"""Differences of both orders tell the same to within so many standard deviations."""

QUIETER = 1.05
"""What explains best took roughness for itself, where a sigma is that much less beside it."""

LEAST_SAMPLES = 50
"""That a channel needs."""

LOUDER = (
    "the noise of samples is {times} times what is stated: what is left is as "
    "rough as that from one sample to the next, as no physics is, and it is counted as noise"
)


class Louder(Restated):
    """A system whose noise is told by what is left of its samples.

    Parameters
    ----------
    stated
        As it is stated.
    times
        Variance of the noise over what is stated, one array for each bundle, shape (channels,).
    known_from
        From how many independent values that is known, one for each bundle.
    """

    def __init__(self, stated: System, times: Sequence[Array], known_from: Sequence[int]) -> None:
        super().__init__(stated)
        self.bundles = tuple(
            replace(one, covariance=one.covariance * np.sqrt(np.outer(by, by)), noise_from=count)
            for one, by, count in zip(stated.bundles, times, known_from, strict=True)
        )
        self.times = np.sqrt(np.concatenate(times))
        """Sigma of the noise over what is stated, shape (channels of all bundles,)."""

    def beside(self, point: Point) -> System | None:
        """The system with the noise that is left about what explains best; None: about as much.

        What sticks or lags is rough as well, where samples are few: with that on, less is left.

        Parameters
        ----------
        point
            What explains best.
        """
        told = louder_than_stated(self.stated, point)
        if told is None:
            return self.stated
        return told if bool((told.times < self.times / QUIETER).any()) else None

    @property
    def note(self) -> str:
        """See `Restated`."""
        ends = [f"{one:.2f}" for one in (self.times.min(), self.times.max())]
        return LOUDER.format(times=" to ".join(dict.fromkeys(ends)))


def louder_than_stated(system: System, point: Point) -> Louder | None:
    """The system with the noise that its samples have about a simulation; None: as it states it.

    Parameters
    ----------
    system
        What is simulated.
    point
        With which little but noise is left, or what is left is smooth.
    """
    (predicted,) = system.simulate([point], list)
    pairs = zip(system.bundles, predicted, strict=True)
    told = [_told(bundle, seen) for bundle, seen in pairs]
    surprise = np.concatenate([one.surprise for one in told])
    together = float(np.square(surprise).sum()) - len(surprise)
    often = len(surprise) > 0 and together > OFTEN * np.sqrt(2.0 * len(surprise))
    if often or any(one.is_off for one in told):
        return Louder(system, [one.times for one in told], [one.known_from for one in told])
    return None


class _Told(NamedTuple):
    """What the samples of a bundle tell of its noise.

    Attributes
    ----------
    times
        Variance over what is stated, shape (channels,).
    known_from
        From how many independent values.
    surprise
        Of channels whose noise was taken from few values: by how many standard deviations it is
        off.
    is_off
        Whether a variance that is stated as known is larger.
    """

    times: Array
    known_from: int
    surprise: Array
    is_off: bool


def _told(bundle: Bundle, seen: Array) -> _Told:
    as_stated = _Told(np.ones(len(bundle.names)), bundle.noise_from, np.zeros(0), is_off=False)
    count = int(np.sum([one.holds(bundle.t_s) for one in bundle.segments if not one.sealed]))
    if bundle.jitter is not None or bundle.late is not None or count < LEAST_SAMPLES:
        return as_stated
    rough, fourth = (roughness(bundle, seen, one) for one in ORDERS)
    freedom = count / WORTH
    same = np.abs(fourth - rough) < SAME * np.sqrt(2.0 / count) * rough
    if bundle.noise_from:
        before = max(bundle.noise_from - 2.0, 3.0)
        off = (rough - 1.0) / np.sqrt(2.0 / freedom + 2.0 / before)
        anew = (before + freedom * rough) / (before + freedom)
        times = np.where(same, anew, 1.0)
        return _Told(times, round(before + freedom), np.where(same, off, 0.0), is_off=False)
    off = (rough - 1.0) / np.sqrt(2.0 / freedom)
    is_off = same & (off > SURE) & (rough > LEAST) & (rough < MOST)
    times, known_from = np.where(is_off, rough, 1.0), round(freedom) if is_off.any() else 0
    return _Told(times, known_from, np.zeros(0), is_off=bool(is_off.any()))


def roughness(bundle: Bundle, seen: Array, order: int = ORDERS[0]) -> Array:
    """The variance of noise by differences, over what is stated, shape (channels,).

    Parameters
    ----------
    bundle, seen
        What was recorded, and what is simulated of it, shape (n, channels).
    order
        Of the differences.
    """
    left = (bundle.value - seen) / sigmas_of(bundle)
    pieces = [left[one.holds(bundle.t_s)] for one in bundle.segments if not one.sealed]
    rough = np.concatenate([np.diff(one, order, axis=0) for one in pieces])
    rough = rough[np.isfinite(rough).all(axis=1)]
    return np.mean(rough**2, axis=0) / SQUARES[order] if len(rough) else np.ones(left.shape[1])
