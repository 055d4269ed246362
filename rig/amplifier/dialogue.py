"""One question, one answer: the master's rule of the line (section 2).

There is no transaction number: a late answer cannot be told from the next one. So exactly one
request is outstanding, and after any doubt the line is cleared and left silent for longer than
the slowest answer before the next request. A computer or an adapter may hold an answer up for
longer than any amplifier does: where something went unanswered, the next answer may be to that, and
is not believed before a longer silence and the same question again.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from cdpr8.clock import Clock
from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.transport import Received, Transport

ANSWER_S = 0.015
"""Longest answer time of ordinary commands (section 4)."""

MARGIN_S = 0.085
"""Of the host: with `ANSWER_S` the 100 ms that section 10 asks for."""

SETTLE_S = 0.02
"""Silence after which no late answer is to be feared: above `ANSWER_S`."""

LATE_S = 0.5
"""An answer later than this after its request comes no more: amplifiers take `ANSWER_S`, adapters
as long again, and the rest is for a computer that stands still.
"""

TRIES = 3

PATIENT_TRIES = 8
"""Of one that has answered before, while nothing else waits: a computer may stand still often."""

LONGEST_ANSWER = 64


class NoAnswerError(DeviceError):
    """A node stayed silent, or what it said was not whole.

    Parameters
    ----------
    asked
        The request.
    came
        What came of an answer.
    where
        The line.
    """

    def __init__(self, asked: bytes, came: bytes, where: str) -> None:
        self.came = came
        super().__init__(
            f"{asked.decode('ascii', 'replace')} was not answered"
            + (f" (only {came!r} came)" if came else ""),
            where=where,
            remedy="check power, address, baud rate and wiring; `rig scan` lists who answers",
        )


class Dialogue:
    """Questions and answers on one line.

    Parameters
    ----------
    transport
        The line; nobody else may use it meanwhile.
    """

    def __init__(self, transport: Transport) -> None:
        self.transport = transport
        self._unused = bytearray()
        self._late_until_s = -math.inf
        self._tries = TRIES

    @contextmanager
    def patiently(self) -> Iterator[None]:
        """Meanwhile ask `PATIENT_TRIES` times where no other number is named."""
        self._tries = PATIENT_TRIES
        try:
            yield
        finally:
            self._tries = TRIES

    @property
    def clock(self) -> Clock:
        """The transport's clock."""
        return self.transport.clock

    def keep(self, data: bytes) -> None:
        """Note bytes that came and are no part of any answer."""
        self._unused += data

    def unused(self) -> bytes:
        """Bytes noted since the last call: they are told, not thrown away unseen."""
        data = bytes(self._unused)
        self._unused.clear()
        return data

    def hush(self, quiet_s: float) -> bytes:
        """Wait for silence of `quiet_s`; returns, and notes, what came."""
        came = self.transport.drain(quiet_s)
        self.keep(came)
        return came

    def tell(self, *messages: bytes) -> None:
        """Send what is not answered."""
        self.transport.write(b"".join(messages))

    def ask(
        self,
        request: bytes,
        fits: Callable[[bytes], bool] = message.is_line,
        *,
        tries: int | None = None,
        margin_s: float = MARGIN_S,
    ) -> bytes:
        """Send one request and return its answer with the line end.

        Parameters
        ----------
        request
            What is sent; it may be sent several times.
        fits
            Whether a line can be an answer to this request.
        tries
            How often it is asked at most, where no answer comes; None takes `TRIES`, or more where
            it is asked `patiently`.
        margin_s
            How much longer than documented an answer may take.

        Raises
        ------
        NoAnswerError
            Nothing whole came, or nothing that fits.
        """
        raw = b""
        for attempt in range(tries or self._tries):
            if attempt:
                self.settle()
            raw, whole = self._exchange(request, margin_s)
            doubt_s = self._late_until_s - self.clock.monotonic_s()
            if whole and fits(raw) and doubt_s > 0.0:
                self.keep(raw)
                self.hush(doubt_s)
                raw, whole = self._exchange(request, margin_s)
            if whole and fits(raw):
                return raw
            self._late_until_s = self.clock.monotonic_s() + LATE_S
            self.keep(raw)
        raise NoAnswerError(request, raw, self.transport.name)

    def settle(self) -> bytes:
        """Clear the nodes' input and wait until no late answer can come; returns what came."""
        self.transport.write(message.END)
        return self.hush(SETTLE_S)

    def _exchange(self, request: bytes, margin_s: float) -> tuple[bytes, bool]:
        """What comes after a request, and whether it is a whole line without damage."""
        self.keep(self.transport.discard())
        self.transport.write(request)
        wait_s = (len(request) + LONGEST_ANSWER) * self.transport.line.char_s
        received = self._read_line(self.clock.monotonic_s() + wait_s + ANSWER_S + margin_s)
        return received.data, message.is_line(received.data) and not received.damaged

    def _read_line(self, deadline_s: float) -> Received:
        data = b""
        damaged = False
        while True:
            received = self.transport.read(1, deadline_s)
            data += received.data
            damaged |= received.damaged
            whole = data.endswith(message.LINE_END) or len(data) >= LONGEST_ANSWER
            if whole or not received.data:
                return Received(data, received.last_byte_s, damaged)
