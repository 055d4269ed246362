"""What a simulated force cell and its converter make of a tension: filter, sampling, noise.

The chain is that of the electronics (protocol note, sections 8 and 9): first-order filter (ASF),
averaging to the output rate (ICR), on the node's own crystal. A value is a function of the seed,
the node and the number of the sample alone, so it does not matter when, how often or in which
order values are asked for.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from rig.amplifier.frame import FULL_SCALE_24
from rig.amplifier.profile import Profile
from rig.amplifier.scaling import Scaling

Array = NDArray[np.float64]
TensionAt = Callable[[Array], Array]
"""Times of the run in s, shape (n,), to tensions in N, shape (n,)."""

BLOCK = 256
"""Values are made this many at a time."""

WARM_UP_TIME_CONSTANTS = 15.0
"""The filter starts this long before a block, so that its start is forgotten to 3e-7."""

STANDSTILL_S = 0.1
STANDSTILL_MV_PER_V = 5e-4
"""An input that moved less than this within `STANDSTILL_S` stands still."""

ADC_OVERFLOW = 4
STANDSTILL = 8


@dataclass(frozen=True)
class Crystal:
    """A node's own clock.

    Attributes
    ----------
    power_on_s
        When the node began to sample, on the rig's clock.
    phase
        Of its first sample, in sampling periods, 0 to 1.
    ppm
        How much longer its periods are than nominal, in parts per million.
    """

    power_on_s: float = 0.0
    phase: float = 0.0
    ppm: float = 0.0


class NodeSignal:
    """The stream of values inside one node.

    Parameters
    ----------
    tension_at
        The tension at times of the run.
    scaling
        Of the cell, 24-bit digits at NOV=0.
    profile
        Rates and filters.
    crystal
        The node's clock.
    noise_n
        Standard deviation of one value, in N.
    key
        Seed and node number: the key of the noise.
    """

    def __init__(
        self,
        tension_at: TensionAt,
        scaling: Scaling,
        profile: Profile,
        crystal: Crystal,
        noise_n: float,
        key: tuple[int, int],
    ) -> None:
        self._tension_at = tension_at
        self._scaling = scaling
        self._profile = profile
        self._crystal = crystal
        self._noise_digits = noise_n * abs(scaling.digits(1.0) - scaling.digits(0.0))
        self._key = np.array(key, dtype=np.uint64)
        self._internal_s = profile.period_s(0) * (1.0 + 1e-6 * crystal.ppm)
        self._first_s = crystal.power_on_s + crystal.phase * self._internal_s
        self._origin_s = math.inf
        self._periods_s = tuple(
            self._ratio(icr) * self._internal_s for icr in range(len(profile.rates_per_s))
        )
        self._blocks: dict[tuple[float, int, int, int], tuple[list[int], list[int]]] = {}

    def begin(self, origin_s: float) -> None:
        """Let the run's time start at `origin_s`; before it the platform rests."""
        self._origin_s = origin_s

    def period_s(self, icr: int) -> float:
        """True time between two values."""
        return self._periods_s[icr]

    def number_at(self, t_s: float, icr: int) -> int:
        """Number of the newest value at a time; 0 is the first."""
        return max(0, math.floor((t_s - self._first_s) / self.period_s(icr)))

    def sampled_s(self, number: int, icr: int) -> float:
        """When a value is ready."""
        return self._first_s + number * self.period_s(icr)

    def value(self, number: int, icr: int, asf: int) -> tuple[int, int]:
        """Digits (24 bit, NOV=0) and status bits of one value."""
        block, place = divmod(number, BLOCK)
        key = (self._origin_s, icr, asf, block)
        made = self._blocks.get(key)
        if made is None:
            if len(self._blocks) > 3:
                self._blocks.clear()
            made = self._blocks[key] = self._make(*key)
        return made[0][place], made[1][place]

    def _ratio(self, icr: int) -> int:
        return round(self._profile.rates_per_s[0] / self._profile.rates_per_s[icr])

    def _make(self, origin_s: float, icr: int, asf: int, block: int) -> tuple[list[int], list[int]]:
        ratio = self._ratio(icr)
        first = (block * BLOCK - 1) * ratio + 1
        index = np.arange(first, first + BLOCK * ratio)
        signal = self._filtered(index, origin_s, asf).reshape(BLOCK, ratio).mean(axis=1)
        ready = index[ratio - 1 :: ratio]
        before = ready - round(STANDSTILL_S / self._internal_s)
        moved = np.abs(self._input(ready, origin_s) - self._input(before, origin_s))
        noise = np.random.Generator(
            np.random.Philox(key=self._key, counter=np.array([0, block, icr, 0], np.uint64))
        ).standard_normal(BLOCK)
        digits = signal + self._noise_digits * noise
        limit = self._profile.overflow_mv_per_v * self._scaling.digits_per_mv_per_v
        overflow = np.abs(digits) > limit
        still = moved < STANDSTILL_MV_PER_V * self._scaling.digits_per_mv_per_v
        clamped = np.clip(np.rint(digits), -limit, min(limit, FULL_SCALE_24)).astype(int)
        status = ADC_OVERFLOW * overflow + STANDSTILL * still
        return clamped.tolist(), status.tolist()

    def _input(self, index: NDArray[np.int64], origin_s: float) -> Array:
        """Noiseless digits at the converter's own samples."""
        times = self._first_s + index * self._internal_s
        run_s = np.maximum(times - origin_s, 0.0)
        tension = self._tension_at(run_s)
        scaling = self._scaling
        zero = scaling.digits(0.0)
        return np.asarray(zero + (scaling.digits(1.0) - zero) * tension, dtype=np.float64)

    def _filtered(self, index: NDArray[np.int64], origin_s: float, asf: int) -> Array:
        cut_off_hz = self._profile.cut_offs_hz[asf]
        if cut_off_hz is None:
            return self._input(index, origin_s)
        time_constant_s = 1.0 / (2.0 * math.pi * cut_off_hz)
        warm_up = math.ceil(WARM_UP_TIME_CONSTANTS * time_constant_s / self._internal_s)
        longer = np.arange(index[0] - warm_up, index[-1] + 1)
        keep = math.exp(-self._internal_s / time_constant_s)
        signal = self._input(longer, origin_s)
        # Without SciPy, whose import would keep the first value waiting for a second.
        smooth = list(accumulate(signal.tolist(), lambda y, x: keep * y + (1.0 - keep) * x))
        return np.array(smooth[warm_up:])
