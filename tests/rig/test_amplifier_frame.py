"""Measured values as bytes, against the protocol note's test vectors (section 5)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.amplifier.frame import BadFrameError, Check, FrameFormat, Reading

VECTORS = [
    (-123456, "FE 1D C0 08", "FE 1D C0 23"),
    (2560000, "27 10 00 08", "27 10 00 37"),
    (250, "00 00 FA 08", "00 00 FA FA"),
]
STATUS = FrameFormat(4, True, Check.STATUS, crlf=False)
CHECKSUM = FrameFormat(4, True, Check.CHECKSUM, crlf=False)

formats = st.sampled_from(
    [
        FrameFormat.of_output_format(cof, csm, crlf)
        for cof in (16, 18, 20, 22, 24, 28)
        for csm in (0, 1)
        for crlf in (True, False)
    ]
)


@pytest.mark.parametrize(("digits", "status_frame", "xor_frame"), VECTORS)
@pytest.mark.parametrize("crlf", [False, True])
def test_vectors(digits: int, status_frame: str, xor_frame: str, crlf: bool) -> None:
    tail = b"\r\n" if crlf else b""
    with_status = FrameFormat(4, True, Check.STATUS, crlf)
    reading = with_status.decode(bytes.fromhex(status_frame) + tail)
    assert (reading.digits, reading.status, reading.clamped) == (digits, 8, False)
    assert with_status.encode(digits, 8) == bytes.fromhex(status_frame) + tail
    with_sum = FrameFormat(4, True, Check.CHECKSUM, crlf)
    assert with_sum.decode(bytes.fromhex(xor_frame) + tail).digits == digits
    assert with_sum.encode(digits) == bytes.fromhex(xor_frame) + tail


def test_least_significant_first_is_the_same_bytes_reversed() -> None:
    swapped = FrameFormat(4, False, Check.STATUS, crlf=True)
    assert swapped.decode(bytes.fromhex("08 C0 1D FE 0D 0A")).digits == -123456
    assert FrameFormat(2, False, Check.NONE, crlf=False).decode(b"\x10\x27").digits == 10_000


@given(formats, st.integers(-(2**15), 2**15 - 1), st.integers(0, 255))
def test_what_is_encoded_is_decoded(format_: FrameFormat, digits: int, status: int) -> None:
    reading = format_.decode(format_.encode(digits, status))
    assert reading.digits == digits
    assert reading.status == (status if format_.check is Check.STATUS else 0)


@given(formats, st.binary(max_size=8))
def test_any_bytes_are_a_value_or_a_bad_frame_that_keeps_them(
    format_: FrameFormat, raw: bytes
) -> None:
    reading, fault = decoded(format_, raw)
    if reading is None:
        assert fault.raw == raw
    else:
        assert format_.encode(reading.digits, reading.status) == raw


def decoded(format_: FrameFormat, raw: bytes) -> tuple[Reading | None, BadFrameError | None]:
    try:
        return format_.decode(raw), None
    except BadFrameError as fault:
        return None, fault


@given(st.integers(-(2**23), 2**23 - 1), st.integers(0, 3), st.integers(1, 255), st.booleans())
def test_the_checksum_betrays_every_change_of_one_byte(
    digits: int, place: int, change: int, crlf: bool
) -> None:
    format_ = FrameFormat(4, True, Check.CHECKSUM, crlf)
    raw = bytearray(format_.encode(digits))
    raw[place] ^= change
    with pytest.raises(BadFrameError):
        format_.decode(bytes(raw))


@given(st.integers(-(2**23), 2**23 - 1), st.integers(0, 255), st.integers(0, 5))
def test_a_frame_that_lost_a_byte_is_never_another_value(
    digits: int, status: int, place: int
) -> None:
    format_ = FrameFormat()
    line = format_.encode(digits, status) * 2
    shifted = line[:place] + line[place + 1 :]
    reading, _ = decoded(format_, shifted[: format_.length])
    assert reading is None or reading.digits == digits


@pytest.mark.parametrize(
    ("format_", "raw"),
    [
        (STATUS, "7F FF FF 00"),
        (STATUS, "80 00 00 00"),
        (STATUS, "80 00 01 00"),
        (FrameFormat(2, True, Check.NONE, crlf=False), "7F FF"),
        (FrameFormat(2, True, Check.NONE, crlf=False), "80 00"),
    ],
)
def test_the_ends_of_the_range_mean_overload(format_: FrameFormat, raw: str) -> None:
    assert format_.decode(bytes.fromhex(raw)).clamped


def test_ascii_formats_are_refused() -> None:
    with pytest.raises(ValueError, match="COF 9"):
        FrameFormat.of_output_format(9, 0, crlf=True)
