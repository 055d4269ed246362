"""Measured values as bytes: the binary formats of COF (sections 5 and 12 of the AD104 manual)."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property, lru_cache
from typing import Protocol

BUS_MODE = 16
"""Offset of COF: `Sxx;` itself answers with the newest value."""

WITHOUT_CRLF = 32
"""Offset of COF: binary values without CRLF (whether a node obeys is probed, section 5)."""

POWER_ON_STREAM = 128
"""Offset of COF: stream after power-on."""

CRLF = b"\r\n"

FULL_SCALE_24 = 0x7FFFFF
FULL_SCALE_16 = 0x7FFF

DIGITS_PER_MV_PER_V = {4: 2_560_000, 2: 10_000}
"""At NOV=0 and the factory curve, by data bytes: 2 mV/V are 5 120 000 or 20 000 digits (section 6).
"""


class Check(Enum):
    """What the spare byte of a 4-byte value holds."""

    NONE = "zero"
    STATUS = "status"
    CHECKSUM = "checksum"


class BadFrameError(ValueError):
    """Bytes that are no measured value.

    Parameters
    ----------
    why
        What is wrong with them.
    raw
        All of them, as they came.
    """

    def __init__(self, why: str, raw: bytes) -> None:
        self.why, self.raw = why, raw
        super().__init__(f"{why}: {raw.hex(' ').upper() or 'nothing came'}")


@dataclass(frozen=True, slots=True)
class Reading:
    """One measured value.

    Attributes
    ----------
    digits
        The raw value: signed, 24 bit or 16 bit.
    status
        The amplifier's status byte; 0 where the format has none.
    clamped
        Whether the value is an end of the range, which means overload.
    """

    digits: int
    status: int = 0
    clamped: bool = False


class ValueFormat(Protocol):
    """How one measured value looks on the line: binary (`FrameFormat`) or text (`TextFormat`)."""

    @property
    def length(self) -> int:
        """Bytes of one value on the line."""
        ...

    @property
    def digits_per_mv_per_v(self) -> int:
        """Digits for an input of 1 mV/V."""
        ...

    @property
    def guarded(self) -> bool:
        """Whether a checksum guards each value."""
        ...

    @property
    def ends_in_crlf(self) -> bool:
        """Whether CR LF ends each value, which marks where the next begins."""
        ...

    @property
    def alignable(self) -> bool:
        """Whether anything in the bytes tells where a value begins."""
        ...

    def decode(self, raw: bytes) -> Reading:
        """The value in exactly one frame; raises `BadFrameError` where there is none."""
        ...


@dataclass(frozen=True)
class FrameFormat:
    """One binary format.

    Attributes
    ----------
    data_bytes
        2 or 4.
    most_significant_first
        Byte order.
    check
        What the spare byte of a 4-byte value holds.
    crlf
        Whether CR LF follows; known by probing only.
    """

    data_bytes: int = 4
    most_significant_first: bool = True
    check: Check = Check.STATUS
    crlf: bool = True

    @classmethod
    @lru_cache(maxsize=64)  # the simulated amplifiers look it up for each value
    def of_output_format(cls, cof: int, csm: int, crlf: bool) -> "FrameFormat":
        """The format of a COF code (section 5).

        Parameters
        ----------
        cof
            0..255; only its base code matters here.
        csm
            0 or 1: whether COF 8 and 12 carry a checksum instead of the status.
        crlf
            As probed.

        Raises
        ------
        ValueError
            The base code is an ASCII format.
        """
        base = cof % BUS_MODE
        if base not in BINARY_BASES:
            raise ValueError(f"COF {cof} is no binary format")
        spare = Check.CHECKSUM if csm else Check.STATUS
        return cls(
            data_bytes=2 if base in (2, 6) else 4,
            most_significant_first=base in (0, 2, 8),
            check=spare if base in (8, 12) else Check.NONE,
            crlf=crlf,
        )

    @cached_property  # looked at for each value, while the line waits for the next request
    def length(self) -> int:
        """Bytes of one value on the line."""
        return self.data_bytes + (len(CRLF) if self.crlf else 0)

    @property
    def digits_per_mv_per_v(self) -> int:
        """Digits for an input of 1 mV/V."""
        return DIGITS_PER_MV_PER_V[self.data_bytes]

    @property
    def guarded(self) -> bool:
        """Whether a checksum guards each value."""
        return self.data_bytes == 4 and self.check is Check.CHECKSUM

    @property
    def ends_in_crlf(self) -> bool:
        """Whether CR LF ends each value."""
        return self.crlf

    @property
    def alignable(self) -> bool:
        """Two bytes without CR LF are a value wherever one begins to read."""
        return self.crlf or self.data_bytes == 4

    @cached_property
    def full_scale(self) -> int:
        """Largest value the format holds; reaching it means overload (section 5)."""
        return FULL_SCALE_24 if self.data_bytes == 4 else FULL_SCALE_16

    def encode(self, digits: int, status: int = 0) -> bytes:
        """A value as an amplifier sends it; `digits` in the format's own range."""
        if self.data_bytes == 2:
            data = digits.to_bytes(2, "big", signed=True)
        else:
            value = digits.to_bytes(3, "big", signed=True)
            spare = 0
            if self.check is Check.STATUS:
                spare = status
            elif self.check is Check.CHECKSUM:
                spare = value[0] ^ value[1] ^ value[2]
            data = value + bytes([spare])
        if not self.most_significant_first:
            data = data[::-1]
        return data + CRLF if self.crlf else data

    def decode(self, raw: bytes) -> Reading:
        """The value in exactly one frame.

        Raises
        ------
        BadFrameError
            The length, the CR LF at its place, or the checksum is wrong.
        """
        if len(raw) != self.length:
            raise BadFrameError(f"{len(raw)} of {self.length} bytes", raw)
        if self.crlf and raw[-2:] != CRLF:
            raise BadFrameError("no CR LF at the end", raw)
        data = raw[: self.data_bytes]
        if not self.most_significant_first:
            data = data[::-1]
        status = 0
        if self.data_bytes == 4:
            data, spare = data[:3], data[3]
            if self.check is Check.STATUS:
                status = spare
            elif spare != (data[0] ^ data[1] ^ data[2] if self.check is Check.CHECKSUM else 0):
                raise BadFrameError(f"{self.check.value} byte is {spare:02X}", raw)
        digits = int.from_bytes(data, "big", signed=True)
        return Reading(digits, status, not -self.full_scale < digits < self.full_scale)


BINARY_BASES = (0, 2, 4, 6, 8, 12)
"""COF base codes of binary formats (section 5)."""
