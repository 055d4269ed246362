"""Dialects of the amplifier family as data, chosen by the answer to `IDN?` (section 11)."""

import re
from dataclasses import dataclass

from cdpr8.errors import DeviceError


@dataclass(frozen=True)
class Identity:
    """The answer to `IDN?`, read leniently: quotes are optional, padding is stripped.

    Attributes
    ----------
    maker, type, serial_number, firmware
        As answered.
    text
        The whole answer without its line end.
    """

    maker: str
    type: str
    serial_number: str
    firmware: str
    text: str

    @classmethod
    def parse(cls, answer: bytes) -> "Identity":
        """Read an answer such as ``HBM,"AD104          ","1234567",P20``.

        Raises
        ------
        DeviceError
            The answer has not four parts.
        """
        text = answer.decode("ascii", "replace").strip()
        parts = [part.strip().strip('"').strip() for part in text.split(",")]
        if len(parts) != 4 or not all(parts):
            raise DeviceError(
                f"IDN? was answered with {answer!r}",
                allowed='four parts: HBM,"type","serial number",firmware',
                remedy="check the baud rate, the parity and that no two nodes share an address",
            )
        maker, type_, serial_number, firmware = parts
        return cls(maker, type_, serial_number, firmware, text)


@dataclass(frozen=True)
class Profile:
    """What one dialect can do.

    Attributes
    ----------
    name
        What a user calls it.
    types
        Patterns of the type in `IDN?`.
    rates_per_s
        Output rate by ICR.
    cut_offs_hz
        -3 dB frequency of the standard filter (FMD0) by ASF; None is open.
    bauds
        Line speeds it has.
    overflow_mv_per_v
        Input beyond which the electronics flag an overflow.
    source
        Where the numbers come from.
    """

    name: str
    types: tuple[str, ...]
    rates_per_s: tuple[float, ...]
    cut_offs_hz: tuple[float | None, ...]
    bauds: tuple[int, ...]
    overflow_mv_per_v: float
    source: str

    def period_s(self, icr: int) -> float:
        """Time between two values of a node at an ICR index."""
        return 1.0 / self.rates_per_s[icr]


_SLOW_BAUDS = (1200, 2400, 4800, 9600, 19200, 38400)

AD104 = Profile(
    name="AD104",
    types=(r"AD104",),
    rates_per_s=(100.0, 50.0, 25.0, 12.0, 6.0, 3.0, 2.0, 1.0),
    cut_offs_hz=(None, 8.0, 3.5, 1.5, 0.7, 0.3, 0.2, 0.1, 0.05),
    bauds=_SLOW_BAUDS,
    overflow_mv_per_v=2.5,
    source="AD104 operating manual, sections 7 and 8",
)

AD101B = Profile(
    name="AD101B/AD103",
    types=(r"AD10[13]", r"AED"),
    rates_per_s=(600.0, 300.0, 150.0, 75.0, 37.5, 18.75, 9.375, 4.688),
    cut_offs_hz=(None, 40.0, 18.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25),
    bauds=_SLOW_BAUDS,
    overflow_mv_per_v=2.5,
    source="AD101B manual; the AD103 has the same engine",
)

FIT = Profile(
    name="FIT class",
    types=(r"FIT", r"AD105", r"C16i"),
    rates_per_s=tuple(1200.0 / 2**icr for icr in range(8)),
    # The ends are documented (200 to 0.25 Hz), the steps between are the AD101B's.
    cut_offs_hz=(None, 200.0, 100.0, 40.0, 18.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25),
    bauds=(*_SLOW_BAUDS, 57600, 115200),
    overflow_mv_per_v=2.5,
    source="FIT data sheet (rates 4 to 1200 per s, filters 200 to 0.25 Hz); steps inferred",
)

PROFILES = (AD104, AD101B, FIT)


ADD_A_PROFILE = "add a Profile in rig/amplifier/profile.py from its manual"


def find_profile(identity: Identity) -> Profile | None:
    """The dialect of a node; None where none is known for its type."""
    for profile in PROFILES:
        if any(re.match(pattern, identity.type) for pattern in profile.types):
            return profile
    return None


def profile_of(identity: Identity) -> Profile:
    """The dialect of a node, for what cannot be done without one.

    Raises
    ------
    DeviceError
        None is known for its type; nothing is assumed.
    """
    profile = find_profile(identity)
    if profile is not None:
        return profile
    raise DeviceError(
        f"the amplifier with serial number {identity.serial_number} is a {identity.type!r}, "
        "of which no dialect is known",
        allowed=", ".join(profile.name for profile in PROFILES),
        remedy=f"{ADD_A_PROFILE}; nothing is assumed",
    )
