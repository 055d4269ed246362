"""A line in memory: no operating system, exact byte times, on any clock.

On a virtual clock the time passes that the bytes need at the line's speed, so hours of bus time
run in seconds and a seed repeats a run to the byte. On a real clock it serves where there are no
pseudo-terminals.
"""

from collections import deque
from dataclasses import dataclass
from typing import Protocol

from cdpr8.clock import Clock
from rig.transport.end import LineEnd
from rig.transport.line import LineSettings, Received

AHEAD_S = 0.02
"""The far end is asked for what it sends within this time, then for more."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes that follow each other on the line.

    Attributes
    ----------
    data
        The bytes.
    first_s
        When the first of them has arrived whole.
    char_s
        Time from one to the next.
    damaged
        Whether the receiver sees a parity or framing error in them.
    """

    data: bytes
    first_s: float
    char_s: float
    damaged: bool = False

    @property
    def last_s(self) -> float:
        """When the last byte has arrived whole."""
        return self.first_s + (len(self.data) - 1) * self.char_s

    def arrived(self, by_s: float) -> int:
        """How many of the bytes have arrived by `by_s`."""
        if self.last_s <= by_s:
            return len(self.data)
        if self.first_s > by_s:
            return 0
        return min(len(self.data), int((by_s - self.first_s) / self.char_s) + 1)

    def split(self, count: int) -> tuple["Chunk", "Chunk"]:
        """The first `count` bytes, and the rest."""
        rest_s = self.first_s + count * self.char_s
        return (
            Chunk(self.data[:count], self.first_s, self.char_s, self.damaged),
            Chunk(self.data[count:], rest_s, self.char_s, self.damaged),
        )


class FarEnd(Protocol):
    """What hangs on the other end of the line."""

    def hear(self, data: bytes, start_s: float) -> None:
        """Bytes that the master starts to send at `start_s`, at the line's speed."""
        ...

    def speak(self, until_s: float) -> deque[Chunk]:
        """The answers under way, complete up to `until_s`; the reader takes them off the left."""
        ...


class MemoryTransport(LineEnd):
    """One end of a line in memory.

    Parameters
    ----------
    far_end
        What hears and answers.
    line
        Speed and framing.
    clock
        Moved (virtual) or waited on (real) while bytes travel.
    """

    def __init__(
        self, far_end: FarEnd, line: LineSettings, clock: Clock, name: str = "memory"
    ) -> None:
        super().__init__(line, clock, name)
        self._far_end = far_end

    def write(self, data: bytes) -> None:
        """Start to send `data` now."""
        self._far_end.hear(data, self.clock.monotonic_s())

    def read(self, count: int, deadline_s: float) -> Received:
        """Exactly `count` bytes, or what has come by `deadline_s`."""
        data = b""
        damaged = False
        last_s = deadline_s
        # In steps: a node that streams must not be asked for what a later command will stop.
        until_s = min(deadline_s, self.clock.monotonic_s() + AHEAD_S)
        pending = self._far_end.speak(until_s)
        while len(data) < count:
            ready = min(pending[0].arrived(until_s), count - len(data)) if pending else 0
            if ready == 0:
                if until_s >= deadline_s:
                    break
                until_s = min(deadline_s, until_s + AHEAD_S)
                pending = self._far_end.speak(until_s)
                continue
            chunk = _taken_off(pending, ready)
            data += chunk.data
            damaged |= chunk.damaged
            last_s = chunk.last_s
        self.clock.sleep_until(last_s if len(data) == count else deadline_s)
        return Received(data, last_s, damaged)

    def take(self) -> Received:
        """What has come and was not read."""
        now_s = last_s = self.clock.monotonic_s()
        pending = self._far_end.speak(now_s)
        data = b""
        damaged = False
        while pending and (ready := pending[0].arrived(now_s)):
            chunk = _taken_off(pending, ready)
            data += chunk.data
            damaged |= chunk.damaged
            last_s = chunk.last_s
        return Received(data, last_s, damaged)

    def reopen(self) -> None:
        """Nothing to open: memory is always there."""

    def close(self) -> None:
        """Nothing to give back."""


def _taken_off(pending: deque[Chunk], count: int) -> Chunk:
    """The first `count` bytes of what is pending, no more than its first chunk has."""
    if count < len(pending[0].data):
        chunk, pending[0] = pending[0].split(count)
        return chunk
    return pending.popleft()
