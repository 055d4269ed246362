"""Amplifiers of a type nobody knows: recorded as text, timed by what was measured, and told."""

import json
import os
from collections.abc import Collection
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import (
    HeldUp,
    WavePlatform,
    all_true,
    at_origin,
    motion,
    record_spoiled,
    record_virtually,
    rig_text,
    simulated_line,
    virtual_clock,
    with_bus,
    without_noise,
)
from slow_motion import SlowMotion, slowed

from cdpr8.errors import DeviceError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, TensionStatus, load_run
from cdpr8.terminal import run_app
from rig.amplifier.node import NodeClient
from rig.amplifier.profile import FIT
from rig.bus import Bus
from rig.command import app
from rig.finding import Verdict
from rig.recorder import record
from rig.sampler import Sampler
from rig.scan import scan
from rig.simulated import rig as simulated_rig
from rig.simulated.rig import assemble
from rig.simulated.stranger import STRANGE, StrangeNode
from rig.transport import MemoryTransport
from rig.verify import verify

ALL = range(1, 9)
PERIOD_S = STRANGE.period_s(0)


def strangers(line: object) -> list[StrangeNode]:
    return [node for node in line.nodes if isinstance(node, StrangeNode)]


def errors_s(run: Run, cable: int, slope_n_per_s: float) -> np.ndarray:
    """Recorded instants less true ones: on a ramp without noise a value tells its own."""
    rows = run.cable_tension(cable)
    rows = rows[rows["t_s"] > 0.1]
    assert len(rows) > 20
    return (rows["t_s"] - (rows["tension_n"] - 5.0 - 2.0 * cable) / slope_n_per_s).to_numpy()


@pytest.mark.parametrize("baud", [115200, 9600])
@pytest.mark.parametrize("strange", [ALL, {3}, {1, 8}])
def test_instants_are_true_within_the_stated_uncertainty(
    rig: Rig, tmp_path: Path, baud: int, strange: Collection[int]
) -> None:
    rig = without_noise(with_bus(rig, baud=baud))
    platform = WavePlatform(slope_n_per_s=2.0)
    record_virtually(rig, tmp_path / "run", 8.0, platform=platform, camera=False, strange=strange)
    run = load_run(tmp_path / "run")
    assert run.stop.lost == {}
    for node in run.start.nodes:
        period_s = PERIOD_S if node.cable in strange else FIT.period_s(0)
        assert node.output_period_s == pytest.approx(period_s, rel=0.15)
        assert node.sampling_sigma_s == pytest.approx(node.output_period_s / np.sqrt(12))
        errors = errors_s(run, node.cable, 2.0)
        # A sweep that waits for one keeps step with it: the age of another's values, somewhere
        # within its period, changes slowly only.
        assert np.abs(errors).max() < 1.05 * np.sqrt(3) * node.sampling_sigma_s
        if node.cable in strange:  # it answers when its value is new
            assert np.abs(errors).max() < 1e-4


@pytest.mark.parametrize("baud", [115200, 9600])
def test_one_that_gives_its_newest_value_at_once_is_timed_by_the_mean_age(
    rig: Rig, baud: int
) -> None:
    rig = without_noise(with_bus(rig, baud=baud))
    line, transport = simulated_line(rig, WavePlatform(slope_n_per_s=2.0), strange={2})
    strangers(line)[0].gives_newest = True
    bus = Bus(transport, rig)
    stations = bus.start()
    station = stations[1]
    assert not station.pace.next_value
    # At 9600 baud the line cannot tell a period shorter than a value takes on it.
    line_s = 10 * transport.line.char_s
    assert station.period_s == pytest.approx(max(PERIOD_S, line_s), rel=0.05)
    errors = []
    for _ in range(300):
        for each in stations:
            value = bus.take(each)
            if each is station:
                true_s = (station.scaling.tension_n(value.reading.digits) - 9.0) / 2.0
                errors.append(value.sampled_s - true_s)
    assert np.sqrt(np.mean(np.square(errors))) < 2.0 * station.period_s / np.sqrt(12)


@pytest.mark.parametrize(("baud", "at_most"), [(115200, 1.0), (38400, 2.0), (9600, 2.0)])
def test_a_line_too_slow_to_tell_the_period_makes_instants_less_sure_not_wrong(
    rig: Rig, baud: int, at_most: float
) -> None:
    rig = without_noise(with_bus(rig, baud=baud))
    line, transport = simulated_line(rig, WavePlatform(slope_n_per_s=2.0), strange={4})
    quick = line.nodes[3]
    quick.signal = line.nodes[2].signal  # 1200 values a second, faster than the line carries text
    bus = Bus(transport, rig)
    station = bus.start()[3]
    line_s = 10 * transport.line.char_s
    assert 0.8 * FIT.period_s(0) < station.period_s < 1.01 * line_s
    for _ in range(200):
        value = bus.take(station)
        true_s = (station.scaling.tension_n(value.reading.digits) - 11.0) / 2.0
        error = value.sampled_s - true_s
        assert abs(error) < at_most * station.period_s / np.sqrt(12)


@pytest.mark.parametrize("held", [0.002, 0.02, 0.12])
def test_a_busy_computer_does_not_make_the_period_another(rig: Rig, held: float) -> None:
    _, inner = simulated_line(rig, strange=ALL)
    asked = 0

    def held_s(request: bytes) -> float:
        nonlocal asked
        asked += b"MSV?" in request
        return held if b"MSV?" in request and asked % 5 == 0 else 0.0

    stations = Bus(HeldUp(inner, held_s), rig).start()
    for station in stations:
        assert station.period_s == pytest.approx(PERIOD_S, rel=0.05)
        assert station.pace.next_value


@pytest.mark.parametrize(("held_s", "timed"), [(0.0, True), (0.006, True), (0.01, False)])
def test_a_value_held_up_beyond_its_wait_has_no_known_time(
    rig: Rig, held_s: float, timed: bool
) -> None:
    _, inner = simulated_line(without_noise(rig), WavePlatform(slope_n_per_s=2.0), strange={3})
    held = [0.0]
    bus = Bus(HeldUp(inner, lambda _: held[0]), rig)
    station = bus.start()[2]
    held[0] = held_s
    for _ in range(20):
        value = bus.take(station)
        assert value.timed is timed
        true_s = (station.scaling.tension_n(value.reading.digits) - 11.0) / 2.0
        if timed:
            assert abs(value.sampled_s - true_s) < (PERIOD_S if held_s else 1e-4)


@pytest.mark.parametrize("strange", [ALL, {3}])
def test_a_bad_line_makes_no_wrong_value(
    rig: Rig, tmp_path: Path, strange: Collection[int]
) -> None:
    rates = {"flip": 3e-4, "drop": 3e-4, "insert": 3e-4}
    recording, _ = record_spoiled(rig, tmp_path / "run", 30.0, rates, strange=strange)
    run = load_run(tmp_path / "run")
    assert all_true(run)
    assert sum(recording.stop.lost.values()) > 10
    assert len(run.cable_tension(3)) > 500


def test_where_a_selection_is_lost_nobody_answers_for_another(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1, strange={4, 5, 6})
    line = machine.transport._far_end
    hear, asked = line.hear, []

    def mishear(data: bytes, start_s: float) -> None:
        if b"S05;MSV?;" in data:
            asked.append(data)
            if len(asked) % 7 == 0:
                data = data.replace(b"S05;", b"")
        hear(data, start_s)

    def begin(_: float) -> None:
        line.hear = mishear

    at_origin(machine, begin)
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(5.0), clock=clock, machine=machine
    )
    run = load_run(tmp_path / "run")
    assert recording.stop.lost["no_answer"] == pytest.approx(len(asked) / 7, abs=2)
    assert "unconfirmed" not in recording.stop.lost
    assert all_true(run)


def test_one_that_restarts_is_set_before_its_values_count(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1, strange={2})
    (node,) = strangers(machine.transport._far_end)
    # Its EEPROM gives text too, with a tare in it: nothing in a value would show that.
    node._eeprom |= {"COF": 3, "TAS": 0, "TAV": 640_000, "TEX": 172}
    node.reload()
    hear = machine.transport._far_end.hear
    origin: list[float] = []

    def reset_once(data: bytes, start_s: float) -> None:
        if origin and start_s > origin[0] + 1.0:
            origin.clear()
            node.power_on(start_s + 2.0)
        hear(data, start_s)

    machine.transport._far_end.hear = reset_once
    at_origin(machine, origin.append)
    record(rig, rig_text(), tmp_path / "run", excitation=motion(8.0), clock=clock, machine=machine)
    run = load_run(tmp_path / "run")
    assert {"node_lost", "node_back", "gap"} <= set(run.events["kind"])
    assert run.cable_tension(2)["t_s"].max() > 7.8
    assert all_true(run)


def test_overload_is_told_by_force_and_no_flag_is_made_up(rig: Rig, tmp_path: Path) -> None:
    record_virtually(
        rig,
        tmp_path / "run",
        2.0,
        platform=WavePlatform(slope_n_per_s=90.0),  # up to 200 N: beyond any electronics
        camera=False,
        strange={1, 8},
    )
    run = load_run(tmp_path / "run")
    for cable in (1, 8):
        rows = run.tension[run.tension["cable"] == cable]
        over = (rows["status"] & int(TensionStatus.HOST_OVERLOAD)) != 0
        assert (over == (rows["tension_n"].abs() > 60)).all()
        made_up = TensionStatus.ADC_OVERFLOW | TensionStatus.NET_OVERFLOW
        made_up |= TensionStatus.GROSS_OVERFLOW
        assert ((rows["status"] & int(made_up)) == 0).all()
        assert run.events[run.events["cable"] == cable]["kind"].tolist() == ["overload"]


def test_a_user_is_told_once_a_type_and_the_run_keeps_it(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1, strange={2, 5})
    told: list[str] = []
    record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(1.0),
        clock=clock,
        machine=machine,
        warn=told.append,
    )
    (words,) = (each for each in told if "no dialect is known" in each)
    assert words.startswith("the amplifier of cable 2, 5 is of the type 'AD112'")
    for part in ("measured as 5.00 ms", "not written to it", "known load", "add a Profile"):
        assert part in words
    run = load_run(tmp_path / "run")
    known, node = run.start.nodes[0], run.start.nodes[1]
    assert (known.profile, node.profile) == (FIT.name, "unknown")
    assert (node.filter_delay_s, node.filter_delay_from) == (None, "unknown")
    assert node.value_bytes == 10
    assert node.settings["COF"] == "003"
    assert node.settings["ICR"] == "0"  # read, not written
    assert node.settings["TRC"] == "?"
    verdicts = {each.what: each for each in verify(run) if each.verdict is not Verdict.OK}
    assert set(verdicts) == {"amplifiers", "delay"}
    assert words in verdicts["amplifiers"].words
    assert verdicts["delay"].words.startswith("cable 2, 5: not known")


def test_a_delay_of_its_own_that_was_measured_is_taken_off(rig: Rig, tmp_path: Path) -> None:
    from cdpr8.rigfile.load import parse_rig

    text = rig_text().replace("address = 2,", "address = 2, filter_delay_s = 0.0052,", 1)
    text = text.replace("[bus]\n", "[bus]\nfilter_delay_s = 0.001\n")
    parsed = parse_rig(text, "lab.toml", Path())
    record_virtually(parsed, tmp_path / "run", 1.0, camera=False, strange={2, 5})
    nodes = load_run(tmp_path / "run").start.nodes
    assert (nodes[1].filter_delay_s, nodes[1].filter_delay_from) == (0.0052, "measured")
    assert nodes[4].filter_delay_s is None  # the bus's is of a filter that was not written to it
    assert nodes[0].filter_delay_s == 0.001


def test_what_is_not_asked_of_it_is_left_as_it_was(rig: Rig) -> None:
    line, transport = simulated_line(with_bus(rig, filter=4, output_rate=3), strange={6})
    (node,) = strangers(line)
    node.settings.update({"ASF": 2, "ICR": 1, "ZTR": 1, "TAS": 0, "NOV": 5000})
    Bus(transport, rig).start()
    assert (node.settings["ASF"], node.settings["ICR"]) == (2, 1)
    assert (node.settings["ZTR"], node.settings["TAS"], node.settings["NOV"]) == (0, 1, 0)
    assert not node.measuring


def test_zeros_and_scan_know_such_an_amplifier(rig: Rig) -> None:
    machine = assemble(rig, WavePlatform(), None, virtual_clock(), seed=1, strange={7})
    sampler = Sampler(machine, rig, {})
    signals = sampler.signals_mv_per_v(2.0)
    for cable in ALL:
        assert np.mean(signals[cable]) == pytest.approx((5.0 + 2.0 * cable) / 50.0, abs=1e-3)
    sampler.close()
    strangers(machine.transport._far_end)[0].refuses += ("NOV",)
    found = list(scan(machine.transport, range(1, 9)))
    assert [each.trouble for each in found] == [""] * 8
    assert {each.dialect for each in found} == {FIT.name, "unknown: text, polled"}
    assert found[6].signal_mv_per_v is None  # it does not tell whether it scales
    assert "does not tell its" in found[6].own_scaling
    assert "NOV" in found[6].own_scaling


@pytest.mark.usefixtures("here")
def test_scan_and_set_baud_name_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rig.simulated import ahead

    nodes = simulated_rig.simulated_nodes
    monkeypatch.setattr(
        simulated_rig, "simulated_nodes", lambda *those: nodes(*those[:4], frozenset({3}))
    )
    monkeypatch.setattr(ahead, "simulate_ahead", lambda *_: WavePlatform(1.0))
    assert run_app(app, ["scan", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found[2]["dialect"] == "unknown: text, polled"
    assert found[2]["signal_mv_per_v"] == pytest.approx(11.0 / 50.0, abs=1e-3)
    assert run_app(app, ["set-baud", "--baud", "38400", "--yes"]) == 4
    assert "nothing is assumed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("keys", "said"),
    [({"sweep": "broadcast"}, 'sweep = "broadcast"'), ({"streaming": True}, "streaming = true")],
)
def test_other_ways_than_asking_are_refused_with_a_remedy(
    rig: Rig, keys: dict[str, object], said: str
) -> None:
    clock = virtual_clock()
    rig = with_bus(rig, **keys)
    machine = assemble(rig, WavePlatform(), None, clock, seed=1, strange={3})
    folder = Path("never")
    with pytest.raises(DeviceError) as fault:
        record(rig, rig_text(), folder, excitation=motion(1.0), clock=clock, machine=machine)
    assert not folder.exists()
    assert "it is a 'AD112', of which no dialect is known" in fault.value.what
    assert said in fault.value.what
    assert fault.value.where.startswith("cable 3, amplifier 03 on ")
    assert 'set [bus] sweep = "polled"' in fault.value.remedy
    assert "add a Profile" in fault.value.remedy


@pytest.mark.parametrize(
    ("refuses", "settings", "said"),
    [
        (("MSV",), {}, r"answers MSV\?0; with b'\?\\r\\n'"),
        (("COF",), {}, r"COF3; was answered with \?"),
        (("SPW",), {"NOV": 5000}, r'SPW"AED"; was answered with \?'),
        ((), {"LDW": 77}, "its digits would be scaled wrong: LDW is 00000077"),
    ],
)
def test_what_cannot_be_recorded_even_as_text_is_refused(
    rig: Rig, refuses: tuple[str, ...], settings: dict[str, int], said: str
) -> None:
    line, transport = simulated_line(rig, strange={3})
    (node,) = strangers(line)
    node.refuses += refuses
    node.settings.update(settings)
    with pytest.raises(DeviceError, match=said) as fault:
        Bus(transport, rig).start()
    assert fault.value.remedy
    assert "03" in fault.value.what + fault.value.where


def test_the_simulated_one_refuses_what_such_a_node_may_refuse(rig: Rig) -> None:
    _, transport = simulated_line(rig, strange={3})
    transport.write(b";S98;STP;S03;COF24;COF8;COF19;CSM1;COF3;MSV?2;")
    assert transport.drain(0.1)[:15] == b"?\r\n?\r\n?\r\n?\r\n0\r\n"
    node = NodeClient(Bus(transport, rig)._dialogue, 3)
    assert node.identify().type == "AD112"


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")
@pytest.mark.parametrize("strange", [{3}, pytest.param(ALL, marks=pytest.mark.slow)])
def test_a_recording_over_a_pseudo_terminal(
    rig: Rig, tmp_path: Path, strange: Collection[int]
) -> None:
    clock = SlowMotion()
    platform = WavePlatform(3.0, 1.0)
    machine = slowed(assemble(rig, platform, None, clock, seed=1, strange=strange), clock)
    assert not isinstance(machine.transport, MemoryTransport)
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(1.5), clock=clock, machine=machine
    )
    assert recording.fault is None
    run = load_run(tmp_path / "run")
    for cable in ALL:
        rows = run.cable_tension(cable)
        assert len(rows) > 5
        error = rows["tension_n"].to_numpy() - platform.tension_at(cable, rows["t_s"].to_numpy())
        # Of the wave's 19 N/s, what a period makes at most, and noise.
        assert np.median(np.abs(error)) < 0.06
        if cable in strange:
            assert run.start.nodes[cable - 1].output_period_s == pytest.approx(PERIOD_S, rel=0.1)
