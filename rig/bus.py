"""The amplifiers' bus: start it, take one value at a time, bring a lost node back, stop it."""

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Rig
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue
from rig.amplifier.frame import BadFrameError, FrameFormat, ValueFormat
from rig.amplifier.node import NodeClient, Settings, State
from rig.amplifier.pace import FORMAT, measure_pace
from rig.amplifier.probe import probe_format
from rig.amplifier.profile import Identity, find_profile
from rig.amplifier.scaling import Scaling
from rig.answer_times import AnswerTimes
from rig.assignment import amplifiers
from rig.due_answer import VALUE_MARGIN_S, WAIT_MARGIN, DueAnswers
from rig.roll_call import call_the_roll
from rig.station import Station, Value
from rig.transport import LineLostError, Transport

STOP_WAIT_S = 0.1
"""Silence after ``;S98;STP;`` (protocol note, section 10)."""

UNTIMED_S = 0.002
"""An answer held up for longer, and for longer than an output period, has no known time."""


class Bus:
    """Eight amplifiers on one line, asked in turn for their newest value (bus mode).

    Those of a type that is not known are asked for a value as text (docs/decisions/0030).

    Parameters
    ----------
    transport
        The line.
    rig
        The machine: which amplifier is on which cable, and how they are to be set.
    zeros
        Host-side zeros of the cells by cable, in mV/V.

    Attributes
    ----------
    asks_again
        Whether a value that is doubted can be asked for again at once.
    waits_s
        How long a value may have to be waited for before it is asked for.
    """

    asks_again = True
    waits_s = 0.0

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
            cof=self._output_format(rig.bus.output_format),
            icr=rig.bus.output_rate,
            asf=rig.bus.filter,
            csm=1 if rig.bus.checksum or rig.bus.parity == "none" else 0,
        )
        self._asked: Station | None = None
        self._asked_s = 0.0
        self._answers = AnswerTimes(transport.line)
        self._due = DueAnswers(transport)

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
        together = all(find_profile(each) for each in identities.values())
        states = {}
        with self._dialogue.patiently():  # all have answered, and nothing is recorded yet
            for cable, amplifier in self._amplifiers.items():
                node = NodeClient(self._dialogue, amplifier.address)
                node.identify()
                states[cable] = self._configure(node, identities[cable])
                if not together:
                    self._measure_alone(identities[cable])
        if together:
            self._measure(message.ALL_MEASURE)
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
            return self._take(station, following)
        except BadFrameError:
            self._asked = None
            self._dialogue.settle()
            raise

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
            if fault.raw:
                self._dialogue.settle()
        else:
            if self._is_proof and station.profile is not None:
                return True
        node = NodeClient(self._dialogue, station.address)
        try:
            # Selected it is; a node out of bus mode answers questions.
            answer = self._dialogue.ask(
                message.query("IDN"), message.is_identity, tries=1, margin_s=VALUE_MARGIN_S
            )
            if Identity.parse(answer) != station.identity:
                return False
            if self._configure(node, station.identity) != station.state:
                return False
            self._measure_alone(station.identity)
            self._take(station)
        except LineLostError:
            raise
        except (DeviceError, BadFrameError):
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
        self.stop()
        together = all(each.profile for each in stations)
        found = []
        for station in stations:
            node = NodeClient(self._dialogue, station.address)
            try:
                same = node.identify(tries=1) == station.identity
                if same and self._configure(node, station.identity) == station.state:
                    if not together:
                        self._measure_alone(station.identity)
                    found.append(station)
            except LineLostError:
                raise
            except DeviceError:
                self._dialogue.settle()
        if together:
            self._measure(message.ALL_MEASURE)
        self._dialogue.settle()
        return tuple(found)

    def stop(self) -> None:
        """Stop all output and wait for silence."""
        self._asked = None
        self._dialogue.tell(message.ALL_STOP)
        self._dialogue.hush(STOP_WAIT_S)

    # From here on: what differs where values are triggered (`rig.broadcast`).

    _is_proof = True  # a value in bus mode proves that its amplifier was not reset

    def _output_format(self, cof: int) -> int:
        """The COF that is written."""
        return cof

    def _measure(self, command: bytes) -> None:
        """Have amplifiers measure all the time."""
        self._dialogue.tell(command)

    def _measure_alone(self, identity: Identity) -> None:
        """Have the one that is selected measure all the time; of unknown type, it would send."""
        if find_profile(identity) is not None:
            self._measure(message.MEASURE)

    def _probe(self, address: int, _: float) -> FrameFormat:
        """How a node's values look; it has this output period."""
        return probe_format(self._dialogue, address, self._settings.cof, self._settings.csm)

    def _prepare(self, station: Station) -> None:
        """Do what can be done already for a value that will be taken next."""
        self._ask(station)

    def _ask(self, station: Station) -> None:
        if stray := self.transport.discard():
            raise BadFrameError("bytes that nobody asked for", stray)
        self._asked_s = self.transport.clock.monotonic_s()
        self.transport.write(station.request)
        self._asked = station

    def _go_on(self, following: Station | None) -> None:
        """Ask the next one."""
        if following is None:
            return
        # Bytes that came unasked are the next value's trouble, not this one's.
        try:
            self._prepare(following)
        except BadFrameError as fault:
            self._dialogue.keep(fault.raw)

    def _take(self, station: Station, following: Station | None = None) -> Value:
        if self._asked is not station:
            self._ask(station)
        self._asked = None
        reading, received = self._due.fetch(station, self._asked_s)
        asked_s = self._asked_s
        # Whatever can wait is done while the next answer is on the line.
        self._go_on(following)
        answer_s, held_up_s = self._answers.began(station, asked_s, received)
        return Value(
            reading,
            asked_s,
            received.last_byte_s,
            answer_s - station.age_s,
            timed=held_up_s <= max(station.period_s - station.waits_s, UNTIMED_S),
        )

    def _station(self, cable: int, identity: Identity, state: State) -> Station:
        amplifier = self._amplifiers[cable]
        profile, pace = find_profile(identity), None
        format_: ValueFormat
        if profile is None:
            pace, format_ = measure_pace(self._dialogue, amplifier.address, self._nobody), FORMAT
            period_s = pace.period_s
            self.waits_s = max(self.waits_s, WAIT_MARGIN * period_s)
        else:
            period_s = profile.period_s(self._settings.icr)
            format_ = self._probe(amplifier.address, period_s)
        return Station(
            cable=cable,
            address=amplifier.address,
            identity=identity,
            profile=profile,
            state=state,
            format=format_,
            scaling=Scaling.of(amplifier, format_, self._zeros.get(cable, 0.0)),
            period_s=period_s,
            pace=pace,
        )

    def _configure(self, node: NodeClient, identity: Identity) -> State:
        if find_profile(identity) is None:
            return node.configure_as_text()
        return node.configure(self._settings)

    @property
    def _nobody(self) -> int:
        """An address that none of the amplifiers has."""
        return min(set(message.ADDRESSES) - {each.address for each in self._amplifiers.values()})
