"""The answer that is due on the bus, and whether it can be that to this request."""

from rig.amplifier.frame import BadFrameError, Reading
from rig.station import Station
from rig.transport import Received, Transport

VALUE_MARGIN_S = 0.02
"""How much longer than its bytes a value may take (protocol note, section 10, timeouts)."""

LATE_S = 0.05
"""How long an answer that was given up may be held up, and those behind it, once they come."""

BAUD_TOLERANCE = 0.05
"""How much faster than its name a line may be; beyond 5 % it would not be understood."""

WAIT_MARGIN = 1.5
"""How many output periods one of unknown type may take to answer: they were measured."""


class DueAnswers:
    """Takes one answer at a time off the line.

    Parameters
    ----------
    transport
        The line.
    """

    def __init__(self, transport: Transport) -> None:
        self._transport = transport
        self._late_feared = False

    def fetch(self, station: Station, asked_s: float) -> tuple[Reading, Received]:
        """The answer of an amplifier that was asked at `asked_s`.

        Raises
        ------
        BadFrameError
            What came is no value, may be another request's, or came too late to be timed.
        DeviceError
            The line is gone.
        """
        transport, length = self._transport, station.format.length
        chars = len(station.request) + length
        deadline_s = asked_s + chars * transport.line.char_s + VALUE_MARGIN_S
        if station.pace is not None:
            deadline_s += WAIT_MARGIN * station.period_s
        received = transport.read(length, deadline_s)
        self._late_feared |= len(received.data) < length
        if received.damaged:
            raise BadFrameError("parity error", received.data)
        reading = station.format.decode(received.data)
        if received.last_byte_s > deadline_s:
            raise BadFrameError("noticed too late to be timed", received.data)
        self._require_no_other(station, received, asked_s)
        return reading, received

    def _require_no_other(self, station: Station, received: Received, asked_s: float) -> None:
        """Refuse an answer that may be to an earlier request.

        An answer that was given up may still come, held up by an adapter or a busy computer, and
        then stands before that to the next request: from there on each amplifier's value would be
        taken for the next one's. It comes sooner than the line could have carried question and
        answer, or another answer comes right behind it.
        """
        chars = len(station.request) + len(received.data)
        took_s = received.last_byte_s - asked_s
        if took_s < (1.0 - BAUD_TOLERANCE) * chars * self._transport.line.char_s:
            self._late_feared = True
            raise BadFrameError("it came too soon to be the answer", received.data)
        if self._late_feared:
            if behind := self._transport.drain(LATE_S + station.waits_s):
                raise BadFrameError("another answer came behind it", received.data + behind)
            self._late_feared = False
