"""Eight streams in a recording: what came is taken from every port in turn."""

from collections.abc import Callable, Sequence

from cdpr8.clock import Clock
from cdpr8.errors import DeviceError
from cdpr8.runfolder import EventKind
from rig.confirmation import Confirmation
from rig.intake import Intake
from rig.quarantine import Quarantine
from rig.station import Value
from rig.streaming.port import StreamPort
from rig.streams import REOPEN_EVERY_S, Span
from rig.transport import LineLostError

LOOK_EVERY_S = (0.003, 0.007)
"""Ports are looked at after waits between these, never in step with the values: the earliest
arrivals tell a node's clock, and must be seen at every phase."""

GOLDEN = 0.618034
"""Multiples of it fill the interval from 0 to 1 evenly and repeat nothing."""

SILENT_S = 0.5
"""An amplifier that has sent nothing for so long is lost."""


class StreamingStream:
    """Takes what all ports have received.

    Parameters
    ----------
    ports
        Started.
    intake
        Takes what comes.
    span
        Of the run.
    clock
        Of all ports.
    """

    name = "ports"

    def __init__(
        self, ports: Sequence[StreamPort], intake: Intake, span: Span, clock: Clock
    ) -> None:
        self._ports = ports
        self._intake = intake
        self._span = span
        self._clock = clock
        self._quarantine = Quarantine()
        self._confirmation = Confirmation()
        self._line_lost: dict[int, float] = {}
        self._looks = 0

    @property
    def due_s(self) -> float:
        """Now."""
        return self._clock.monotonic_s()

    def step(self) -> bool:
        """Look at every port once, then wait a little."""
        now_s = self._clock.monotonic_s()
        over = now_s >= self._span.end_s
        # All ports are listened to first: what one port's values take to be dealt with would make
        # the others' look late.
        for port in self._ports:
            self._guard(port, self._listen)
        for port in self._ports:
            self._guard(port, self._serve)
            if unused := port.unused():
                self._intake.unused(now_s, unused, port.station.cable)
        if over:  # what came up to the end has been taken
            for port in self._ports:
                self._forget(port)
            return False
        self._looks += 1
        least_s, most_s = LOOK_EVERY_S
        wait_s = least_s + (most_s - least_s) * (self._looks * GOLDEN % 1.0)
        self._clock.sleep_until(min(now_s + wait_s, self._span.end_s))
        return True

    def _guard(self, port: StreamPort, deal: Callable[[StreamPort, float], None]) -> None:
        """Deal with a port, whose line may be gone."""
        cable = port.station.cable
        now_s = self._clock.monotonic_s()
        try:
            deal(port, now_s)
        except LineLostError as fault:
            if cable not in self._line_lost:
                self._line_lost[cable] = now_s
                self._intake.event(now_s, EventKind.LINE_LOST, fault.what, cable)
            self._lose(port, "its line is gone", REOPEN_EVERY_S)

    def _listen(self, port: StreamPort, _: float) -> None:
        if not self._quarantine.holds(port.station.cable):
            port.listen()

    def _serve(self, port: StreamPort, now_s: float) -> None:
        cable = port.station.cable
        if not self._quarantine.holds(cable):
            self._take(port, now_s)
        elif self._quarantine.due(cable, now_s):
            self._retry(port)

    def _take(self, port: StreamPort, now_s: float) -> None:
        cable = port.station.cable
        values, faults, missing = port.poll()
        for fault in faults:
            self._intake.lose("bad_frame")
            self._intake.event(now_s, EventKind.BAD_FRAME, str(fault), cable)
        if missing:
            self._intake.lose("missing", missing)
            self._intake.event(now_s, EventKind.GAP, f"{missing} values missing", cable)
        self._hand_on(port, values)
        if port.failed:
            self._forget(port)
            self._intake.event(now_s, EventKind.GAP, "alignment unknown: started anew", cable)
            self._intake.lose("restart")
            port.start()
        elif now_s - port.heard_s > SILENT_S:
            self._lose(port, f"nothing came for {SILENT_S} s", None)

    def _hand_on(self, port: StreamPort, values: Sequence[Value]) -> None:
        for value in values:
            if self._span.origin_s <= value.sampled_s <= self._span.end_s:
                self._judge(port, value)

    def _judge(self, port: StreamPort, value: Value) -> None:
        """Without a checksum, a value that jumps waits for the next one to confirm it."""
        station = port.station
        if station.format.guarded:
            self._intake.value(station, value)
            return
        for settled, believed in self._confirmation.judge(station.cable, station.scaling, value):
            self._intake.value(station, settled, believed)

    def _forget(self, port: StreamPort) -> None:
        """Record what waits still, and a doubted value as what it is: not confirmed."""
        self._hand_on(port, port.settle())
        for value, believed in self._confirmation.forget(port.station.cable):
            self._intake.value(port.station, value, believed)

    def _lose(self, port: StreamPort, why: str, retry_after_s: float | None) -> None:
        cable, now_s = port.station.cable, self._clock.monotonic_s()
        if not self._quarantine.holds(cable):
            self._intake.lose("node_lost")
            self._intake.event(
                now_s, EventKind.NODE_LOST, f"amplifier {port.station.address:02d}: {why}", cable
            )
        self._forget(port)
        self._quarantine.lose(cable, now_s, retry_after_s)

    def _retry(self, port: StreamPort) -> None:
        cable = port.station.cable
        if cable in self._line_lost:
            try:
                port.transport.reopen()
            except DeviceError:
                self._quarantine.lose(cable, self._clock.monotonic_s(), REOPEN_EVERY_S)
                return
        ready = port.resume()
        now_s = self._clock.monotonic_s()
        if not ready:
            self._quarantine.still_lost(cable, now_s)
            return
        if self._line_lost.pop(cable, None) is not None:
            self._intake.event(now_s, EventKind.LINE_BACK, "open again", cable)
        since_s = self._quarantine.back(cable)
        self._intake.forget(cable)
        self._intake.event(now_s, EventKind.NODE_BACK, "gives values again", cable)
        origin_s = self._span.origin_s
        self._intake.event(
            now_s,
            EventKind.GAP,
            f"no values from {since_s - origin_s:.3f} s to {now_s - origin_s:.3f} s",
            cable,
        )
