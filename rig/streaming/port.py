"""One amplifier on a port of its own: set it up, start it, tell what came."""

import math
from collections.abc import Sequence
from contextlib import suppress

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue
from rig.amplifier.frame import BUS_MODE, CRLF, WITHOUT_CRLF, BadFrameError, ValueFormat
from rig.amplifier.node import NodeClient, Settings
from rig.amplifier.profile import profile_of
from rig.amplifier.scaling import Scaling
from rig.amplifier.text_frame import formats_of
from rig.assignment import amplifiers
from rig.confirmation import JUMP_OF_NOMINAL
from rig.station import Station, Value, check_identity
from rig.streaming.lock import Framed, FrameLock
from rig.streaming.node_clock import NodeClock
from rig.transport import Received, Transport

SILENCE_S = 0.05
"""Silence after ``STP;`` that ends a stream for certain: the next byte is a first one."""

PROBED = 16
"""Values that must all fit one format."""

LONGEST_GAP_S = 1.0
"""A longer gap starts the node's clock anew."""

LATE_S = 0.01
"""How late bytes may be noticed: ports are looked at every 7 ms at least."""

LOOKS_TO_TIME = 4
"""After a start values wait until some came at so many looks: the last bytes of one look may
be of no value, and tell when those before them came only within some periods."""

JUST = 0.05
"""Of a period: how much late a value may be and still count as on time."""

STOP = message.END + message.command("STP")


class StreamPort:
    """One amplifier that sends its values unasked.

    Parameters
    ----------
    transport
        Its line.
    rig
        The machine.
    cable
        1 to 8.
    zero_mv_per_v
        Host-side zero of its cell.
    """

    def __init__(
        self, transport: Transport, rig: Rig, cable: int, zero_mv_per_v: float = 0.0
    ) -> None:
        self.transport = transport
        self._rig = rig
        self._cable = cable
        self._amplifier: Amplifier = amplifiers(rig)[cable]
        self._dialogue = Dialogue(transport)
        base = rig.bus.output_format % BUS_MODE
        self._settings = Settings(
            cof=base + (rig.bus.output_format & WITHOUT_CRLF),
            icr=rig.bus.output_rate,
            asf=rig.bus.filter,
            csm=1 if rig.bus.checksum or rig.bus.parity == "none" else 0,
        )
        self._lock: FrameLock | None = None
        self._taken: tuple[Received, float] | None = None
        self.station = self._set_up(zero_mv_per_v)

    def start(self) -> None:
        """Start the stream from silence."""
        self.stop()
        station = self.station
        jump = JUMP_OF_NOMINAL * abs(
            station.scaling.digits(station.scaling.nominal_force_n) - station.scaling.digits(0.0)
        )
        self._lock = FrameLock(station.format, None if station.format.ends_in_crlf else jump)
        self._clock = NodeClock(station.period_s)
        self._number = -1
        self._looks = 0
        self._waiting: list[tuple[Framed, int, float]] = []
        self._received = self._last_end = 0
        self.heard_s = self.transport.clock.monotonic_s()
        self._dialogue.tell(message.MEASURE)

    def stop(self) -> None:
        """End the stream and wait for silence."""
        if self._lock is not None:
            self._dialogue.keep(self._lock.unproven)
            self._lock = None
        self._dialogue.tell(STOP)
        self._dialogue.hush(SILENCE_S)

    def unused(self) -> bytes:
        """Bytes that came since the last call and became neither a value nor a told bad frame."""
        return self._dialogue.unused()

    def resume(self) -> bool:
        """Set up again after silence or a lost line; False where it is not what it was."""
        self.stop()
        node = NodeClient(self._dialogue, self.station.address)
        try:
            if node.identify(tries=1) != self.station.identity:
                return False
            if node.configure(self._settings) != self.station.state:
                return False
        except DeviceError:
            return False
        self.start()
        return True

    @property
    def failed(self) -> bool:
        """Whether the alignment is unknown and the stream must be started anew."""
        return self._lock is not None and self._lock.failed

    def listen(self) -> None:
        """Take what has come, for `poll`: where there are more ports, before any is dealt with."""
        self._taken = self._listened()

    def poll(self) -> tuple[list[Value], list[BadFrameError], int]:
        """Values that have come, bytes that are none, and how many values are missing."""
        received, now_s = self._taken or self._listened()
        self._taken = None
        data = received.data
        if not data or self._lock is None:
            self._dialogue.keep(data)
            return [], [], 0
        self.heard_s = now_s
        self._received += len(data)
        framed, faults = self._lock.feed(data, received.damaged)
        char_s = self.transport.line.char_s
        arrived = [now_s - (self._received - each.end) * char_s for each in framed]
        missing = 0
        for place, (each, arrived_s) in enumerate(zip(framed, arrived, strict=True)):
            if not each.follows and self._clock.known:
                missing += self._skip(framed, arrived, place)
            self._number += 1
            self._last_end = each.end
            self._clock.add(self._number, arrived_s)
            self._waiting.append((each, self._number, arrived_s))
        self._looks += bool(framed)
        return self.settle() if self._looks >= LOOKS_TO_TIME else [], faults, missing

    def settle(self) -> list[Value]:
        """Values that have come and wait for better times, with those known now."""
        waiting, self._waiting = self._waiting, []
        return [self._value(*each) for each in waiting]

    def _listened(self) -> tuple[Received, float]:
        """What has come, and when it was seen."""
        return self.transport.take(), self.transport.clock.monotonic_s()

    def _skip(self, framed: Sequence[Framed], arrived: Sequence[float], place: int) -> int:
        """Number the first value after a gap by the node's clock; returns how many are missing."""
        steps = []
        for further, (each, arrived_s) in enumerate(
            zip(framed[place:], arrived[place:], strict=True)
        ):
            if further and not each.follows:
                break
            late_s = arrived_s - self._clock.arrival_s(self._number)
            steps.append(late_s / self._clock.period_s - further)
        missing = max(0, math.floor(min(steps) + JUST) - 1)
        # Bytes arrive late, never early: their time tells at most how many are missing. Where bytes
        # came between, their number tells it better, unless far more time went by.
        length = self.station.format.length
        between = framed[place].end - length - self._last_end
        by_bytes = max(1, round(between / length))
        if between > 0 and missing - by_bytes <= LATE_S / self._clock.period_s:
            # A clock that is new runs late by some periods, and sees too few missing.
            new = self._looks < LOOKS_TO_TIME
            missing = by_bytes if new else min(missing, by_bytes)
        if missing * self._clock.period_s > LONGEST_GAP_S:
            self._clock = NodeClock(self.station.period_s)
            self._number = -1
        else:
            self._number += missing
        return missing

    def _value(self, framed: Framed, number: int, arrived_s: float) -> Value:
        # A value leaves as soon as it is ready: it was sampled when its first bit left.
        line_s = self.station.format.length * self.transport.line.char_s
        return Value(framed.reading, math.nan, arrived_s, self._clock.arrival_s(number) - line_s)

    def _set_up(self, zero_mv_per_v: float) -> Station:
        self.stop()
        node = NodeClient(self._dialogue, self._amplifier.address)
        identity = node.identify()
        check_identity(self._rig, self._cable, self._amplifier, identity, self.transport.name)
        profile = profile_of(identity)
        with self._dialogue.patiently():
            state = node.configure(self._settings)
        period_s = profile.period_s(self._settings.icr)
        format_ = self._probe(period_s)
        return Station(
            cable=self._cable,
            address=self._amplifier.address,
            identity=identity,
            profile=profile,
            state=state,
            format=format_,
            scaling=Scaling.of(self._amplifier, format_, zero_mv_per_v),
            period_s=period_s,
        )

    def _probe(self, period_s: float) -> ValueFormat:
        """With CR LF or without: asked of the stream itself (section 5, "ambiguities")."""
        amplifier, clock, line = self._amplifier, self.transport.clock, self.transport.line
        formats = formats_of(self._settings.cof, self._settings.csm, amplifier.address)
        self._check_speed(min(each.length for each in formats), period_s)
        self._dialogue.tell(message.MEASURE)
        count = PROBED * formats[0].length
        wait_s = count * line.char_s + 2 * PROBED * period_s
        raw = self.transport.read(count, clock.monotonic_s() + wait_s).data
        self.stop()
        # CR LF at the end of every value is no chance; without it nearly everything fits.
        fitting = [each for each in formats if _all_fit(each, raw)]
        if not fitting or not raw.strip(CRLF):
            raise DeviceError(
                f"values fit no format of COF {self._settings.cof}: "
                f"{raw[:17].hex(' ').upper() or 'nothing came'}",
                allowed=" or ".join(f"{each.length} bytes a value" for each in formats),
                where=self.transport.name,
                remedy="check the wiring, and that the line is fast enough for the output rate",
            )
        if not fitting[0].alignable:
            raise DeviceError(
                "values of 2 bytes come without CR LF: nothing tells where one begins",
                allowed="2 bytes with CR LF, 4 bytes, or text",
                where=self.transport.name,
                remedy="set [bus] output_format = 8 in the rig file (4 bytes with a checksum)",
            )
        self._check_speed(fitting[0].length, period_s)
        return fitting[0]

    def _check_speed(self, length: int, period_s: float) -> None:
        line = self.transport.line
        needs_baud = length * line.bits_per_char / period_s
        if needs_baud > line.baud:
            raise DeviceError(
                f"{1.0 / period_s:g} values of {length} bytes a second do not go through {line}",
                allowed=f"at least {needs_baud:.0f} baud, or a slower output rate",
                where=self.transport.name,
                remedy="raise [bus] output_rate or baud, or choose a shorter output_format",
            )


def _all_fit(format_: ValueFormat, raw: bytes) -> bool:
    length = format_.length
    whole = len(raw) // length
    if whole < PROBED // 2:
        return False
    for at in range(0, whole * length, length):
        try:
            format_.decode(raw[at : at + length])
        except BadFrameError:
            return False
    return True


def open_ports(
    transports: Sequence[Transport], rig: Rig, zeros: dict[int, float] | None = None
) -> tuple[StreamPort, ...]:
    """Set up the amplifiers of all cables, in their order, each on its own line."""
    found = tuple(
        StreamPort(transport, rig, cable, (zeros or {}).get(cable, 0.0))
        for cable, transport in enumerate(transports, start=1)
    )
    for port in found:
        port.start()
        port.unused()  # of the setting up, not of the run
    return found


def close_ports(ports: Sequence[StreamPort]) -> None:
    """End all streams."""
    for port in ports:
        with suppress(DeviceError):
            port.stop()
