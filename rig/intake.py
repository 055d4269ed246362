"""From a value off the line to a row of tension.csv: scaled, flagged, and counted."""

from collections.abc import Callable

from cdpr8.runfolder import BAD_TENSION, EventKind, TensionStatus
from rig.lines import Sample
from rig.scribe import Scribe
from rig.station import Station, Value
from rig.tally import Tally

STALE_S = 0.5
"""A value that has not changed by one digit for so long is no live measurement."""

# Plain numbers: flags cost microseconds, and values come some thousand times a second.
_OVERFLOW = int(
    TensionStatus.NET_OVERFLOW | TensionStatus.GROSS_OVERFLOW | TensionStatus.ADC_OVERFLOW
)
_ADC_OVERFLOW = int(TensionStatus.ADC_OVERFLOW)
_HOST_OVERLOAD = int(TensionStatus.HOST_OVERLOAD)
_STALE = int(TensionStatus.STALE)
_UNCONFIRMED = int(TensionStatus.UNCONFIRMED)
_UNTIMED = int(TensionStatus.UNTIMED)
_BAD_TENSION = int(BAD_TENSION)

Alarm = Callable[[int, str], None]
"""Told the cable and what is wrong with it; must not wait."""


class Intake:
    """Takes values, hands samples and events to the scribe.

    Parameters
    ----------
    scribe, tally
        Take what comes.
    origin_s
        Of the run, on the clock of the values.
    alarm
        Told of an overload when it begins.
    """

    def __init__(
        self, scribe: Scribe, tally: Tally, origin_s: float, alarm: Alarm | None = None
    ) -> None:
        self._scribe = scribe
        self._tally = tally
        self._origin_s = origin_s
        self._alarm = alarm
        self._changed: dict[int, tuple[int, float]] = {}
        self._overloaded: set[int] = set()

    def lose(self, what: str, count: int = 1) -> None:
        """Count what was lost."""
        self._tally.lose(what, count)

    def event(self, now_s: float, kind: EventKind, detail: str, cable: int | None = None) -> None:
        """Note an event; `now_s` is on the clock of the values."""
        self._scribe.event(now_s - self._origin_s, kind, detail, cable)

    def unused(self, now_s: float, data: bytes, cable: int | None = None) -> None:
        """Note bytes that came and became no value: nothing that arrived is thrown away."""
        words = f"{len(data)} bytes: {data.hex(' ').upper()}"
        self.event(now_s, EventKind.STRAY_BYTES, words, cable)

    def forget(self, cable: int) -> None:
        """The cable's values were interrupted: whether the next one is stale is not known."""
        self._changed.pop(cable, None)

    def value(self, station: Station, value: Value, believed: bool = True) -> None:
        """Take one value of a cable."""
        cable, reading = station.cable, value.reading
        tension_n = station.scaling.tension_n(reading.digits)
        status = reading.status
        if reading.clamped or abs(reading.digits) >= station.limit_digits:
            status |= _ADC_OVERFLOW
        if station.scaling.overloaded(tension_n):
            status |= _HOST_OVERLOAD
        if not value.timed:
            status |= _UNTIMED
            self._tally.lose("untimed")
        if not believed:
            status |= _UNCONFIRMED
            self._tally.lose("unconfirmed")
        else:
            if station.scaling.fine and self._stale(cable, reading.digits, value.received_s):
                status |= _STALE
            self._watch_overload(station, tension_n, status, value.received_s)
        self._scribe.sample(
            Sample(
                t_s=value.sampled_s - self._origin_s,
                cable=cable,
                digits=reading.digits,
                tension_n=tension_n,
                status=status,
                request_s=value.request_s - self._origin_s,
                received_s=value.received_s - self._origin_s,
            )
        )
        self._tally.samples[cable] += 1
        if status & _BAD_TENSION:
            self._tally.lose("flagged")
        else:
            self._tally.tension_n[cable] = tension_n

    def _stale(self, cable: int, digits: int, now_s: float) -> bool:
        last = self._changed.get(cable)
        if last is None or last[0] != digits:
            self._changed[cable] = (digits, now_s)
            return False
        return now_s - last[1] > STALE_S

    def _watch_overload(
        self, station: Station, tension_n: float, status: int, now_s: float
    ) -> None:
        cable = station.cable
        over = bool(status & (_OVERFLOW | _HOST_OVERLOAD))
        if over and cable not in self._overloaded:
            why = (
                f"beyond what the amplifier can measure (status {status & 0xFF:#04x})"
                if status & _OVERFLOW
                else f"above 120 % of the cell's {station.scaling.nominal_force_n:g} N"
            )
            words = f"{tension_n:.2f} N: {why}"
            self.event(now_s, EventKind.OVERLOAD, words, cable)
            self._overloaded.add(cable)
            if self._alarm is not None:
                self._alarm(cable, words)
        elif not over:
            self._overloaded.discard(cable)
