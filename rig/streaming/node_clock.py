"""A node's own clock as its values tell it: t = a + b n (protocol note, section 9).

Adapters and operating systems deliver bytes late and in batches, never early: so the earliest
arrivals tell the time, and the line below all of them is the node's clock.
"""

from collections import deque

import numpy as np

BLOCK_S = 0.5
"""Of each block of this length the earliest arrival, against the nominal rate, is kept."""

BLOCKS = 60
"""Blocks that are remembered: the crystal drifts with temperature, slowly."""

BLOCKS_FOR_RATE = 6
"""Below this the rate is taken as nominal: 100 ppm are 0.2 ms after 2 s."""


class NodeClock:
    """When each value of a stream arrived, in the node's own steps.

    Parameters
    ----------
    period_s
        Between two values, nominal.
    """

    def __init__(self, period_s: float) -> None:
        self._period_s = period_s
        self._blocks: deque[tuple[int, float]] = deque(maxlen=BLOCKS)
        self._block = -1
        self._per_block = max(1, round(BLOCK_S / period_s))
        self._slope_s = 0.0
        self._offset_s = 0.0

    @property
    def period_s(self) -> float:
        """Between two values, as fitted."""
        return self._period_s + self._slope_s

    @property
    def known(self) -> bool:
        """Whether anything has arrived."""
        return bool(self._blocks)

    def add(self, number: int, arrived_s: float) -> None:
        """Value `number` had arrived by this time."""
        late_s = arrived_s - number * self._period_s
        block = number // self._per_block
        if block != self._block or not self._blocks:
            self._block = block
            self._blocks.append((number, late_s))
            self._fit()
        elif late_s - self._slope_s * number < (
            self._blocks[-1][1] - self._slope_s * self._blocks[-1][0]
        ):
            self._blocks[-1] = (number, late_s)
            self._offset_s = min(self._offset_s, late_s - self._slope_s * number)

    def arrival_s(self, number: int) -> float:
        """When a value's last byte came."""
        return self._offset_s + number * self.period_s

    def _fit(self) -> None:
        numbers = np.array([number for number, _ in self._blocks], dtype=float)
        late_s = np.array([late for _, late in self._blocks])
        # The newest block has just begun: its earliest arrival is not known yet.
        if len(numbers) > BLOCKS_FOR_RATE:
            rows, columns = np.triu_indices(len(numbers) - 1, 1)
            steps = (late_s[columns] - late_s[rows]) / (numbers[columns] - numbers[rows])
            self._slope_s = float(np.median(steps))
        self._offset_s = float(np.min(late_s - self._slope_s * numbers))
