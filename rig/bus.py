"""The amplifiers' bus: start it, take one value at a time, bring a lost node back, stop it."""

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Rig
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue, NoAnswerError
from rig.amplifier.frame import BadFrameError
from rig.amplifier.node import NodeClient, Settings, State
from rig.amplifier.probe import probe_format
from rig.amplifier.profile import Identity, profile_of
from rig.amplifier.scaling import Scaling
from rig.assignment import amplifiers
from rig.roll_call import call_the_roll
from rig.station import Station, Value
from rig.transport import LineLostError, Received, Transport

STOP_WAIT_S = 0.1
"""Silence after ``;S98;STP;`` (protocol note, section 10)."""

VALUE_MARGIN_S = 0.02
"""How much longer than its bytes a value may take (protocol note, section 10, timeouts)."""

LATE_S = 0.05
"""How long an answer that was given up may be held up, and those behind it, once they come."""

BAUD_TOLERANCE = 0.05
"""How much faster than its name a line may be; beyond 5 % it would not be understood."""

JITTER_S = 0.0005
"""How much the way to the node and back may vary, in adapters, without the computer's fault."""

UNTIMED_S = 0.002
"""An answer held up for longer, and for longer than an output period, has no known time."""

ALL_STOP = message.END + message.select(message.BROADCAST) + message.command("STP")
ALL_MEASURE = message.END + message.select(message.BROADCAST) + b"MSV?0;"


class Bus:
    """Eight amplifiers on one line.

    Parameters
    ----------
    transport
        The line.
    rig
        The machine: which amplifier is on which cable, and how they are to be set.
    zeros
        Host-side zeros of the cells by cable, in mV/V.
    """

    def __init__(
        self, transport: Transport, rig: Rig, zeros: dict[int, float] | None = None
    ) -> None:
        self.transport = transport
        self._zeros = zeros or {}
        self._rig = rig
        self._amplifiers = amplifiers(rig)
        self._dialogue = Dialogue(transport)
        # Without a parity bit nothing but the checksum would betray a damaged value.
        self._settings = Settings(
            cof=rig.bus.output_format,
            icr=rig.bus.output_rate,
            asf=rig.bus.filter,
            csm=1 if rig.bus.checksum or rig.bus.parity == "none" else 0,
        )
        self._asked: Station | None = None
        self._asked_s = 0.0
        self._least_s: dict[int, float] = {}
        self._late_feared = False

    def start(self) -> tuple[Station, ...]:
        """Silence the bus, identify, configure and start all amplifiers.

        Returns
        -------
        tuple of Station
            In order of the cables.

        Raises
        ------
        DeviceError
            An amplifier is missing, another than the rig file's, or refuses a setting.
        """
        self.stop()
        identities = call_the_roll(self._dialogue, self._rig)
        states = {}
        for cable, amplifier in self._amplifiers.items():
            node = NodeClient(self._dialogue, amplifier.address)
            node.identify()
            states[cable] = node.configure(self._settings)
        self._dialogue.tell(ALL_MEASURE)
        stations = tuple(
            self._station(cable, identities[cable], states[cable]) for cable in self._amplifiers
        )
        self._dialogue.unused()  # of the setting up, not of the run
        return stations

    def unused(self) -> bytes:
        """Bytes that came since the last call and became neither a value nor a told bad frame."""
        return self._dialogue.unused()

    def take(self, station: Station, following: Station | None = None) -> Value:
        """The newest value of one amplifier.

        Parameters
        ----------
        station
            Whose value; where it was the `following` of the call before, it has been asked.
        following
            Whom to ask next, at once: what the caller does with this value then takes no time
            from the line.

        Raises
        ------
        BadFrameError
            What came is no value, or nothing came; the line has been cleared since.
        DeviceError
            The line is gone.
        """
        try:
            value = self._take(station)
        except BadFrameError:
            self._asked = None
            self._dialogue.settle()
            raise
        if following is not None:
            # Bytes that came unasked are the next value's trouble, not this one's.
            try:
                self._ask(following)
            except BadFrameError as fault:
                self._dialogue.keep(fault.raw)
        return value

    def bring_back(self, station: Station) -> bool:
        """Try a lost amplifier; one that was reset is configured again before it is trusted.

        Returns
        -------
        bool
            Whether it gives values again.
        """
        self._asked = None
        try:
            self._take(station)
        except BadFrameError as fault:
            self._dialogue.keep(fault.raw)
        else:
            return True
        node = NodeClient(self._dialogue, station.address)
        try:
            # Selected it is; a node out of bus mode answers questions.
            answer = self._dialogue.ask(
                message.query("IDN"), message.is_identity, tries=1, margin_s=VALUE_MARGIN_S
            )
            if Identity.parse(answer) != station.identity:
                return False
            if node.configure(self._settings) != station.state:
                return False
            self._dialogue.tell(b"MSV?0;")
            self._take(station)
        except (NoAnswerError, BadFrameError):
            self._dialogue.settle()
            return False
        except LineLostError:
            raise
        except DeviceError:
            self._dialogue.settle()
            return False
        return True

    def resume(self, stations: tuple[Station, ...]) -> tuple[Station, ...]:
        """Set the bus up again after the line was gone; nothing is trusted unread.

        Returns
        -------
        tuple of Station
            Those that are what they were; the others are to be tried one by one.

        Raises
        ------
        DeviceError
            The line is gone again.
        """
        self._asked = None
        self.stop()
        found = []
        for station in stations:
            node = NodeClient(self._dialogue, station.address)
            try:
                same = node.identify(tries=1) == station.identity
                if same and node.configure(self._settings) == station.state:
                    found.append(station)
            except LineLostError:
                raise
            except DeviceError:
                self._dialogue.settle()
        self._dialogue.tell(ALL_MEASURE)
        self._dialogue.settle()
        return tuple(found)

    def stop(self) -> None:
        """Stop all output and wait for silence."""
        self._asked = None
        self._dialogue.tell(ALL_STOP)
        self._dialogue.hush(STOP_WAIT_S)

    def _ask(self, station: Station) -> None:
        if stray := self.transport.discard():
            raise BadFrameError("bytes that nobody asked for", stray)
        self._asked_s = self.transport.clock.monotonic_s()
        self.transport.write(station.request)
        self._asked = station

    def _take(self, station: Station) -> Value:
        if self._asked is not station:
            self._ask(station)
        self._asked = None
        transport, request_s = self.transport, self._asked_s
        line, length = transport.line, station.format.length
        deadline_s = request_s + (len(station.request) + length) * line.char_s + VALUE_MARGIN_S
        received = transport.read(length, deadline_s)
        self._late_feared |= len(received.data) < length
        if received.damaged:
            raise BadFrameError("parity error", received.data)
        reading = station.format.decode(received.data)
        if received.last_byte_s > deadline_s:
            raise BadFrameError("noticed too late to be timed", received.data)
        self._require_no_other(station, received)
        answer_s, held_up_s = self._answered(station, received.last_byte_s - length * line.char_s)
        return Value(
            reading,
            request_s,
            received.last_byte_s,
            answer_s - station.period_s / 2.0,
            timed=held_up_s <= max(station.period_s, UNTIMED_S),
        )

    def _require_no_other(self, station: Station, received: Received) -> None:
        """Refuse an answer that may be to an earlier request.

        An answer that was given up may still come, held up by an adapter or a busy computer, and
        then stands before that to the next request: from there on each amplifier's value would be
        taken for the next one's. It comes sooner than the line could have carried question and
        answer, or another answer comes right behind it.
        """
        chars = len(station.request) + len(received.data)
        took_s = received.last_byte_s - self._asked_s
        if took_s < (1.0 - BAUD_TOLERANCE) * chars * self.transport.line.char_s:
            self._late_feared = True
            raise BadFrameError("it came too soon to be the answer", received.data)
        if self._late_feared:
            if behind := self.transport.drain(LATE_S):
                raise BadFrameError("another answer came behind it", received.data + behind)
            self._late_feared = False

    def _answered(self, station: Station, received_s: float) -> tuple[float, float]:
        """When an answer began, and how long it was held up.

        A node takes about the same time to answer always, and the line never less than the request
        needs: the least time that a node has taken is that of the line and of this program. What
        an answer takes beyond it was held up on the way there or on the way back, and nobody can
        tell which: in adapters, up to `JITTER_S`, both alike; in a computer that was busy, most
        likely on the way back (docs/decisions/0008).
        """
        took_s = received_s - self._asked_s - len(station.request) * self.transport.line.char_s
        least_s = max(0.0, min(took_s, self._least_s.get(station.address, took_s)))
        self._least_s[station.address] = least_s
        held_up_s = max(0.0, took_s - least_s)
        return received_s - held_up_s + min(held_up_s, JITTER_S) / 2.0, held_up_s

    def _station(self, cable: int, identity: Identity, state: State) -> Station:
        amplifier = self._amplifiers[cable]
        profile = profile_of(identity)
        format_ = probe_format(
            self._dialogue, amplifier.address, self._settings.cof, self._settings.csm
        )
        return Station(
            cable=cable,
            address=amplifier.address,
            identity=identity,
            profile=profile,
            state=state,
            format=format_,
            scaling=Scaling.of(amplifier, format_, self._zeros.get(cable, 0.0)),
            period_s=profile.period_s(self._settings.icr),
        )
