"""Another program's clock tied to the run's, by when its lines arrive.

A line comes late, never early, so of the last `WINDOW_S` the quickest tells how the two clocks
stand.
"""

from collections import deque

WINDOW_S = 10.0
"""Clocks off by 100 ppm part by 1 ms in this time."""


class ArrivalClock:
    """A log's own clock against the run's, by the quickest of its last lines."""

    def __init__(self) -> None:
        self._late: deque[tuple[float, float]] = deque()
        self._last_s = -float("inf")

    def add(self, log_s: float, arrived_s: float) -> None:
        """A line of the log's time `log_s` had come by `arrived_s`."""
        if log_s < self._last_s:
            self._late.clear()  # begun anew
        self._last_s = log_s
        late_s = arrived_s - log_s
        while self._late and self._late[-1][1] >= late_s:
            self._late.pop()
        self._late.append((arrived_s, late_s))
        while self._late[0][0] < arrived_s - WINDOW_S:
            self._late.popleft()

    def run_s(self, log_s: float) -> float:
        """A time of the log on the run's clock."""
        return log_s + self._late[0][1]
