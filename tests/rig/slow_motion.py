"""A clock whose seconds take longer than real ones: the computer is given so much more time.

What a recording over a pseudo-terminal claims (rates, losses, times) holds in the clock's seconds.
In slow motion it holds on a computer that is slower, or that other programs share, as well.
"""

from datetime import UTC, datetime, timedelta

from rig_stand_ins import at_origin

from cdpr8.clock import RealClock
from rig.machine import Machine

PACE = 5.0
"""Real seconds for one of a slow clock."""


class SlowMotion(RealClock):
    """The computer's clock, at its own pace until it is slowed down.

    Parameters
    ----------
    pace
        Real seconds for one of this clock, from `slow_down` on.
    """

    def __init__(self, pace: float = PACE) -> None:
        self.pace = pace
        # Real and own seconds at the last change, and real for own ones since: read as one.
        self._course = (0.0, 0.0, 1.0)
        self._began = datetime.now(UTC) - timedelta(seconds=self.monotonic_s())

    def slow_down(self) -> None:
        """From now on, run slowly; the time goes on from where it is."""
        real_s = super().monotonic_s()
        self._course = (real_s, self._own_s(real_s), self.pace)

    def monotonic_s(self) -> float:
        """Own seconds."""
        return self._own_s(super().monotonic_s())

    def wall(self) -> datetime:
        """Wall time that goes as slowly."""
        return self._began + timedelta(seconds=self.monotonic_s())

    def sleep_until(self, monotonic_s: float) -> None:
        """Sleep until own time `monotonic_s`."""
        real_s, own_s, pace = self._course
        RealClock().sleep_until(real_s + (monotonic_s - own_s) * pace)

    def _own_s(self, real_s: float) -> float:
        since_s, own_s, pace = self._course
        return own_s + (real_s - since_s) / pace


def slowed(machine: Machine, clock: SlowMotion) -> Machine:
    """The machine, whose run goes in slow motion; the setting up before it does not."""
    at_origin(machine, lambda _: clock.slow_down())
    return machine
