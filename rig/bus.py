"""The amplifiers' bus: start it, take one value at a time, bring a lost node back, stop it."""

from contextlib import suppress
from dataclasses import dataclass

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue, NoAnswerError
from rig.amplifier.frame import BadFrameError, FrameFormat, Reading
from rig.amplifier.node import NodeClient, Settings
from rig.amplifier.probe import probe_format
from rig.amplifier.profile import Identity, Profile, profile_of
from rig.amplifier.scaling import Scaling
from rig.assignment import amplifiers
from rig.transport import Transport

STOP_WAIT_S = 0.1
"""Silence after ``;S98;STP;`` (protocol note, section 10)."""

VALUE_MARGIN_S = 0.02
"""How much longer than its bytes a value may take (protocol note, section 10, timeouts)."""

ALL_STOP = message.END + message.select(message.BROADCAST) + message.command("STP")
ALL_MEASURE = message.END + message.select(message.BROADCAST) + b"MSV?0;"


@dataclass(frozen=True)
class Station:
    """One amplifier as it stands on the bus, configured and measuring.

    Attributes
    ----------
    cable
        1 to 8.
    address
        Its bus address.
    identity, profile
        Who it said it is, and the dialect that follows.
    settings
        Command -> answer, read back.
    format
        Of its values, probed.
    scaling
        From digits to newtons.
    period_s
        Between two of its values: the newest is between 0 and this old.
    """

    cable: int
    address: int
    identity: Identity
    profile: Profile
    settings: dict[str, str]
    format: FrameFormat
    scaling: Scaling
    period_s: float

    @property
    def request(self) -> bytes:
        """What asks for its newest value in bus mode."""
        return message.select(self.address)


@dataclass(frozen=True, slots=True)
class Value:
    """One value as it came off the bus; times on the transport's clock, in s.

    Attributes
    ----------
    reading
        Digits and status.
    request_s
        Just before it was asked for.
    received_s
        When its last byte had come.
    sampled_s
        Estimated sampling instant: the start of the answer less the mean age of a newest value.
        Its standard uncertainty is the period over the square root of 12 (section 9).
    """

    reading: Reading
    request_s: float
    received_s: float
    sampled_s: float


class Bus:
    """Eight amplifiers on one line.

    Parameters
    ----------
    transport
        The line.
    rig
        The machine: which amplifier is on which cable, and how they are to be set.
    """

    def __init__(self, transport: Transport, rig: Rig) -> None:
        self.transport = transport
        self._rig = rig
        self._amplifiers = amplifiers(rig)
        self._dialogue = Dialogue(transport)
        # Without a parity bit nothing but the checksum would betray a damaged value; with one,
        # the last byte can tell the amplifier's status instead.
        self._settings = Settings(
            cof=rig.bus.output_format,
            icr=rig.bus.output_rate,
            asf=rig.bus.filter,
            csm=1 if rig.bus.parity == "none" else 0,
        )

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
        identities = self._identify_all()
        settings = {}
        for cable, amplifier in self._amplifiers.items():
            node = NodeClient(self._dialogue, amplifier.address)
            node.identify()
            settings[cable] = node.configure(self._settings)
        self._dialogue.tell(ALL_MEASURE)
        return tuple(
            self._station(cable, identities[cable], settings[cable]) for cable in self._amplifiers
        )

    def take(self, station: Station) -> Value:
        """The newest value of one amplifier.

        Raises
        ------
        BadFrameError
            What came is no value, or nothing came; the line has been cleared since.
        DeviceError
            The line is gone.
        """
        try:
            return self._take(station)
        except BadFrameError:
            self._dialogue.settle()
            raise

    def bring_back(self, station: Station) -> bool:
        """Try a lost amplifier; one that was reset is configured again before it is trusted.

        Returns
        -------
        bool
            Whether it gives values again.
        """
        with suppress(BadFrameError):
            self._take(station)
            return True
        node = NodeClient(self._dialogue, station.address)
        try:
            # Selected it is; a node out of bus mode answers questions.
            answer = self._dialogue.ask(message.query("IDN"), tries=1, margin_s=VALUE_MARGIN_S)
            if Identity.parse(answer) != station.identity:
                return False
            if node.configure(self._settings) != station.settings:
                return False
            self._dialogue.tell(b"MSV?0;")
            self._take(station)
        except (NoAnswerError, BadFrameError):
            self._dialogue.settle()
            return False
        except DeviceError:
            self._dialogue.settle()
            self.transport.discard()
            return False
        return True

    def stop(self) -> None:
        """Stop all output and wait for silence."""
        self._dialogue.tell(ALL_STOP)
        self.transport.drain(STOP_WAIT_S)

    def _take(self, station: Station) -> Value:
        transport = self.transport
        if stray := transport.discard():
            raise BadFrameError("bytes that nobody asked for", stray)
        line, length, request = transport.line, station.format.length, station.request
        request_s = transport.clock.monotonic_s()
        transport.write(request)
        line_s = (len(request) + length) * line.char_s
        received = transport.read(length, request_s + line_s + VALUE_MARGIN_S)
        if received.damaged:
            raise BadFrameError("parity error", received.data)
        reading = station.format.decode(received.data)
        answer_s = received.last_byte_s - length * line.char_s
        return Value(reading, request_s, received.last_byte_s, answer_s - station.period_s / 2.0)

    def _identify_all(self) -> dict[int, Identity]:
        found: dict[int, Identity] = {}
        silent = []
        for cable, amplifier in self._amplifiers.items():
            try:
                identity = NodeClient(self._dialogue, amplifier.address).identify()
            except NoAnswerError:
                silent.append(cable)
                if len(silent) > 2 and not found:
                    break
                continue
            self._check(cable, amplifier, identity)
            found[cable] = identity
        if silent:
            raise self._silent(silent, found)
        return found

    def _check(self, cable: int, amplifier: Amplifier, identity: Identity) -> None:
        where = f"cable {cable}, amplifier {amplifier.address:02d} on {self.transport.name}"
        expected = amplifier.serial_number
        if expected and identity.serial_number != expected:
            raise DeviceError(
                f"its serial number is {identity.serial_number!r}",
                allowed=f"{expected!r}, as the rig file says",
                where=where,
                remedy="swap the addresses back, or correct serial_number and the certificate's "
                "sensitivity of this cable in the rig file",
            )
        profile = profile_of(identity)
        bus = self._rig.bus
        for key, value, count in (
            ("filter", bus.filter, len(profile.cut_offs_hz)),
            ("output_rate", bus.output_rate, len(profile.rates_per_s)),
        ):
            if value >= count:
                raise DeviceError(
                    f"[bus] {key} = {value} is none of the {profile.name} dialect's",
                    allowed=f"0 to {count - 1}",
                    where=where,
                )

    def _station(self, cable: int, identity: Identity, settings: dict[str, str]) -> Station:
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
            settings=settings,
            format=format_,
            scaling=Scaling.of(amplifier, format_),
            period_s=profile.period_s(self._settings.icr),
        )

    def _silent(self, cables: list[int], found: dict[int, Identity]) -> DeviceError:
        where = self.transport.name
        if not found:
            return DeviceError(
                f"no amplifier answers at {self.transport.line}",
                where=where,
                remedy="check power and wiring, and baud and parity under [bus] in the rig file",
            )
        missing = ", ".join(
            f"cable {cable} (address {self._amplifiers[cable].address:02d})" for cable in cables
        )
        return DeviceError(
            f"{len(cables)} of {len(self._amplifiers)} amplifiers do not answer: {missing}",
            where=where,
            remedy="check their power, wiring and addresses; `rig scan` lists who answers",
        )
