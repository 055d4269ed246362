"""What runs during a recording, step by step: the bus and the camera.

A stream is stepped by a thread of its own on a real clock, and by a scheduler on virtual ones.
"""

from dataclasses import dataclass
from typing import Protocol

from cdpr8.clock import Clock
from cdpr8.runfolder import BAD_TENSION, EventKind, FrameFlag, TensionStatus
from rig.amplifier.frame import BadFrameError
from rig.bus import Bus, Station, Value
from rig.camera import Camera
from rig.quarantine import Quarantine
from rig.scribe import Sample, Scribe
from rig.tally import Tally

STALE_S = 0.5
"""A value that has not changed by one digit for so long is no live measurement."""

_OVERFLOW = TensionStatus.NET_OVERFLOW | TensionStatus.GROSS_OVERFLOW | TensionStatus.ADC_OVERFLOW


@dataclass(frozen=True)
class Span:
    """The run's time on a clock: its origin, and when it ends."""

    origin_s: float
    end_s: float


class Stream(Protocol):
    """One thing that runs during a recording."""

    name: str

    @property
    def due_s(self) -> float:
        """When its next step is over, as far as is known."""
        ...

    def step(self) -> bool:
        """Do one thing; False once the stream is over."""
        ...


class BusStream:
    """Takes one value after the other, cable by cable.

    Parameters
    ----------
    bus, stations
        Started.
    scribe, tally
        Take what comes.
    span
        Of the run.
    """

    name = "bus"

    def __init__(
        self, bus: Bus, stations: tuple[Station, ...], scribe: Scribe, tally: Tally, span: Span
    ) -> None:
        self._bus = bus
        self._stations = stations
        self._scribe = scribe
        self._tally = tally
        self._span = span
        self._clock: Clock = bus.transport.clock
        self._turn = 0
        self._quarantine = Quarantine()
        self._changed: dict[int, tuple[int, float]] = {}
        self._overloaded: set[int] = set()

    @property
    def due_s(self) -> float:
        """Now: the bus is never idle."""
        return self._clock.monotonic_s()

    def step(self) -> bool:
        """Take the next cable's value, or try a lost node."""
        now_s = self._clock.monotonic_s()
        if now_s >= self._span.end_s:
            return False
        station = self._next(now_s)
        if station is None:
            self._clock.sleep_until(min(self._quarantine.next_retry_s(), self._span.end_s))
        elif self._quarantine.holds(station.cable):
            self._retry(station)
        else:
            self._take(station)
        return True

    def _next(self, now_s: float) -> Station | None:
        """The next station in turn that is not lost, or is to be tried again."""
        for _ in self._stations:
            station = self._stations[self._turn]
            self._turn = (self._turn + 1) % len(self._stations)
            held = self._quarantine.holds(station.cable)
            if not held or self._quarantine.due(station.cable, now_s):
                return station
        return None

    def _take(self, station: Station) -> None:
        try:
            value = self._bus.take(station)
        except BadFrameError as fault:
            self._failed(station, fault)
            return
        self._quarantine.answered(station.cable)
        self._record(station, value)

    def _failed(self, station: Station, fault: BadFrameError) -> None:
        now_s = self._clock.monotonic_s()
        cable = station.cable
        if fault.raw:
            self._tally.lose("bad_frame")
            self._event(now_s, EventKind.BAD_FRAME, str(fault), cable)
        else:
            self._tally.lose("no_answer")
        if self._quarantine.failed(cable, now_s):
            self._tally.lose("node_lost")
            self._event(
                now_s,
                EventKind.NODE_LOST,
                f"amplifier {station.address:02d}: no value in 3 requests; the last: {fault}",
                cable,
            )

    def _retry(self, station: Station) -> None:
        cable = station.cable
        if not self._bus.bring_back(station):
            self._quarantine.still_lost(cable, self._clock.monotonic_s())
            return
        now_s = self._clock.monotonic_s()
        since_s = self._quarantine.back(cable)
        self._changed.pop(cable, None)
        self._event(
            now_s,
            EventKind.NODE_BACK,
            f"amplifier {station.address:02d} gives values again",
            cable,
        )
        self._event(
            now_s,
            EventKind.GAP,
            f"no values from {since_s - self._span.origin_s:.3f} s "
            f"to {now_s - self._span.origin_s:.3f} s",
            cable,
        )

    def _record(self, station: Station, value: Value) -> None:
        cable, reading = station.cable, value.reading
        tension_n = station.scaling.tension_n(reading.digits)
        status = reading.status
        if reading.clamped:
            status |= TensionStatus.ADC_OVERFLOW
        if station.scaling.overloaded(tension_n):
            status |= TensionStatus.HOST_OVERLOAD
        if self._stale(cable, reading.digits, value.received_s):
            status |= TensionStatus.STALE
        self._watch_overload(station, tension_n, status, value.received_s)
        origin_s = self._span.origin_s
        self._scribe.sample(
            Sample(
                t_s=value.sampled_s - origin_s,
                cable=cable,
                digits=reading.digits,
                tension_n=tension_n,
                status=int(status),
                request_s=value.request_s - origin_s,
                received_s=value.received_s - origin_s,
            )
        )
        self._tally.samples[cable] += 1
        if status & BAD_TENSION:
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
        over = bool(status & (_OVERFLOW | TensionStatus.HOST_OVERLOAD))
        if over and cable not in self._overloaded:
            why = (
                f"the amplifier flags an overflow (status {status & 0xFF:#04x})"
                if status & _OVERFLOW
                else f"above 120 % of the cell's {station.scaling.nominal_force_n:g} N"
            )
            self._event(now_s, EventKind.OVERLOAD, f"{tension_n:.2f} N: {why}", cable)
            self._overloaded.add(cable)
        elif not over:
            self._overloaded.discard(cable)

    def _event(self, now_s: float, kind: EventKind, detail: str, cable: int) -> None:
        self._scribe.event(now_s - self._span.origin_s, kind, detail, cable)


class CameraStream:
    """Takes one frame after the other.

    Parameters
    ----------
    camera
        Started.
    scribe, tally
        Take what comes.
    span
        Of the run, on the camera's clock.
    """

    name = "camera"

    def __init__(self, camera: Camera, scribe: Scribe, tally: Tally, span: Span) -> None:
        self._camera = camera
        self._scribe = scribe
        self._tally = tally
        self._span = span

    @property
    def due_s(self) -> float:
        """When the next exposure is over."""
        return self._camera.next_frame_s

    def step(self) -> bool:
        """Wait for a frame and hand it on."""
        if self._camera.next_frame_s > self._span.end_s:
            return False
        frame = self._camera.next_frame()
        if frame is None:
            now_s = self._camera.clock.monotonic_s() - self._span.origin_s
            self._tally.lose("camera_lost")
            self._scribe.event(now_s, EventKind.GAP, "the camera gives no more frames")
            return False
        t_s = frame.t_mid_s - self._span.origin_s
        if frame.t_mid_s > self._span.end_s:
            return False
        flags = FrameFlag(0)
        if frame.dropped_before:
            flags |= FrameFlag.DROPPED_BEFORE
            self._tally.lose("frame_dropped", frame.dropped_before)
            self._scribe.event(
                t_s, EventKind.FRAME_DROPPED, f"{frame.dropped_before} before this frame"
            )
        self._scribe.frame(frame.image, t_s, int(flags))
        return True
