"""Whether something begins at once, where parameters alone had foretold all until then.

A motion that grows of itself comes out of the noise slowly; a clamp that slips, a blow, or a cell
that jumps is there from one period to the next. The first may have been left out of nothing; the
second was left out.
"""

from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Point, System

BLOCK = 10
"""Samples that are looked at together."""

BEFORE, AFTER = 3.0, 30.0
"""What begins at once leaves no more than the first of a squared sample's noise, on average of a
block, and two blocks later more than the second; what grows takes longer from the one to the other.
"""


class Begins(NamedTuple):
    """What begins at once.

    Attributes
    ----------
    t_s
        When.
    channel
        Where it is loudest then.
    """

    t_s: float
    channel: str


def begins(system: System, point: Point, after: float) -> Begins | None:
    """What begins at once after a share of the time; None: nothing does.

    Parameters
    ----------
    system
        What is simulated.
    point
        Foretells all until then.
    after
        A share of the time that it does foretell; what is told does not lie before.
    """
    samples = Samples(system, everything=True)
    (residual,) = samples.residuals([point])
    found: list[tuple[float, float, str]] = []
    for bundle, (t_s, left) in zip(system.bundles, samples.parts(residual), strict=True):
        start_s = bundle.t_s[0] + after * (bundle.t_s[-1] - bundle.t_s[0])
        for name, one in zip(bundle.names, left.T, strict=True):
            first, loud = _jumps(one[t_s >= start_s])
            if first is not None:
                found.append((float(t_s[t_s >= start_s][first]), -loud, name))
    if not found:
        return None
    earliest = min(found)[0]
    # One blow reaches all channels: within a few blocks of the first it is the same.
    near = [one for one in found if one[0] <= earliest + _block_s(system)]
    _, _, name = min(near, key=lambda one: one[1])
    return Begins(earliest, name)


def _jumps(left: Array) -> tuple[int | None, float]:
    """The first sample of the block at which a channel jumps, and how loud it is then."""
    count = len(left) // BLOCK
    power = np.mean(left[: count * BLOCK].reshape(count, BLOCK) ** 2, axis=1)
    loud = np.maximum(power[1:-1], power[2:]) if count > 2 else np.zeros(0)
    if not len(loud):
        return None, 0.0
    # From the first block above noise on, nothing counts as quiet before.
    quiet = np.maximum.accumulate(power[:-2]) <= BEFORE
    places = np.flatnonzero(quiet & (loud > AFTER))
    if not len(places):
        return None, 0.0
    first = int(places[0])
    later = first + 1 if power[first + 1] > BEFORE else first + 2
    return later * BLOCK, float(loud[first])


def _block_s(system: System) -> float:
    """How long two blocks of the fastest channel take, in s."""
    pace = max((len(one.t_s) - 1) / (one.t_s[-1] - one.t_s[0]) for one in system.bundles)
    return float(2.0 * BLOCK / pace)
