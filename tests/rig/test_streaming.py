"""One port per amplifier: alignment, numbering, times and losses of values that come unasked."""

import math
import os
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rig_stand_ins import (
    WavePlatform,
    at_origin,
    motion,
    record_spoiled,
    record_virtually,
    rig_text,
    virtual_clock,
    with_bus,
    without_noise,
)

from cdpr8.clock import RealClock
from cdpr8.errors import RigFileError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, load_run
from rig.amplifier.frame import Check, FrameFormat
from rig.ending import Recording
from rig.machine import Machine, open_machine
from rig.recorder import record
from rig.simulated.rig import assemble
from rig.streaming.lock import VALUES_TO_LOCK, FrameLock
from rig.streaming.node_clock import NodeClock
from rig.streaming.stream import StreamingStream
from rig.streams import Span
from rig.transport import LineLostError, Received, Transport
from rig.transport.end import Around

CRLF = FrameFormat(4, True, Check.CHECKSUM, crlf=True)
BARE = FrameFormat(4, True, Check.CHECKSUM, crlf=False)
SLOPE = 2.0
PERIOD_S = 1 / 600


def streaming(rig: Rig) -> Rig:
    return with_bus(rig, streaming=True, output_rate=1)


def time_errors(run: Run, cable: int, slope: float = SLOPE) -> np.ndarray:
    """A ramp without noise: the value itself says when it was, which is where it is read."""
    rows = run.cable_tension(cable)
    rows = rows[rows["t_s"] > 0.1]
    true_s = (rows["tension_n"] - 5.0 - 2.0 * cable) / slope
    return (rows["t_s"] - true_s).to_numpy()


def test_eight_streams_lose_nothing_and_tell_their_times(rig: Rig, tmp_path: Path) -> None:
    platform = WavePlatform(slope_n_per_s=SLOPE)
    recording = record_virtually(
        streaming(without_noise(rig)), tmp_path / "run", 4.0, platform=platform, camera=False
    )
    assert recording.stop.lost == {}
    run = load_run(tmp_path / "run")
    for cable in range(1, 9):
        assert recording.stop.samples[cable] == pytest.approx(2400, abs=3)
        errors_s = time_errors(run, cable)
        assert np.sqrt(np.mean(errors_s**2)) < 0.2e-3


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")
def test_eight_streams_in_real_time_for_a_minute(
    rig: Rig, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    """The simulated amplifiers run in this process too, and take more of it than the recorder."""
    clock, slope = RealClock(), 0.2
    rig = streaming(without_noise(rig))
    machine = assemble(rig, WavePlatform(slope_n_per_s=slope), None, clock, seed=1)
    began = time.process_time()
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(60.0), clock=clock, machine=machine
    )
    assert recording.stop.lost == {}
    assert min(recording.stop.samples.values()) >= 60 * 600 * (1 - 2e-4) - 2
    of_a_core = (time.process_time() - began) / 60.0
    record_property("of_a_core", of_a_core)
    assert of_a_core < 0.5
    run = load_run(tmp_path / "run")
    errors_s = np.concatenate([time_errors(run, cable, slope) for cable in range(1, 9)])
    rms_s = np.sqrt(np.mean(errors_s**2))
    record_property("rms_ms", 1e3 * rms_s)
    assert rms_s < 0.2e-3


def test_spoiled_bytes_in_a_stream_never_become_good_values(rig: Rig, tmp_path: Path) -> None:
    rates = dict.fromkeys(("flip", "drop", "insert"), 6e-4)
    recording, faults = record_spoiled(streaming(rig), tmp_path / "run", 4.0, rates)
    assert sum(faults.count.values()) > 150
    run = load_run(tmp_path / "run")
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        assert (np.abs(rows["tension_n"] - 5.0 - 2.0 * cable) < 0.04).all()
        assert (np.diff(rows["t_s"]) > 0.5 * PERIOD_S).all()
    missing = sum(2400 - count for count in recording.stop.samples.values())
    assert missing == pytest.approx(recording.stop.lost["missing"], abs=0.1 * missing + 16)


def stream_of(format_: FrameFormat, digits: list[int]) -> bytes:
    return b"".join(format_.encode(each) for each in digits)


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.integers(-(2**22), 2**22), min_size=40, max_size=60),
    st.integers(60, 200),
    st.integers(1, 7),
)
@example([0] * 11 + [0x0A0000] + [0] * 28, 65, 1)
def test_a_lost_byte_costs_its_own_value_only(digits: list[int], at: int, step: int) -> None:
    data = stream_of(CRLF, digits)
    # Of equal bytes in a row it is the same which is lost: a frame's last may stand for the next's.
    while data[at + 1] == data[at]:
        at += 1
    data = data[:at] + data[at + 1 :]
    lock = FrameLock(CRLF)
    found = []
    for start in range(0, len(data), step):
        found += lock.feed(data[start : start + step])[0]
    broken = at // CRLF.length
    whole = digits[:broken] + digits[broken + 1 :]
    values = [each.reading.digits for each in found]
    assert values == whole[: len(values)]
    assert len(values) >= len(whole) - VALUES_TO_LOCK - 2 or not lock.locked


@settings(max_examples=50, deadline=None)
@given(st.binary(max_size=600), st.integers(1, 50))
def test_arbitrary_bytes_are_values_or_faults_and_none_is_invented(data: bytes, step: int) -> None:
    for format_ in (CRLF, BARE):
        lock, values = FrameLock(format_), []
        for start in range(0, len(data), step):
            values += lock.feed(data[start : start + step])[0]
        for each in values:
            length = format_.length
            assert format_.encode(each.reading.digits) == data[each.end - length : each.end]


def test_a_still_signal_without_crlf_is_never_taken_for_aligned() -> None:
    # Section 5, "Trap": shifted by one byte, 27 10 00 37 passes every checksum as 10 00 37 27.
    rng = np.random.default_rng(1)
    data = stream_of(BARE, [int(2_560_000 + 30 * each) for each in rng.standard_normal(300)])
    for shift in range(4):
        lock = FrameLock(BARE, jump_digits=25_600)
        found = [
            each.reading.digits
            for start in range(shift, len(data), 7)
            for each in lock.feed(data[start : start + 7])[0]
        ]
        assert all(abs(each - 2_560_000) < 1000 for each in found)
        assert lock.locked or lock.failed


def test_a_value_that_looks_like_crlf_does_not_lock_at_a_wrong_place() -> None:
    data = stream_of(CRLF, [0x0D0A00 + number % 200 for number in range(60)])
    for shift in range(6):
        lock = FrameLock(CRLF)
        assert lock.feed(data[shift:])[0] == []
        assert not lock.locked


def test_a_node_clock_follows_the_earliest_arrivals() -> None:
    rng = np.random.default_rng(2)
    clock, period_s = NodeClock(PERIOD_S), PERIOD_S * (1 + 80e-6)
    errors = []
    for number in range(36_000):
        true_s = 5.0 + number * period_s
        clock.add(number, true_s + rng.uniform(0.0, 0.006))
        errors.append(clock.arrival_s(number) - true_s)
    settled = np.array(errors[600:])
    assert np.sqrt(np.mean(settled**2)) < 0.2e-3
    assert 1e6 * (clock.period_s / PERIOD_S - 1) == pytest.approx(80, abs=5)


class LoggedPort:
    """A port of one cable that tells when it is listened to and when it is dealt with."""

    failed = False
    heard_s = math.inf

    def __init__(self, cable: int, log: list[tuple[str, int]]) -> None:
        self.station = SimpleNamespace(cable=cable)
        self._log = log

    def listen(self) -> None:
        self._log.append(("listen", self.station.cable))

    def poll(self) -> tuple[list[object], list[object], int]:
        self._log.append(("poll", self.station.cable))
        return [], [], 0

    def unused(self) -> bytes:
        return b""


def test_all_ports_are_listened_to_before_any_is_dealt_with() -> None:
    # What one port's values take to be dealt with would make the others' look late.
    log: list[tuple[str, int]] = []
    ports = [LoggedPort(cable, log) for cable in (1, 2, 3)]
    stream = StreamingStream(ports, None, Span(0.0, 1.0), virtual_clock())
    assert stream.step()
    assert log == [(what, cable) for what in ("listen", "poll") for cable in (1, 2, 3)]


def test_ports_must_be_named(rig: Rig) -> None:
    with pytest.raises(RigFileError, match="cable 1 has no port"):
        open_machine(with_bus(rig, streaming=True, port="/dev/x"), rig.excitation, RealClock())


class Unpluggable(Around):
    """A line that is gone from one time to another."""

    def __init__(self, inner: Transport) -> None:
        super().__init__(inner)
        self.gone_s = self.back_s = math.inf

    @property
    def gone(self) -> bool:
        return self.gone_s <= self.clock.monotonic_s() < self.back_s

    def _there(self) -> None:
        if self.gone:
            raise LineLostError("the port is gone", where=self.name)

    def write(self, data: bytes) -> None:
        self._there()
        self._inner.write(data)

    def read(self, count: int, deadline_s: float) -> Received:
        self._there()
        return self._inner.read(count, deadline_s)

    def take(self) -> Received:
        self._there()
        return self._inner.take()

    def discard(self) -> bytes:
        return self.take().data

    def drain(self, quiet_s: float) -> bytes:
        self._there()
        return self._inner.drain(quiet_s)

    def reopen(self) -> None:
        self._there()


def faulty_run(
    rig: Rig, folder: Path, seconds: float, begin: Callable[[Machine, float], None]
) -> tuple[Recording, Run]:
    """A virtual recording of eight streams to which something happens."""
    clock = virtual_clock()
    rig = streaming(rig)
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    machine.ports = tuple(Unpluggable(port) for port in machine.ports)
    machine.transport = machine.ports[0]
    at_origin(machine, lambda origin_s: begin(machine, origin_s))
    recording = record(
        rig, rig_text(), folder, excitation=motion(seconds), clock=clock, machine=machine
    )
    return recording, load_run(folder)


def test_a_port_that_is_replugged_streams_again_within_two_seconds(
    rig: Rig, tmp_path: Path
) -> None:
    def pull(machine: Machine, origin_s: float) -> None:
        machine.ports[2].gone_s, machine.ports[2].back_s = origin_s + 1.0, origin_s + 2.5

    recording, run = faulty_run(rig, tmp_path / "run", 4.5, pull)
    assert recording.fault is None
    kinds = run.events[run.events["cable"] == 3].set_index("kind")["t_s"]
    assert 1.0 <= kinds["line_lost"] < 1.1
    assert 2.5 <= kinds["line_back"] < 4.5
    values = run.cable_tension(3)
    times = values["t_s"].to_numpy()
    assert times[times > 2.5].min() < 4.5
    assert not ((times > 1.01) & (times < 2.5)).any()
    assert np.abs(values["tension_n"] - 11.0).max() < 0.04
    for cable in (1, 2, 4, 5, 6, 7, 8):  # the others do not notice
        assert recording.stop.samples[cable] == pytest.approx(2700, abs=30)


def test_a_dead_node_takes_nothing_from_the_others_and_comes_back(rig: Rig, tmp_path: Path) -> None:
    def die(machine: Machine, origin_s: float) -> None:
        port = machine.ports[4]
        (node,) = port._inner._far_end.nodes
        take = port.take

        def take_or_die() -> Received:
            now_s = port.clock.monotonic_s()
            if node.powered and origin_s + 1.0 < now_s < origin_s + 2.5:
                node.powered = False
            return take()

        port.take = take_or_die
        other = machine.ports[5]
        take_other = other.take

        def take_and_revive() -> Received:
            # A port that is held is not looked at: the time is told by its neighbour.
            now_s = other.clock.monotonic_s()
            if not node.powered and now_s >= origin_s + 2.5:
                node.powered = True
                node.power_on(now_s)  # the supply was gone: volatile settings are too
            return take_other()

        other.take = take_and_revive

    recording, run = faulty_run(rig, tmp_path / "run", 6.0, die)
    kinds = run.events[run.events["cable"] == 5].set_index("kind")["t_s"]
    assert 1.5 <= kinds["node_lost"] < 1.6
    assert 2.5 <= kinds["node_back"] < 6.0
    values = run.cable_tension(5)
    assert np.abs(values["tension_n"] - 15.0).max() < 0.04
    assert values["t_s"].max() > 5.9
    for cable in (1, 2, 3, 4, 6, 7, 8):
        assert recording.stop.samples[cable] >= 0.9 * 3600


def test_bytes_of_a_stream_that_is_started_anew_are_kept(rig: Rig, tmp_path: Path) -> None:
    sent: list[bytes] = []

    def deafen(machine: Machine, origin_s: float) -> None:
        port = machine.ports[0]
        take, noise = port.take, np.random.default_rng(5)

        def take_noise() -> Received:
            received = take()
            if origin_s + 0.5 < port.clock.monotonic_s() < origin_s + 1.0 and received.data:
                sent.append(noise.bytes(len(received.data)))
                return Received(sent[-1], received.last_byte_s, received.damaged)
            return received

        port.take = take_noise

    recording, run = faulty_run(rig, tmp_path / "run", 2.0, deafen)
    assert recording.stop.lost["restart"] >= 1
    rows = run.events[run.events["cable"] == 1]
    told = "".join(
        words.rsplit(": ", 1)[1]
        for kind, words in zip(rows["kind"], rows["detail"], strict=True)
        if kind in ("bad_frame", "stray_bytes")
    ).replace(" ", "")
    assert len(sent) > 20
    # The first bad frame is told whole, and its later bytes again with what follows.
    assert b"".join(sent)[1:].hex().upper() in told
