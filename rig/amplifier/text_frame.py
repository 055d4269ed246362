"""Measured values as text: the ASCII formats of COF (protocol note, section 5)."""

import re
from dataclasses import dataclass
from functools import cached_property

from rig.amplifier.frame import (
    BINARY_BASES,
    BUS_MODE,
    CRLF,
    WITHOUT_CRLF,
    BadFrameError,
    FrameFormat,
    Reading,
    ValueFormat,
)

TEXT_BASES = (1, 3, 5, 7, 9, 11)
"""COF base codes of text formats; 5 and 7 are 1 and 3."""

WITH_ADDRESS = (1, 5, 9)
WITH_STATUS = (9, 11)

DIGITS_PER_MV_PER_V = 500_000
"""At NOV=0 and the factory curve: 2 mV/V are 1 000 000 digits (section 6)."""

CLAMP = 1_638_399
"""Where the AD104 holds its text values on overload (section 5)."""

MOST_DIGITS = 9_999_999
"""The end of what seven digits hold, where nothing else is known of the amplifier."""

SEPARATOR = ","
"""Between the parts of a value: TEX172, which is written and read back before a run."""

_VALUE_CHARS, _ADDRESS_CHARS, _STATUS_CHARS = 8, 2, 3


@dataclass(frozen=True)
class TextFormat:
    """One text format: a sign or blank and seven digits, perhaps an address, perhaps a status.

    Attributes
    ----------
    address
        That each value carries, None where the format has none. Another one is a bad frame.
    status
        Whether three digits of status follow.
    clamp
        Where the amplifier holds its values on overload.
    """

    address: int | None = None
    status: bool = False
    clamp: int = CLAMP

    @property
    def length(self) -> int:
        """Bytes of one value on the line: 10, 13, 14 or 17."""
        parts = _VALUE_CHARS + len(CRLF)
        parts += len(SEPARATOR) + _ADDRESS_CHARS if self.address is not None else 0
        return parts + (len(SEPARATOR) + _STATUS_CHARS if self.status else 0)

    @property
    def digits_per_mv_per_v(self) -> int:
        """Digits for an input of 1 mV/V."""
        return DIGITS_PER_MV_PER_V

    @property
    def guarded(self) -> bool:
        """Text carries no checksum."""
        return False

    @property
    def ends_in_crlf(self) -> bool:
        """Text ends in CR LF (TEX172)."""
        return True

    @property
    def alignable(self) -> bool:
        """CR LF stands nowhere else in text."""
        return True

    def encode(self, digits: int, status: int = 0) -> bytes:
        """A value as an amplifier sends it."""
        value = max(-self.clamp, min(self.clamp, digits))
        words = [f"{'-' if value < 0 else ' '}{abs(value):07d}"]
        if self.address is not None:
            words.append(f"{self.address:02d}")
        if self.status:
            words.append(f"{status:03d}")
        return SEPARATOR.join(words).encode("ascii") + CRLF

    def decode(self, raw: bytes) -> Reading:
        """The value in exactly one frame.

        Raises
        ------
        BadFrameError
            A character is not what stands at its place, or the address is another's.
        """
        if len(raw) != self.length:
            raise BadFrameError(f"{len(raw)} of {self.length} bytes", raw)
        match = self._pattern.fullmatch(raw)
        if match is None:
            raise BadFrameError("no value as text", raw)
        status = int(match["status"]) if self.status else 0
        if status > 0xFF:
            raise BadFrameError(f"status {status}", raw)
        if self.address is not None and int(match["address"]) != self.address:
            raise BadFrameError(f"the value of address {int(match['address']):02d}", raw)
        digits = int(match["value"])
        return Reading(digits, status, clamped=abs(digits) >= self.clamp)

    @cached_property
    def _pattern(self) -> re.Pattern[bytes]:
        separator = re.escape(SEPARATOR)
        return re.compile(
            (
                r"(?P<value>[-+ ]\d{7})"
                + (rf"{separator}(?P<address>\d\d)" if self.address is not None else "")
                + (rf"{separator}(?P<status>\d{{3}})" if self.status else "")
                + r"\r\n"
            ).encode("ascii")
        )


def formats_of(cof: int, csm: int, address: int) -> tuple[ValueFormat, ...]:
    """The formats that a COF code may mean on the line; which one it is must be probed.

    Parameters
    ----------
    cof
        0..255; the bus mode's 16 does not matter.
    csm
        0 or 1: whether COF 8 and 12 carry a checksum instead of the status.
    address
        Of the node, which some text formats repeat.

    Returns
    -------
    tuple of ValueFormat
        With CR LF first; empty where the code is none.
    """
    base = cof % BUS_MODE
    if base in BINARY_BASES:
        return tuple(FrameFormat.of_output_format(cof, csm, crlf) for crlf in (True, False))
    if base in TEXT_BASES and not cof & WITHOUT_CRLF:
        return (TextFormat(address if base in WITH_ADDRESS else None, base in WITH_STATUS),)
    return ()
