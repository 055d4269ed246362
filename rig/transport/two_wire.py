"""A line that hears itself: 2-wire adapters echo what is sent, and the echo is verified."""

from rig.transport.end import Around
from rig.transport.line import Received, Transport


class TwoWire(Around):
    """Swallows exactly the bytes that were sent.

    An echo that differs is a collision or a broken line: the answer after it counts as damaged.

    Parameters
    ----------
    inner
        The line with the echo.
    """

    def __init__(self, inner: Transport) -> None:
        super().__init__(inner)
        self._owed = b""
        self._broken = False

    def write(self, data: bytes) -> None:
        """Send bytes; their echo is expected."""
        self._inner.write(data)
        self._owed += data

    def read(self, count: int, deadline_s: float) -> Received:
        """Exactly `count` bytes after the echo, or what has come by `deadline_s`."""
        if self._owed:
            echo = self._inner.read(len(self._owed), deadline_s)
            self._check(echo.data, echo.damaged)
            if len(echo.data) < len(self._owed):
                self._owed = b""
                return Received(b"", echo.last_byte_s, True)
            self._owed = b""
        received = self._inner.read(count, deadline_s)
        broken, self._broken = self._broken, False
        return Received(received.data, received.last_byte_s, received.damaged or broken)

    def take(self) -> Received:
        """What has come beyond the echo."""
        came = self._inner.take()
        data = self._beyond_echo(came.data)
        broken, self._broken = self._broken, False
        return Received(data, came.last_byte_s, came.damaged or broken)

    def discard(self) -> bytes:
        """Throw away, and return, what has come beyond the echo."""
        return self._beyond_echo(self._inner.discard())

    def drain(self, quiet_s: float) -> bytes:
        """Throw away, and return, what comes beyond the echo until `quiet_s` of silence."""
        came = self._beyond_echo(self._inner.drain(quiet_s))
        self._owed, self._broken = b"", False
        return came

    def reopen(self) -> None:
        """Open the inner line again."""
        self._owed, self._broken = b"", False
        super().reopen()

    def _beyond_echo(self, data: bytes) -> bytes:
        echo, rest = data[: len(self._owed)], data[len(self._owed) :]
        self._check(echo, damaged=False)
        self._owed = self._owed[len(echo) :]
        return rest

    def _check(self, echo: bytes, damaged: bool) -> None:
        self._broken |= damaged or echo != self._owed[: len(echo)]
