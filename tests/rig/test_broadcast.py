"""The broadcast sweep: one trigger for all amplifiers, then value by value."""

from itertools import count
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import (
    HeldUp,
    WavePlatform,
    all_true,
    record_virtually,
    rig_text,
    simulated_line,
    virtual_clock,
    with_bus,
    without_noise,
)
from test_faulty_line import Witness, triggered_s

from cdpr8.errors import DeviceError, RigFileError
from cdpr8.rigfile import Rig
from cdpr8.rigfile.load import parse_rig
from cdpr8.runfolder import load_run
from rig.amplifier import message
from rig.amplifier.frame import BadFrameError
from rig.broadcast import BroadcastBus, open_bus
from rig.finding import Verdict
from rig.intake import Intake
from rig.sampler import Sampler
from rig.scan import scan
from rig.simulated.node import Selection, SimulatedNode
from rig.simulated.rig import assemble
from rig.simulated.signal import NodeSignal
from rig.streams import BusStream, Span
from rig.tally import Tally
from rig.transport import MemoryTransport
from rig.verify import verify

NOTE = {9600: 9.6, 19200: 19.0, 38400: 36.8, 57600: 53.6, 115200: 98.3}
"""Sweeps a second with a wait of 1.67 ms (protocol note, section 9): output rate 1 of a FIT."""


@pytest.fixture
def broadcast(rig: Rig) -> Rig:
    return with_bus(rig, sweep="broadcast")


def sweeps(rig: Rig, seconds: float) -> float:
    _, transport = simulated_line(rig)
    bus = open_bus(transport, rig)
    stations = bus.start()
    start_s, taken = transport.clock.monotonic_s(), 0
    while transport.clock.monotonic_s() < start_s + seconds:
        bus.take(stations[taken % 8], stations[(taken + 1) % 8])
        taken += 1
    return taken / 8 / (transport.clock.monotonic_s() - start_s)


@pytest.mark.parametrize(("baud", "expected"), NOTE.items())
def test_nine_tenths_of_the_theoretical_sweep_rate(
    broadcast: Rig, baud: int, expected: float
) -> None:
    rate = sweeps(with_bus(broadcast, baud=baud, output_rate=1), 3.0)
    assert 0.9 * expected <= rate <= 1.01 * expected


@pytest.mark.parametrize(("cof", "length"), [(24, 6), (8, 6), (88, 6), (40, 4), (2, 4), (34, 2)])
def test_the_rate_is_what_the_line_can_carry(broadcast: Rig, cof: int, length: int) -> None:
    line_s = (9 + 8 * (4 + length)) * 11 / 115200
    rate = sweeps(with_bus(broadcast, output_format=cof), 2.0)
    assert 0.9 / (line_s + 1 / 1200) <= rate <= 1.0 / (line_s + 1 / 1200)


@pytest.mark.parametrize(("baud", "output_rate"), [(115200, 0), (9600, 0), (115200, 3)])
def test_all_amplifiers_measure_within_one_period_and_are_timed_within_a_third(
    broadcast: Rig, baud: int, output_rate: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = with_bus(without_noise(broadcast), baud=baud, output_rate=output_rate)
    _, transport = simulated_line(rig, WavePlatform(2.0))
    bus = open_bus(transport, rig)
    stations = bus.start()
    period_s, given = stations[0].period_s, list[float]()
    value = NodeSignal.value

    def noted(signal: NodeSignal, number: int, icr: int, asf: int) -> tuple[int, int]:
        given.append(signal.sampled_s(number, icr))
        return value(signal, number, icr, asf)

    monkeypatch.setattr(NodeSignal, "value", noted)
    times = [bus.take(stations[number % 8]).sampled_s for number in range(4000)]
    told, true = np.reshape(times, (500, 8)), np.reshape(given, (500, 8))
    assert (np.ptp(told, axis=1) == 0.0).all()  # one instant for all
    skew = np.ptp(true, axis=1)
    assert skew.max() <= period_s * 1.001
    errors = told - true
    assert np.sqrt(np.mean(errors**2)) < 0.35 * period_s
    assert abs(np.mean(errors)) < 0.05 * period_s
    # Between two cables both ages count: up to sqrt(1/6) of a period, apart from the phases.
    between = true[:, 1:] - true[:, :1]
    assert np.sqrt(np.mean(between**2)) < 0.6 * period_s
    # The polled sweep lies over its whole length.
    polled = 8 * 10 * transport.line.char_s
    if output_rate == 0:
        assert skew.max() < polled / 5


def test_a_broadcast_run_is_recorded_read_and_found_good(broadcast: Rig, tmp_path: Path) -> None:
    platform = WavePlatform(5.0, 2.06)
    record_virtually(broadcast, tmp_path / "run", 4.0, platform=platform)
    run = load_run(tmp_path / "run")
    assert run.stop.lost == {}
    assert run.start.nodes[0].settings["COF"] == "008"
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        assert len(rows) > 4.0 * 0.9 * 107
        error = rows["tension_n"] - platform.tension_at(cable, rows["t_s"].to_numpy())
        slope = 5.0 * 2 * np.pi * 2.06 / np.sqrt(2)
        assert error.std() == pytest.approx(np.hypot(0.005, slope / 1200 / np.sqrt(12)), rel=0.2)
    sweep = run.tension.groupby("t_s")["cable"].apply(list)
    assert (sweep.iloc[1:-1].apply(len) == 8).all()
    found = {each.what: each for each in verify(run)}
    assert {each.verdict for each in found.values()} == {Verdict.OK}
    assert "triggered together" in found["skew"].words


def test_what_the_trigger_was_held_up_by_makes_no_value_wrong(broadcast: Rig) -> None:
    # An adapter holds what is written, in order: one in 97 writes, so any of them.
    line, transport = simulated_line(broadcast, WavePlatform(1.0, 0.3))
    bus = open_bus(transport, broadcast)
    stations = bus.start()
    written, write = count(1), transport.write

    def held_write(data: bytes) -> None:
        if next(written) % 97 == 0:
            now_s = transport.clock.monotonic_s()
            line._request_free_s = max(line._request_free_s, now_s + 0.008)
        write(data)

    transport.write = held_write
    origin_s = transport.clock.monotonic_s()
    witness, tally = Witness(line, origin_s, triggered_s(broadcast)), Tally()
    stream = BusStream(
        bus, stations, Intake(witness, tally, origin_s), Span(origin_s, origin_s + 5.0)
    )
    while stream.step():
        pass
    assert witness.wrong == []
    assert tally.lost["untimed"] >= 8
    assert witness.good > 0.9 * witness.written > 3000


def test_a_trigger_that_nobody_heard_gives_no_old_values(broadcast: Rig) -> None:
    line, transport = simulated_line(broadcast, WavePlatform(1.0, 0.3))
    bus = open_bus(transport, broadcast)
    stations = bus.start()
    triggers, fetches, hear, lost = count(1), count(1), line.hear, list[int]()

    def mishear(data: bytes, start_s: float) -> None:
        if data == message.TRIGGER and (number := next(triggers)) % 23 == 0:
            lost.append(number)
            # Not heard at all; heard by the one that is selected; heard as a stream without end.
            kinds = (b"S97;MSV?;", b"S9;MSV?;", b"S98;MSV?0;", b"S08;MSV?;")
            data = kinds[len(lost) % 4]
        elif data == b"S03;" and next(fetches) % 41 == 0:
            data = b"S30;"  # and 3 holds its value
        hear(data, start_s)

    line.hear = mishear
    origin_s = transport.clock.monotonic_s()
    witness, tally = Witness(line, origin_s, triggered_s(broadcast)), Tally()
    stream = BusStream(
        bus, stations, Intake(witness, tally, origin_s), Span(origin_s, origin_s + 30.0)
    )
    while stream.step():
        pass
    assert len(lost) > 20
    assert witness.wrong == []
    assert witness.good > 0.8 * witness.written > 3000
    assert not line.nodes[0].measuring


def test_one_that_missed_the_trigger_gives_no_value_of_an_earlier_one_as_new(
    broadcast: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Its value was not fetched, then it alone misses the next trigger: it still holds the old one.
    line, transport = simulated_line(broadcast, WavePlatform(1.0, 0.3))
    bus = open_bus(transport, broadcast)
    stations = bus.start()
    for station in stations:
        assert bus.take(station).timed
    hear = line.hear
    line.hear = lambda data, start_s: hear(data.replace(b"S05;", b"S55;"), start_s)
    for station in stations:
        if station.cable != 5:
            assert bus.take(station).timed
        else:
            with pytest.raises(BadFrameError):
                bus.take(station)
    line.hear = hear
    obey = SimulatedNode.obey
    deaf = line.nodes[4]
    monkeypatch.setattr(
        SimulatedNode,
        "obey",
        lambda node, text, now_s: None if node is deaf else obey(node, text, now_s),
    )
    assert [bus.take(station).timed for station in stations] == [
        station.cable != 5 for station in stations
    ]
    monkeypatch.undo()
    assert all(bus.take(station).timed for station in stations)


def test_an_amplifier_that_gives_a_value_twice_is_refused(
    broadcast: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, transport = simulated_line(broadcast)
    select = SimulatedNode.select

    def keep(node: SimulatedNode, address: int, now_s: float) -> object:
        held = node._held
        answer = select(node, address, now_s)
        if answer is not None and address == 2:
            node._held = held
        return answer

    monkeypatch.setattr(SimulatedNode, "select", keep)
    with pytest.raises(DeviceError, match="amplifier 02 gives a value twice") as fault:
        open_bus(transport, broadcast).start()
    assert 'sweep = "polled"' in fault.value.remedy


def test_an_amplifier_that_takes_longer_than_its_period_is_refused(
    broadcast: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, transport = simulated_line(broadcast)
    ready = NodeSignal.sampled_s
    monkeypatch.setattr(
        NodeSignal, "sampled_s", lambda signal, number, icr: ready(signal, number + 2, icr)
    )
    with pytest.raises(DeviceError, match="amplifier 01 gives values that fit 0 formats") as fault:
        open_bus(transport, broadcast).start()
    assert "nothing" in fault.value.what
    assert 'or set sweep = "polled"' in fault.value.remedy


@pytest.mark.parametrize("crlf", [True, False])
def test_whether_values_carry_crlf_is_probed(broadcast: Rig, crlf: bool) -> None:
    line, transport = simulated_line(broadcast)
    for node in line.nodes:
        node._crlf_in_stream = crlf
        monkey = node.frame
        node.frame = lambda number, monkey=monkey: monkey(number)[: 6 if crlf else 4]
    stations = open_bus(transport, broadcast).start()
    assert {station.format.length for station in stations} == {6 if crlf else 4}


def test_zeros_and_pretension_are_taken_in_sweeps_too(broadcast: Rig) -> None:
    machine = assemble(broadcast, WavePlatform(), None, virtual_clock(), seed=1)
    sampler = Sampler(machine, broadcast, {})
    tensions_n = sampler.tensions_n(0.5)
    assert tensions_n == pytest.approx(
        {cable: 5.0 + 2.0 * cable for cable in range(1, 9)}, abs=0.01
    )
    assert len(sampler.signals_mv_per_v(0.5)[8]) > 0.5 * 0.9 * 107
    sampler.close()


def test_a_slow_output_rate_is_no_pause(broadcast: Rig, tmp_path: Path) -> None:
    slow = with_bus(broadcast, output_rate=7)  # 9.4 values a second
    record_virtually(slow, tmp_path / "run", 4.0, camera=False)
    run = load_run(tmp_path / "run")
    assert run.stop.lost == {}
    assert 30 <= len(run.cable_tension(1)) <= 38


def test_values_that_a_dead_program_left_behind_disturb_nobody(broadcast: Rig) -> None:
    line, transport = simulated_line(broadcast)
    bus = open_bus(transport, broadcast)
    stations = bus.start()
    bus.take(stations[0])
    assert sum(node._held is not None for node in line.nodes) == 7
    after = MemoryTransport(line, transport.line, transport.clock)
    assert all(each.trouble == "" for each in scan(after, range(1, 9)))
    bus.take(stations[0])
    stations = open_bus(MemoryTransport(line, transport.line, transport.clock), broadcast).start()
    assert len(stations) == 8
    assert all(node._held is None for node in line.nodes)


def test_a_moving_signal_and_a_jump_are_believed(broadcast: Rig) -> None:
    class Snap(WavePlatform):
        def tension_at(self, cable: int, t_s: np.ndarray) -> np.ndarray:
            return np.asarray(10.0 + 5.0 * np.sin(30.0 * t_s) + 15.0 * (t_s > 1.0))

    line, transport = simulated_line(broadcast, Snap())
    bus = open_bus(transport, broadcast)
    stations = bus.start()
    origin_s = transport.clock.monotonic_s()
    for node in line.nodes:
        node.signal.begin(origin_s)
    witness, tally = Witness(line, origin_s, triggered_s(broadcast)), Tally()
    stream = BusStream(
        bus, stations, Intake(witness, tally, origin_s), Span(origin_s, origin_s + 2.0)
    )
    while stream.step():
        pass
    # A jump of one value waits for the next sweep's: the last of a cable may be left waiting.
    assert witness.wrong == []
    assert witness.written - witness.good <= 8
    assert witness.good > 2.0 * 8 * 0.9 * 107


def test_an_early_selection_of_the_simulated_node_is_not_answered(rig: Rig) -> None:
    line, transport = simulated_line(rig)
    transport.write(b";S98;STP;COF8;MSV?;")
    node = line.nodes[0]
    assert node._selection is Selection.ALL
    number, ready_s = node._held
    assert node.select(1, ready_s - 1e-6) is None
    answer = node.select(1, ready_s)
    assert answer.data == node.frame(number)
    assert node.select(1, ready_s + 0.1) is None
    transport.write(b";S98;MSV?;")
    node.power_on(10.0)
    assert node._held is None


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ('sweep = "together"', "'together' is refused"),
        ('sweep = "broadcast"\nstreaming = true', "no broadcast reaches all of them"),
    ],
)
def test_a_sweep_that_cannot_be_is_refused_with_its_line(keys: str, said: str) -> None:
    text = rig_text().replace("[bus]\n", f"[bus]\n{keys}\n")
    with pytest.raises(RigFileError, match=said) as fault:
        parse_rig(text, "lab.toml", Path())
    assert "lab.toml:" in fault.value.where
    assert '"polled"' in fault.value.allowed or "'polled'" in fault.value.allowed


@pytest.mark.parametrize("cof", [3, 9, 19, 152])
def test_formats_that_are_no_binary_values_are_refused(broadcast: Rig, cof: int) -> None:
    _, transport = simulated_line(broadcast)
    with pytest.raises(RigFileError, match=f"output_format = {cof} gives no binary values"):
        open_bus(transport, with_bus(broadcast, output_format=cof))


def test_late_probe_answers_are_not_taken_for_formats(broadcast: Rig) -> None:
    _, inner = simulated_line(broadcast)
    late = [0.03]
    transport = HeldUp(inner, lambda data: late.pop() if late and data == b"S04;" else 0.0)
    bus = BroadcastBus(transport, broadcast)
    assert len(bus.start()) == 8
    assert late == []


def test_all_is_true_after_ten_seconds(broadcast: Rig, tmp_path: Path) -> None:
    record_virtually(broadcast, tmp_path / "run", 10.0, camera=False)
    assert all_true(load_run(tmp_path / "run"))
