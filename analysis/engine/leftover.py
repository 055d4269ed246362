"""What is left of the samples, where that is not the noise that is stated: it is said.

Noise that goes on from one sample to the next looks like causes that are slow; noise that is stated
too large hides what is small; and one sample that is far off is nothing that any law explains.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.louder import LEAST_SAMPLES, roughness
from analysis.engine.system import Point, System
from analysis.engine.whiten import sigmas_of

WHITE, ALL = 0.5, 1.5
"""Of what is left, white noise holds less than the first where it is coloured; of what is more than
the second, it may be something left out."""

COLOURED = (
    "the noise of {name!r} is not white: from one sample to the next it is {times:.2f} times what "
    "is stated, and so there is more of it in what is slow. A slow cause may be no more than that"
)

QUIET = 0.35
"""Noise that leaves less than this of its stated variance is stated too large."""

HIDDEN = (
    "what is left of {name!r} is {times:.2f} times the noise that is stated: stated too large, it "
    "hides what is small"
)

FAR, APART, FEW = 8.0, 0.5, 0.01
"""A sample is an outlier where it is off by so many times what is left on average, those beside it
by less than the second share of that; and where no more than the last share of all samples are."""

ODD = (
    "{count} of {of} samples of {name!r} are far off by themselves, first that at {t_s:g} s, by "
    "{sigmas:.0f} sigmas of its noise: no law explains that, and it counts"
)


class _Left(NamedTuple):
    """What is left of a channel, in its noise, shape (n,), and its white part, squared."""

    name: str
    t_s: Array
    left: Array
    white: float


def leftover(system: System, point: Point, *, explained: bool) -> tuple[str, ...]:
    """What is odd about what is left, a sentence for each.

    Parameters
    ----------
    system
        What is simulated.
    point
        What explains best.
    explained
        No more than noise is left with it.
    """
    (predicted,) = system.simulate([point], list)
    found: list[str] = []
    for bundle, seen in zip(system.bundles, predicted, strict=True):
        held = [one.holds(bundle.t_s) for one in bundle.segments if not one.sealed]
        if int(np.sum(held)) < LEAST_SAMPLES:
            continue
        inside = np.any(held, axis=0)
        left, white = (bundle.value - seen) / sigmas_of(bundle), roughness(bundle, seen)
        for k, name in enumerate(bundle.names):
            one = _Left(name, bundle.t_s[inside], left[inside, k], float(white[k]))
            told = explained and bundle.late is None
            found += [*_outliers(one), *(_unlike_noise(one) if told else ())]
    return tuple(found)


def _unlike_noise(one: _Left) -> Iterator[str]:
    every = float(np.nanmean(one.left**2))
    if one.white < WHITE * every < WHITE * ALL:
        yield COLOURED.format(name=one.name, times=np.sqrt(one.white))
    elif every < QUIET:
        yield HIDDEN.format(name=one.name, times=np.sqrt(every))


def _outliers(one: _Left) -> Iterator[str]:
    size = np.abs(np.nan_to_num(one.left))
    usual = max(float(np.median(size)) / 0.6745, 1.0)
    beside = np.maximum(np.r_[0.0, size[:-1]], np.r_[size[1:], 0.0])
    far = np.flatnonzero((size > FAR * usual) & (beside < APART * size))
    if 0 < len(far) <= max(FEW * len(size), 1.0):
        yield ODD.format(
            count=len(far), of=len(size), name=one.name, t_s=one.t_s[far[0]], sigmas=size[far[0]]
        )
