"""What runs during a recording, step by step: the bus and the camera.

A stream is stepped by a thread of its own on a real clock, and by a scheduler on virtual ones.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cdpr8.clock import Clock
from cdpr8.errors import DeviceError
from cdpr8.runfolder import EventKind, FrameFlag
from rig.amplifier.frame import BadFrameError
from rig.bus import Bus
from rig.camera import Camera, Image
from rig.confirmation import Confirmation
from rig.intake import Intake
from rig.quarantine import Quarantine
from rig.scribe import Scribe
from rig.station import Station
from rig.tally import Tally
from rig.transport import LineLostError

REOPEN_EVERY_S = 0.2
"""A port that vanished is looked for this often."""

PAUSE_S = 0.5
"""An exchange that took longer than this: the computer stood still, not the line."""


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
    intake
        Takes what comes.
    span
        Of the run.
    """

    name = "bus"

    def __init__(self, bus: Bus, stations: tuple[Station, ...], intake: Intake, span: Span) -> None:
        self._bus = bus
        self._stations = stations
        self._intake = intake
        self._span = span
        self._clock: Clock = bus.transport.clock
        self._turn = 0
        self._quarantine = Quarantine()
        self._confirmation = Confirmation()
        self._chosen: Station | None = None
        self._again: Station | None = None
        self._line_lost_s: float | None = None

    @property
    def due_s(self) -> float:
        """Now: the bus is never idle."""
        return self._clock.monotonic_s()

    def step(self) -> bool:
        """Take the next cable's value, or try a lost node or line."""
        now_s = self._clock.monotonic_s()
        if now_s >= self._span.end_s:
            self._forget_doubts()
            return False
        try:
            if self._line_lost_s is not None:
                self._reopen(self._line_lost_s)
            else:
                self._serve(now_s)
        except LineLostError as fault:
            self._lost(fault)
        if unused := self._bus.unused():
            self._intake.unused(self._clock.monotonic_s(), unused)
        return True

    def _serve(self, now_s: float) -> None:
        station = self._chosen or self._next(now_s)
        self._chosen = None
        if station is None:
            self._clock.sleep_until(min(self._quarantine.next_retry_s(), self._span.end_s))
        elif self._quarantine.holds(station.cable):
            self._retry(station)
        else:
            self._take(station, now_s)

    def _next(self, now_s: float) -> Station | None:
        """One whose value is doubted, else the next in turn that is not lost or is due."""
        if self._again is not None:
            station, self._again = self._again, None
            return station
        for _ in self._stations:
            station = self._stations[self._turn]
            self._turn = (self._turn + 1) % len(self._stations)
            held = self._quarantine.holds(station.cable)
            if not held or self._quarantine.due(station.cable, now_s):
                return station
        return None

    def _take(self, station: Station, began_s: float) -> None:
        # Who comes next is settled before, so that it is asked before this value is dealt with.
        chosen = self._chosen = self._next(began_s)
        lost = chosen is None or self._quarantine.holds(chosen.cable)
        try:
            value = self._bus.take(station, None if lost else chosen)
        except BadFrameError as fault:
            self._failed(station, fault)
        else:
            self._quarantine.answered(station.cable)
            for settled, believed in self._confirmation.judge(
                station.cable, station.scaling, value
            ):
                self._intake.value(station, settled, believed)
            if self._bus.asks_again and self._confirmation.doubts(station.cable):
                self._again = station
        now_s = self._clock.monotonic_s()
        if now_s - began_s > PAUSE_S + self._bus.waits_s:
            self._intake.lose("pause")
            self._intake.event(
                now_s, EventKind.PAUSE, f"the recorder stood still for {now_s - began_s:.2f} s"
            )

    def _failed(self, station: Station, fault: BadFrameError) -> None:
        now_s = self._clock.monotonic_s()
        cable = station.cable
        if fault.raw:
            self._intake.lose("bad_frame")
            self._intake.event(now_s, EventKind.BAD_FRAME, str(fault), cable)
        else:
            self._intake.lose("no_answer")
        if self._quarantine.failed(cable, now_s):
            self._lose_node(station, now_s, f"no value in 3 requests; the last: {fault}")
            if self._chosen is station:
                self._chosen = None

    def _lose_node(self, station: Station, now_s: float, why: str) -> None:
        self._intake.lose("node_lost")
        self._intake.event(
            now_s, EventKind.NODE_LOST, f"amplifier {station.address:02d}: {why}", station.cable
        )
        self._forget(station)

    def _retry(self, station: Station) -> None:
        cable = station.cable
        if not self._bus.bring_back(station):
            self._quarantine.still_lost(cable, self._clock.monotonic_s())
            return
        now_s = self._clock.monotonic_s()
        since_s = self._quarantine.back(cable)
        self._intake.forget(cable)
        self._intake.event(
            now_s,
            EventKind.NODE_BACK,
            f"amplifier {station.address:02d} gives values again",
            cable,
        )
        self._gap(since_s, now_s, cable)

    def _lost(self, fault: DeviceError) -> None:
        now_s = self._clock.monotonic_s()
        self._chosen = self._again = None
        if self._line_lost_s is None:
            self._line_lost_s = now_s
            self._intake.lose("line_lost")
            self._intake.event(now_s, EventKind.LINE_LOST, fault.what)
            self._forget_doubts()

    def _reopen(self, since_s: float) -> None:
        try:
            self._bus.transport.reopen()
            ready = self._bus.resume(self._stations)
        except DeviceError:
            now_s = self._clock.monotonic_s()
            self._clock.sleep_until(min(now_s + REOPEN_EVERY_S, self._span.end_s))
            return
        now_s = self._clock.monotonic_s()
        self._line_lost_s = None
        self._intake.event(now_s, EventKind.LINE_BACK, f"{len(ready)} amplifiers set up again")
        self._gap(since_s, now_s, None)
        for station in self._stations:
            self._intake.forget(station.cable)
            if station not in ready and not self._quarantine.holds(station.cable):
                self._quarantine.lose(station.cable, now_s)
                self._lose_node(station, now_s, "not there when the line came back")

    def _gap(self, since_s: float, now_s: float, cable: int | None) -> None:
        origin_s = self._span.origin_s
        self._intake.event(
            now_s,
            EventKind.GAP,
            f"no values from {since_s - origin_s:.3f} s to {now_s - origin_s:.3f} s",
            cable,
        )

    def _forget_doubts(self) -> None:
        for station in self._stations:
            self._forget(station)

    def _forget(self, station: Station) -> None:
        """Record a doubted value as what it is: not confirmed."""
        for value, believed in self._confirmation.forget(station.cable):
            self._intake.value(station, value, believed)


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
        self._last_image: Image | None = None

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
        if self._last_image is not None and np.array_equal(frame.image, self._last_image):
            # A live sensor has noise: the same picture twice is the same exposure twice.
            flags |= FrameFlag.REPEATED
            self._tally.lose("frame_repeated")
        self._last_image = frame.image
        self._scribe.frame(frame.image, t_s, int(flags))
        return True
