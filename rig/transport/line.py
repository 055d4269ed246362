"""What every transport promises, and the settings of an asynchronous line."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol

from cdpr8.clock import Clock
from cdpr8.errors import DeviceError


@dataclass(frozen=True)
class LineSettings:
    """Speed and framing of the line: 1 start bit, 8 data bits, perhaps a parity bit, 1 stop bit.

    Source: protocol note, section 1 (AD104 manual, pp. 17 and 19).
    """

    baud: int = 115200
    parity: Literal["even", "none"] = "even"

    @property
    def bits_per_char(self) -> int:
        """11 with parity, 10 without."""
        return 11 if self.parity == "even" else 10

    @cached_property  # the bus looks at it a thousand times a second
    def char_s(self) -> float:
        """How long one character occupies the line, in s."""
        return self.bits_per_char / self.baud

    def __str__(self) -> str:
        return f"{self.baud} baud 8{'E' if self.parity == 'even' else 'N'}1"


@dataclass(frozen=True, slots=True)
class Received:
    """Bytes that came.

    Attributes
    ----------
    data
        What came, in order; may be shorter than asked for.
    last_byte_s
        When its last byte had come, on the transport's clock; the time of giving up where
        nothing came.
    damaged
        Whether the receiver noticed a parity or framing error in any of these bytes.
    """

    data: bytes
    last_byte_s: float
    damaged: bool = False


class LineLostError(DeviceError):
    """The port vanished under an open line: unplugged, or its adapter reset."""


class Transport(Protocol):
    """A half-duplex line with one master: us.

    Every call may raise `cdpr8.errors.DeviceError` when the line is gone.
    """

    @property
    def line(self) -> LineSettings:
        """Speed and framing."""
        ...

    @property
    def clock(self) -> Clock:
        """The clock of all times given and returned."""
        ...

    @property
    def name(self) -> str:
        """What a user calls this line."""
        ...

    def write(self, data: bytes) -> None:
        """Send bytes; returns without waiting for the line."""
        ...

    def read(self, count: int, deadline_s: float) -> Received:
        """Exactly `count` bytes, or what has come by `deadline_s`."""
        ...

    def take(self) -> Received:
        """What has come and was not read; does not wait."""
        ...

    def discard(self) -> bytes:
        """The bytes of `take`."""
        ...

    def drain(self, quiet_s: float) -> bytes:
        """Throw away, and return, what comes until nothing has come for `quiet_s`."""
        ...

    def reopen(self) -> None:
        """Open the same line again after a `LineLostError`.

        Raises
        ------
        DeviceError
            It is not there yet.
        """
        ...

    def close(self) -> None:
        """Give the line back."""
        ...


MAX_DRAIN_S = 2.0
"""A line that never falls silent (a node streaming, noise) is drained no longer than this."""
