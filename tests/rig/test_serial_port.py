"""Serial ports and pseudo-terminals through pyserial, and the seam in memory."""

import os
import tty
from collections import deque
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rig_stand_ins import simulated_line, virtual_clock

from cdpr8.clock import RealClock
from cdpr8.errors import DataError, DeviceError, ExitCode
from cdpr8.rigfile import Rig
from rig.bus import Bus
from rig.transport import (
    Chunk,
    LineSettings,
    MemoryTransport,
    RecordedTransport,
    TracingTransport,
    Transport,
    open_serial_port,
)
from rig.transport.parity_marks import ParityMarks

LINE = LineSettings(115200, "even")


@pytest.fixture
def pty() -> Iterator[tuple[int, str]]:
    master, slave = os.openpty()
    tty.setraw(master)
    tty.setraw(slave)
    yield master, os.ttyname(slave)
    for descriptor in (master, slave):
        try:
            os.close(descriptor)
        except OSError:
            continue


def test_all_byte_values_pass_both_ways(pty: tuple[int, str]) -> None:
    master, path = pty
    transport = open_serial_port(path, LINE, RealClock())
    every = bytes(range(256))
    transport.write(every)
    assert os.read(master, 1000) == every
    os.write(master, every)
    received = transport.read(256, RealClock().monotonic_s() + 30.0)
    assert received.data == every
    assert not received.damaged
    transport.close()


def test_a_read_ends_at_its_deadline_with_what_came(pty: tuple[int, str]) -> None:
    master, path = pty
    clock = RealClock()
    transport = open_serial_port(path, LINE, clock)
    os.write(master, b"abc")
    began = clock.monotonic_s()
    assert transport.read(6, began + 0.05).data == b"abc"
    assert 0.05 <= clock.monotonic_s() - began < 5.0  # on whatever computer
    os.write(master, b"late")
    assert transport.drain(0.02) == b"late"
    assert transport.discard() == b""
    transport.close()


def test_what_came_behind_an_answer_is_kept_for_who_reads_next(pty: tuple[int, str]) -> None:
    master, path = pty
    clock = RealClock()
    transport = open_serial_port(path, LINE, clock)
    for after in ("read", "take", "discard"):
        os.write(master, b"answerstray")
        assert transport.read(6, clock.monotonic_s() + 30.0).data == b"answer"
        if after == "read":
            assert transport.read(5, clock.monotonic_s() + 30.0).data == b"stray"
        elif after == "take":
            assert transport.take().data == b"stray"
        else:
            assert transport.discard() == b"stray"
        assert transport.discard() == b""
    os.write(master, b"late")
    clock.sleep_until(clock.monotonic_s() + 0.01)
    assert transport.discard() == b"late"
    transport.close()


def test_a_pseudo_terminal_can_be_opened_again_with_parity_set(pty: tuple[int, str]) -> None:
    # The kernel drops parity on a pty and reports EINVAL on every second open that asks for it.
    _, path = pty
    for _ in range(3):
        transport = open_serial_port(path, LINE, RealClock())
        assert transport.line.bits_per_char == 11
        transport.close()


def test_unplugging_is_one_error_however_it_shows(pty: tuple[int, str]) -> None:
    master, path = pty
    transport = open_serial_port(path, LINE, RealClock())
    os.close(master)
    for act in (
        lambda: transport.read(6, RealClock().monotonic_s() + 0.1),
        transport.discard,
        lambda: transport.write(b"S01;"),
    ):
        with pytest.raises(DeviceError, match="the port is gone"):
            act()
    transport.close()


def test_a_port_is_one_programs_alone(pty: tuple[int, str]) -> None:
    _, path = pty
    first = open_serial_port(path, LINE, RealClock())
    with pytest.raises(DeviceError, match="in use by another program"):
        open_serial_port(path, LINE, RealClock())
    first.close()


def test_a_missing_port_is_told_with_those_there_are() -> None:
    with pytest.raises(DeviceError) as told:
        open_serial_port("/dev/ttyNOSUCH0", LINE, RealClock())
    assert told.value.exit_code == ExitCode.DEVICE
    assert "no serial port '/dev/ttyNOSUCH0'" in told.value.sentence()
    assert "ports here:" in told.value.sentence()


@pytest.mark.parametrize(
    ("name", "message"),
    [("notes.txt", "notes.txt' is no serial port"), (".", "' is no serial port"), ("", "no port")],
)
def test_what_is_no_port_is_called_so(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "notes.txt").write_text("not a device")
    path = str(tmp_path / name) if name else ""
    with pytest.raises(DeviceError, match="ports here:") as told:
        open_serial_port(path, LINE, RealClock())
    assert message in told.value.what
    assert "Errno" not in told.value.sentence()


def test_a_name_that_vanishes_while_it_is_read_is_a_port_that_is_not_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = tmp_path / "port"
    link.symlink_to("/dev/ttyNOSUCH0")

    def gone(*_: object) -> str:
        raise FileNotFoundError(2, "No such file or directory")

    monkeypatch.setattr(os, "readlink", gone)  # removed between being looked at and being read
    with pytest.raises(DeviceError, match="no serial port"):
        open_serial_port(str(link), LINE, RealClock())


def marked(data: bytes, bad: set[int]) -> bytes:
    """As a POSIX terminal with PARMRK delivers bytes of which some came with a parity error."""
    out = b""
    for place, byte in enumerate(data):
        if place in bad:
            out += bytes([0xFF, 0x00, byte])
        else:
            out += b"\xff\xff" if byte == 0xFF else bytes([byte])
    return out


@given(
    st.lists(st.sampled_from([0x00, 0xFF, 0x0D, 0x41]), max_size=20).map(bytes),
    st.sets(st.integers(0, 19)),
    st.lists(st.integers(0, 60), max_size=6),
)
def test_parity_marks_are_undone_wherever_reads_split_them(
    data: bytes, bad: set[int], cuts: list[int]
) -> None:
    raw = marked(data, bad)
    marks, plain, damaged = ParityMarks(), b"", False
    edges = [0, *sorted(min(cut, len(raw)) for cut in cuts), len(raw)]
    for start, end in pairwise(edges):
        part, part_damaged = marks.undo(raw[start:end])
        plain += part
        damaged |= part_damaged
    assert plain == data
    assert damaged == any(place < len(data) for place in bad)


def test_bytes_in_memory_take_the_time_of_the_line(rig: Rig) -> None:
    clock = virtual_clock()
    _, transport = simulated_line(rig, clock=clock)
    transport.write(b";S98;STP;")
    clock.sleep_until(1.0)
    transport.write(b";S01;ADR?;")
    received = transport.read(4, 2.0)
    chars = len(b";S01;ADR?;") + len(b"01\r\n")
    assert received.data == b"01\r\n"
    assert received.last_byte_s == pytest.approx(1.0 + chars * 11 / 115200 + 0.002, abs=1e-9)
    assert clock.now_s == received.last_byte_s


def test_an_answer_may_be_read_in_pieces_and_partly_by_its_deadline() -> None:
    pending = deque([Chunk(b"abcdef", 1.0, 0.1)])

    class OneAnswer:
        def hear(self, data: bytes, start_s: float) -> None: ...

        def speak(self, until_s: float) -> deque[Chunk]:
            return pending

    clock = virtual_clock()
    transport = MemoryTransport(OneAnswer(), LINE, clock)
    assert transport.read(2, 9.0).data == b"ab"
    assert clock.now_s == pytest.approx(1.1)
    assert transport.read(9, 1.25).data == b"c"
    assert clock.now_s == 1.25
    clock.sleep_until(1.41)
    assert transport.discard() == b"de"
    assert transport.drain(0.5) == b"f"


def test_a_recorded_conversation_repeats_without_the_amplifiers(rig: Rig, tmp_path: Path) -> None:
    def converse(transport: Transport) -> list[object]:
        bus = Bus(transport, rig)
        stations = bus.start()
        values = [bus.take(stations[number % 8]) for number in range(40)]
        bus.stop()
        return [stations, values]

    _, inner = simulated_line(rig)
    traced = TracingTransport(inner, tmp_path / "trace.jsonl")
    first = converse(traced)
    traced.close()
    lines = (tmp_path / "trace.jsonl").read_text().splitlines(keepends=True)
    played = RecordedTransport(lines, virtual_clock())
    assert converse(played) == first
    assert played.over
    other = RecordedTransport(lines, virtual_clock())
    with pytest.raises(DataError, match="is sent where the trace has"):
        other.write(b"S99;")
