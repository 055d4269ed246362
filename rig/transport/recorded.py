"""Recorded bytes: a line's traffic written down, and played back as a line.

A trace is text, one call a line (JSON): what was written, and what each read gave with its times.
A conversation with real amplifiers, once captured, repeats without them.
"""

import json
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cdpr8.clock import VirtualClock
from cdpr8.errors import DataError
from rig.transport.end import Around, LineEnd
from rig.transport.line import LineSettings, Received, Transport


class TracingTransport(Around):
    """Passes everything on and writes it down.

    Parameters
    ----------
    inner
        The line.
    path
        The trace; appended to.
    """

    def __init__(self, inner: Transport, path: Path) -> None:
        super().__init__(inner)
        self._file = path.open("a", encoding="utf-8")
        line = inner.line
        self._note("line", baud=line.baud, parity=line.parity, name=inner.name)

    def write(self, data: bytes) -> None:
        """Send bytes."""
        self._note("write", data=data.hex())
        self._inner.write(data)

    def read(self, count: int, deadline_s: float) -> Received:
        """Exactly `count` bytes, or what has come by `deadline_s`."""
        return self._noted("read", self._inner.read(count, deadline_s))

    def take(self) -> Received:
        """What has come."""
        return self._noted("take", self._inner.take())

    def discard(self) -> bytes:
        """Throw away, and return, what has come."""
        data = self._inner.discard()
        self._note("discard", data=data.hex())
        return data

    def drain(self, quiet_s: float) -> bytes:
        """Throw away, and return, what comes until `quiet_s` of silence."""
        data = self._inner.drain(quiet_s)
        self._note("drain", data=data.hex())
        return data

    def close(self) -> None:
        """Close the line and the trace."""
        self._inner.close()
        self._file.close()

    def _noted(self, call: str, received: Received) -> Received:
        self._note(
            call,
            data=received.data.hex(),
            last_s=received.last_byte_s,
            damaged=received.damaged,
        )
        return received

    def _note(self, call: str, **what: Any) -> None:
        now_s = self._inner.clock.monotonic_s()
        self._file.write(json.dumps({"call": call, "t_s": now_s, **what}) + "\n")


class RecordedTransport(LineEnd):
    """Plays a trace back; the caller must do what was done then.

    Parameters
    ----------
    lines
        Of the trace; a torn last one is left out.
    clock
        Moved to the times of the trace.
    """

    def __init__(self, lines: Iterable[str], clock: VirtualClock) -> None:
        self._calls = deque(json.loads(line) for line in lines if line.endswith("\n"))
        self._time = clock
        head = self._calls.popleft()
        line = LineSettings(head["baud"], head["parity"])
        super().__init__(line, clock, f"recorded {head['name']}")
        clock.sleep_until(head["t_s"])

    @property
    def over(self) -> bool:
        """Whether the whole trace has been played."""
        return not self._calls

    def write(self, data: bytes) -> None:
        """Send what was sent then.

        Raises
        ------
        DataError
            Something else was sent then.
        """
        was = self._next("write")
        if bytes.fromhex(was["data"]) != data:
            raise DataError(f"{data!r} is sent where the trace has {bytes.fromhex(was['data'])!r}")

    def read(self, count: int, deadline_s: float) -> Received:
        """What came then, at its time."""
        del count, deadline_s
        return self._received("read")

    def take(self) -> Received:
        """What had come then."""
        return self._received("take")

    def discard(self) -> bytes:
        """What was thrown away then."""
        return bytes.fromhex(self._next("discard")["data"])

    def drain(self, quiet_s: float) -> bytes:
        """What was drained then."""
        del quiet_s
        return bytes.fromhex(self._next("drain")["data"])

    def reopen(self) -> None:
        """Nothing to open."""

    def close(self) -> None:
        """Nothing to give back."""

    def _received(self, call: str) -> Received:
        was = self._next(call)
        return Received(bytes.fromhex(was["data"]), was["last_s"], was["damaged"])

    def _next(self, call: str) -> dict[str, Any]:
        if not self._calls:
            raise DataError(f"the trace is over, and a {call} was asked for", where=self.name)
        was: dict[str, Any] = self._calls.popleft()
        if was["call"] != call:
            raise DataError(f"a {call} is asked for where the trace has a {was['call']}")
        self._time.sleep_until(was["t_s"])
        return was
