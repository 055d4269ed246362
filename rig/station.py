"""One amplifier as it stands, and one value of it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from cdpr8 import CABLES
from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier import message, own_scaling
from rig.amplifier.frame import Reading, ValueFormat
from rig.amplifier.node import State
from rig.amplifier.profile import Identity, Profile, profile_of
from rig.amplifier.scaling import Scaling


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
    state
        Its settings as read back, and what it was found with.
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
    state: State
    format: ValueFormat
    scaling: Scaling
    period_s: float

    @cached_property
    def limit_digits(self) -> float:
        """Digits at which the input leaves the electronics' range: overload without a status."""
        return self.profile.overflow_mv_per_v * self.scaling.digits_per_mv_per_v

    @cached_property
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
        Just before it was asked for, or triggered.
    received_s
        When its last byte had come.
    sampled_s
        Estimated sampling instant: the start of the answer less the mean age of a newest value, or
        the end of the trigger and the mean wait for the next one. Its standard uncertainty is the
        period over the square root of 12 (section 9).
    timed
        Whether it is known: not where the answer was held up by more than that, on the way to the
        amplifier or on the way back, nor where the value may be of an earlier trigger.
    """

    reading: Reading
    request_s: float
    received_s: float
    sampled_s: float
    timed: bool = True


def concerns(stations: Sequence[Station]) -> list[str]:
    """What a user must know of the amplifiers' own settings, told once for all that share it."""
    told = ((each.cable, each.state.settings, each.state.found) for each in stations)
    return by_cables(told)


def by_cables(told: Iterable[tuple[int, Mapping[str, str], Mapping[str, str]]]) -> list[str]:
    """The same from cable numbers, settings as read back and settings as found."""
    cables: dict[str, list[str]] = {}
    for cable, settings, found in told:
        for words in own_scaling.concerns(settings, found):
            cables.setdefault(words, []).append(str(cable))
    return [f"{_whose(of)} {words}" for words, of in cables.items()]


def _whose(cables: Sequence[str]) -> str:
    if len(cables) == CABLES:
        return "every amplifier"
    return f"the amplifier of cable {', '.join(cables)}"


def check_identity(
    rig: Rig, cable: int, amplifier: Amplifier, identity: Identity, line: str
) -> None:
    """Hold who answered against the rig file.

    Raises
    ------
    DeviceError
        It is another amplifier, or of a dialect that lacks what the rig file asks for.
    """
    where = f"cable {cable}, amplifier {amplifier.address:02d} on {line}"
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
    bus = rig.bus
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
