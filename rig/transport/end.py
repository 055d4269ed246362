"""What the ends of a line have in common: settings, clock, name, and draining to silence."""

from abc import ABC, abstractmethod

from cdpr8.clock import Clock
from rig.transport.line import MAX_DRAIN_S, LineSettings, Received, Transport


class LineEnd(ABC):
    """One end of a line.

    Parameters
    ----------
    line
        Speed and framing.
    clock
        Of all times given and returned.
    name
        What a user calls this line.
    """

    def __init__(self, line: LineSettings, clock: Clock, name: str) -> None:
        # Attributes, not properties: the bus looks at them a thousand times a second.
        self.line = line
        self.clock = clock
        self.name = name

    @abstractmethod
    def read(self, count: int, deadline_s: float) -> Received:
        """Exactly `count` bytes, or what has come by `deadline_s`."""

    @abstractmethod
    def take(self) -> Received:
        """What has come and was not read; does not wait."""

    def discard(self) -> bytes:
        """The bytes of `take`, for callers that have no use for them but to note them."""
        return self.take().data

    def drain(self, quiet_s: float) -> bytes:
        """Take off, and return, what comes until nothing has come for `quiet_s`."""
        data = self.discard()
        end_s = self.clock.monotonic_s() + MAX_DRAIN_S
        while (now_s := self.clock.monotonic_s()) < end_s:
            received = self.read(1, now_s + quiet_s)
            if not received.data:
                break
            data += received.data + self.discard()
        return data


class Around:
    """A line around another: the same settings, clock and name.

    Parameters
    ----------
    inner
        The line.
    """

    def __init__(self, inner: Transport) -> None:
        self._inner = inner

    @property
    def line(self) -> LineSettings:
        """Speed and framing."""
        return self._inner.line

    @property
    def clock(self) -> Clock:
        """The inner line's clock."""
        return self._inner.clock

    @property
    def name(self) -> str:
        """What a user calls this line."""
        return self._inner.name

    def reopen(self) -> None:
        """Open the inner line again."""
        self._inner.reopen()

    def close(self) -> None:
        """Close the inner line."""
        self._inner.close()
