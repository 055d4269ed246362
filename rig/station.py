"""One amplifier as it stands, and one value of it."""

import math
from dataclasses import dataclass
from functools import cached_property

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier import message
from rig.amplifier.frame import Reading, ValueFormat
from rig.amplifier.node import State
from rig.amplifier.pace import Pace
from rig.amplifier.profile import ADD_A_PROFILE, PROFILES, Identity, Profile, find_profile
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
        Who it said it is, and the dialect that follows; None where none is known for its type.
    state
        Its settings as read back, and what it was found with.
    format
        Of its values, probed.
    scaling
        From digits to newtons.
    period_s
        Between two of its values: the newest is between 0 and this old.
    pace
        Where its type is not known: how it gives values, asked for as text one by one.
    """

    cable: int
    address: int
    identity: Identity
    profile: Profile | None
    state: State
    format: ValueFormat
    scaling: Scaling
    period_s: float
    pace: Pace | None = None

    @cached_property
    def limit_digits(self) -> float:
        """Digits at which the input leaves the electronics' range: overload without a status."""
        if self.profile is None:
            return math.inf
        return self.profile.overflow_mv_per_v * self.scaling.digits_per_mv_per_v

    @cached_property
    def request(self) -> bytes:
        """What asks for a value: in bus mode the newest is the answer to its selection."""
        return message.select(self.address) if self.pace is None else self.pace.request

    @cached_property
    def waits_s(self) -> float:
        """How long an answer may wait for its value; 0 where the newest is given at once."""
        return 0.0 if self.pace is None else self.pace.waits_s

    @cached_property
    def age_s(self) -> float:
        """How old a value is, in the mean, when its answer begins."""
        return 0.0 if self.pace is not None and self.pace.next_value else self.period_s / 2.0


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
        Estimated sampling instant: the start of the answer less the value's mean age, or the end of
        the trigger and the mean wait for the next one. Its standard uncertainty is the
        period over the square root of 12 (section 9), at most.
    timed
        Whether it is known: not where the answer was held up by more than that, on the way to the
        amplifier or on the way back, nor where the value may be of an earlier trigger.
    """

    reading: Reading
    request_s: float
    received_s: float
    sampled_s: float
    timed: bool = True


def check_identity(
    rig: Rig, cable: int, amplifier: Amplifier, identity: Identity, line: str
) -> None:
    """Hold who answered against the rig file.

    Raises
    ------
    DeviceError
        It is another amplifier, or of a dialect that lacks what the rig file asks for, or that is
        not known and cannot give values in the way it asks for.
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
    profile = find_profile(identity)
    bus = rig.bus
    if profile is None:
        if bus.streaming or bus.sweep != "polled":
            asked = "streaming = true" if bus.streaming else f'sweep = "{bus.sweep}"'
            raise DeviceError(
                f"it is a {identity.type!r}, of which no dialect is known: it cannot be recorded "
                f"with [bus] {asked}",
                allowed=", ".join(each.name for each in PROFILES),
                where=where,
                remedy='set [bus] sweep = "polled" (streaming = false, all on one line): its '
                f"values are then asked for as text; or {ADD_A_PROFILE}",
            )
        return
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
