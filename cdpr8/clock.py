"""Time, passed in and never looked up: real for a machine, virtual for simulation and fuzzing."""

import time
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Protocol


class Clock(Protocol):
    """Seconds of a monotonic clock, the wall time beside it, and a way to wait."""

    def monotonic_s(self) -> float:
        """Seconds since an arbitrary origin; never runs backwards."""
        ...

    def wall(self) -> datetime:
        """Wall-clock time (UTC); may be stepped."""
        ...

    def sleep_until(self, monotonic_s: float) -> None:
        """Return once `monotonic_s` has come; at once if it has passed."""
        ...


class RealClock:
    """The operating system's clocks."""

    def monotonic_s(self) -> float:
        """Seconds of CLOCK_MONOTONIC."""
        return time.monotonic_ns() * 1e-9

    def wall(self) -> datetime:
        """System time (UTC)."""
        return datetime.now(UTC)

    def sleep_until(self, monotonic_s: float) -> None:
        """Sleep until `monotonic_s`."""
        wait = monotonic_s - self.monotonic_s()
        if wait > 0:
            time.sleep(wait)


@dataclass
class VirtualClock:
    """A clock that moves only when told, so that hours pass in seconds and a seed repeats a run.

    Parameters
    ----------
    epoch
        The wall time at ``monotonic_s == 0``.
    """

    epoch: datetime
    now_s: float = 0.0

    def monotonic_s(self) -> float:
        """Virtual seconds since the epoch."""
        return self.now_s

    def wall(self) -> datetime:
        """Virtual wall time (UTC)."""
        return datetime.fromtimestamp(self.epoch.timestamp() + self.now_s, UTC)

    def sleep_until(self, monotonic_s: float) -> None:
        """Move the clock forward to `monotonic_s`."""
        self.now_s = max(self.now_s, monotonic_s)

    def advance(self, seconds: float) -> None:
        """Move the clock forward by `seconds`."""
        self.now_s += seconds
