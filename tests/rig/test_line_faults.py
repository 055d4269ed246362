"""What goes wrong around the line: unplugged, echoing, paused, the wall clock stepped."""

import io
import math
import os
import sys
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from rich.live import Live
from rig_stand_ins import (
    WavePlatform,
    at_origin,
    motion,
    record_virtually,
    rig_text,
    simulated_line,
    virtual_clock,
    with_bus,
)
from slow_motion import SlowMotion, slowed

from cdpr8.clock import Clock, RealClock
from cdpr8.errors import DeviceError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, load_run
from cdpr8.terminal import alarm
from rig.alarm import OverloadAlarm
from rig.assignment import line_settings
from rig.broadcast import open_bus
from rig.machine import Machine
from rig.recorder import record
from rig.simulated.bus import SimulatedBus
from rig.simulated.pseudo_terminal import PseudoTerminal
from rig.simulated.rig import assemble, simulated_nodes
from rig.stop import StopRequest
from rig.tally import Tally
from rig.transport import LineLostError, MemoryTransport, TwoWire, open_serial_port
from rig.transport.end import Around

needs_terminals = pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")


@pytest.fixture(params=["polled", "broadcast"])
def rig(rig: Rig, request: pytest.FixtureRequest) -> Rig:
    """Both kinds of sweep."""
    return with_bus(rig, sweep=request.param)


class Adapter(Around):
    """A line in memory whose adapter is pulled, and plugged in again, at times of the clock."""

    def __init__(self, inner: MemoryTransport) -> None:
        super().__init__(inner)
        self.pulled_s = self.plugged_s = math.inf

    def __getattr__(self, name: str) -> object:
        self._require_there()
        return getattr(self._inner, name)

    def reopen(self) -> None:
        self._require_there()

    def _require_there(self) -> None:
        if self.pulled_s <= self.clock.monotonic_s() < self.plugged_s:
            raise LineLostError("the port is gone")


def assert_back(
    run: Run, pulled_s: float, plugged_s: float, until_s: float, within_s: float = 2.0
) -> None:
    """Lost once and back in time, and every value its own cable's."""
    lost = run.events[run.events["kind"] == "line_lost"]["t_s"]
    back = run.events[run.events["kind"] == "line_back"]["t_s"]
    assert len(lost) == len(back) == run.stop.lost["line_lost"] == 1
    assert pulled_s <= lost.iloc[0] < pulled_s + 0.5
    assert plugged_s <= back.iloc[0] < plugged_s + within_s
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        assert (np.abs(rows["tension_n"] - 5.0 - 2.0 * cable) < 0.04).all()
        assert rows["t_s"].max() > until_s


def test_a_replugged_adapter_is_back_within_two_seconds(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    adapter = machine.transport = Adapter(machine.transport)

    def pull(origin_s: float) -> None:
        adapter.pulled_s, adapter.plugged_s = origin_s + 0.7, origin_s + 1.4

    at_origin(machine, pull)
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(4.0), clock=clock, machine=machine
    )
    assert recording.fault is None
    assert_back(load_run(tmp_path / "run"), 0.7, 1.4, until_s=3.9)


@needs_terminals
@pytest.mark.parametrize(
    ("pace", "within_s"), [(3.0, 20.0), pytest.param(1.0, 2.0, marks=pytest.mark.slow)]
)
def test_a_replugged_pseudo_terminal_is_back(
    rig: Rig,
    tmp_path: Path,
    pace: float,
    within_s: float,
    record_property: Callable[[str, object], None],
) -> None:
    """As above with threads, pyserial and a port that comes back under another name.

    How soon is up to the computer, so the bar is held in real time with the slow tests.
    """
    clock, stop = SlowMotion(pace), StopRequest()
    nodes = simulated_nodes(rig, WavePlatform(), clock.monotonic_s(), 1)
    bus = SimulatedBus(nodes, line_settings(rig))
    terminal = PseudoTerminal(bus, clock, tmp_path / "port")
    transport = open_serial_port(terminal.path, bus.line, clock)
    plugged: list[float] = []

    def begin(origin_s: float) -> None:
        for node in nodes:
            node.signal.begin(origin_s)

        def pull() -> None:
            clock.sleep_until(origin_s + 0.4)
            terminal.close()
            clock.sleep_until(origin_s + 0.8)
            plugged.append(clock.monotonic_s() - origin_s)
            terminal.plug()

        threading.Thread(target=pull, daemon=True).start()

    def watch(tally: Tally, now_s: float) -> None:
        # Over once values of all cables come again.
        if tally.lost.get("line_lost"):
            seen.append(min(tally.samples.values()))
            if seen[-1] > seen[0] + 10:
                stop.request()

    seen: list[int] = []
    machine = Machine(
        transport=transport,
        camera=None,
        simulated=True,
        motion_known=True,
        begin=begin,
        close=transport.close,
    )
    recording = record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(30.0),
        clock=clock,
        machine=slowed(machine, clock),
        watch=watch,
        stop=stop,
    )
    assert recording.fault is None
    terminal.close()
    run = load_run(tmp_path / "run")
    back_s = run.events[run.events["kind"] == "line_back"]["t_s"].iloc[0]
    record_property("back_after_s", float(back_s - plugged[0]))
    assert_back(run, 0.4, plugged[0], until_s=back_s, within_s=within_s)


def test_the_echo_of_a_two_wire_line_is_swallowed(rig: Rig, tmp_path: Path) -> None:
    record_virtually(with_bus(rig, echo=True), tmp_path / "run", 2.0, camera=False)
    run = load_run(tmp_path / "run")
    assert run.stop.lost == {}
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        assert len(rows) > 100
        assert (np.abs(rows["tension_n"] - 5.0 - 2.0 * cable) < 0.04).all()


def test_an_echo_that_is_not_what_was_sent_damages_the_answer(rig: Rig) -> None:
    _, inner = simulated_line(rig)
    line = TwoWire(inner)
    bus = inner._far_end
    bus._echo = True
    bus_send = bus._send
    bus._send = lambda data, start_s, damaged=False: bus_send(
        data.replace(b"IDN", b"IDM"), start_s, damaged
    )
    line.write(b";S01;IDN?;")
    assert line.read(33, 0.1).damaged


def stand_still_once(machine: Machine, clock: Clock, stand_still: Callable[[], None]) -> None:
    """Have the recorder's thread stand still after a request, half a second into the run."""
    write, paused = machine.transport.write, []

    def write_and_stand(data: bytes) -> None:
        write(data)
        if not paused and data == b"S04;" and clock.monotonic_s() > origin[0] + 0.5:
            paused.append(True)
            stand_still()

    origin: list[float] = []

    def note_origin(origin_s: float) -> None:
        origin.append(origin_s)
        machine.transport.write = write_and_stand

    at_origin(machine, note_origin)


def assert_no_time_is_invented(run: Run, moving: WavePlatform) -> None:
    assert run.stop.lost["pause"] == 1
    assert "pause" in set(run.events["kind"])
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        true = moving.tension_at(cable, rows["t_s"].to_numpy())
        assert np.abs(rows["tension_n"] - true).max() < 0.3  # 20 ms of 6 N/s, and noise


def test_a_pause_of_two_seconds_is_said_and_no_time_is_invented(rig: Rig, tmp_path: Path) -> None:
    clock, moving = virtual_clock(), WavePlatform(1.0, 1.0)
    machine = assemble(rig, moving, None, clock, seed=1)
    stand_still_once(machine, clock, lambda: clock.advance(2.0))
    record(rig, rig_text(), tmp_path / "run", excitation=motion(3.2), clock=clock, machine=machine)
    assert_no_time_is_invented(load_run(tmp_path / "run"), moving)


@pytest.mark.slow
def test_a_thread_that_really_stands_still_invents_no_time(rig: Rig, tmp_path: Path) -> None:
    clock, moving = RealClock(), WavePlatform(1.0, 1.0)
    machine = assemble(rig, moving, None, clock, seed=1)
    stand_still_once(machine, clock, lambda: time.sleep(2.0))
    record(rig, rig_text(), tmp_path / "run", excitation=motion(3.2), clock=clock, machine=machine)
    assert_no_time_is_invented(load_run(tmp_path / "run"), moving)


class SteppedClock(RealClock):
    """The wall clock is put forward by an hour."""

    def __init__(self) -> None:
        self.ahead = timedelta()

    def wall(self) -> datetime:
        return datetime.now(UTC) + self.ahead


def test_a_stepped_wall_clock_is_noted_and_moves_no_sample(rig: Rig, tmp_path: Path) -> None:
    clock = SteppedClock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)

    def watch(_: object, now_s: float) -> None:
        if now_s > 0.4:
            clock.ahead = timedelta(hours=1)

    record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(1.2),
        clock=clock,
        machine=machine,
        watch=watch,
    )
    run = load_run(tmp_path / "run")
    steps = run.events[run.events["kind"] == "clock_step"]
    assert len(steps) == 1
    assert "+3600." in steps["detail"].iloc[0]
    # An hour is in no sample's time, however busy the computer was.
    assert np.diff(run.cable_tension(1)["t_s"]).max() < 60.0
    assert run.tension["t_s"].max() < 60.0


def test_a_display_that_stalls_does_not_touch_the_data(rig: Rig, tmp_path: Path) -> None:
    clock, stop = RealClock(), StopRequest()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)

    def watch(tally: Tally, _: float) -> None:
        # It stands still until twenty more values of each cable have come meanwhile.
        enough = min(tally.samples.values()) + 20
        wait_for(lambda: min(tally.samples.values()) >= enough)
        stop.request()

    recording = record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(60.0),
        clock=clock,
        machine=machine,
        watch=watch,
        stop=stop,
    )
    assert recording.stop.reason == "interrupted"


def test_two_amplifiers_at_one_address_are_refused(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    bus.nodes[3].settings["ADR"] = 2
    with pytest.raises(DeviceError, match="cable 2: amplifier 02 answers garbled") as told:
        open_bus(transport, rig).start()
    assert "nobody has address 04" in told.value.what
    assert "two may share the address: `rig set-address`" in told.value.remedy


def test_a_wrong_baud_rate_is_told(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    for node in bus.nodes:
        node.settings["BAUD"] = 38400
    with pytest.raises(DeviceError, match="no amplifier answers at 115200"):
        open_bus(transport, rig).start()


def test_a_garbage_burst_is_over_within_half_a_second(rig: Rig, tmp_path: Path) -> None:
    from rig.transport import Chunk

    rig_line, transport = simulated_line(rig)
    bus = open_bus(transport, rig)
    stations = bus.start()
    clock = transport.clock
    noise = np.random.default_rng(4).bytes(300)
    rig_line._outgoing.append(Chunk(noise, clock.now_s, rig_line.line.char_s))
    began_s = clock.now_s
    failures = 0
    while True:
        try:
            value = bus.take(stations[0])
        except ValueError:
            failures += 1
            continue
        break
    assert failures >= 1
    assert clock.now_s - began_s < 0.5
    assert stations[0].scaling.tension_n(value.reading.digits) == pytest.approx(7.0, abs=0.04)


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 50.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_an_alarm_speaks_and_runs_a_command(tmp_path: Path) -> None:
    told: list[str] = []
    out = tmp_path / "out"
    raise_alarm = OverloadAlarm(told.append, f"echo $CDPR8_CABLE > {out}")
    raise_alarm(3, "61.00 N: above 120 % of the cell's 50 N")
    wait_for(lambda: bool(told) and out.exists() and bool(out.read_text()))
    assert told == ["OVERLOAD cable 3: 61.00 N: above 120 % of the cell's 50 N"]
    assert out.read_text() == "3\n"


def test_a_terminal_that_stands_still_or_is_gone_keeps_no_command_from_running(
    tmp_path: Path,
) -> None:
    let_go = threading.Event()

    def stalled(_: str) -> None:
        let_go.wait(30.0)
        raise OSError(5, "Input/output error")

    out = tmp_path / "out"
    raise_alarm = OverloadAlarm(stalled, f"echo $CDPR8_CABLE >> {out}")
    raise_alarm(3, "61.00 N")
    raise_alarm(4, "62.00 N")
    wait_for(lambda: out.exists() and len(out.read_text().split()) == 2)
    assert sorted(out.read_text().split()) == ["3", "4"]
    assert not let_go.is_set()
    let_go.set()


def test_the_bell_rings_beside_the_live_table(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "__stderr__", terminal)
    with Live("table", console=Console(file=terminal, force_terminal=True), auto_refresh=False):
        alarm("OVERLOAD cable 3")
    assert "error: OVERLOAD cable 3" in terminal.getvalue()
    assert terminal.getvalue().count("\a") == 1


def test_an_overload_raises_the_alarm_once(rig: Rig, tmp_path: Path) -> None:
    raised: list[int] = []
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(45.0, 0.5), None, clock, seed=1)
    record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(1.5),
        clock=clock,
        machine=machine,
        alarm=lambda cable, _: raised.append(cable),
    )
    assert raised.count(8) == 1
