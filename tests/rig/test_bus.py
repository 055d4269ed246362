"""The bus on a virtual clock: its rate, its times, and what it does when nodes or bytes fail."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import (
    WavePlatform,
    motion,
    record_virtually,
    rig_text,
    simulated_line,
    virtual_clock,
    with_bus,
    without_noise,
)

from cdpr8.errors import DeviceError, RigFileError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import BAD_TENSION, Run, TensionStatus, load_run
from rig.amplifier.frame import BadFrameError
from rig.bus import Bus
from rig.quarantine import Quarantine
from rig.recorder import Recording, record
from rig.simulated.faults import LineFaults
from rig.simulated.node import SimulatedNode
from rig.simulated.rig import assemble
from rig.transport import MemoryTransport

SWEEPS_PER_S = {9600: 10.9, 38400: 43.6, 57600: 65.5, 115200: 131.0}
"""Protocol note, section 9: bus mode, 4 bytes and CRLF, eight nodes, no turnaround."""


def sweeps(rig: Rig, seconds: float) -> float:
    _, transport = simulated_line(rig)
    bus = Bus(transport, rig)
    stations = bus.start()
    start_s, count = transport.clock.monotonic_s(), 0
    while transport.clock.monotonic_s() < start_s + seconds:
        bus.take(stations[count % 8])
        count += 1
    return count / 8 / (transport.clock.monotonic_s() - start_s)


@pytest.mark.parametrize(("baud", "expected"), SWEEPS_PER_S.items())
def test_nine_tenths_of_the_theoretical_sweep_rate(rig: Rig, baud: int, expected: float) -> None:
    assert 0.9 * expected <= sweeps(with_bus(rig, baud=baud), 3.0) <= 1.01 * expected


def test_without_crlf_sweeps_are_faster(rig: Rig) -> None:
    assert 0.9 * 164 <= sweeps(with_bus(rig, output_format=24 + 32), 1.0) <= 1.01 * 164


@pytest.mark.parametrize("output_rate", [0, 3])
def test_sampling_instants_are_right_within_a_third_of_the_output_period(
    rig: Rig, output_rate: int
) -> None:
    # A ramp without noise: the value itself says when it was sampled.
    rig = with_bus(without_noise(rig), output_rate=output_rate)
    slope = 2.0
    _, transport = simulated_line(rig, WavePlatform(slope_n_per_s=slope))
    bus = Bus(transport, rig)
    stations = bus.start()
    period_s = stations[0].period_s
    errors = []
    for count in range(4000):
        station = stations[count % 8]
        value = bus.take(station)
        tension_n = station.scaling.tension_n(value.reading.digits)
        true_s = (tension_n - 5.0 - 2.0 * station.cable) / slope
        # An average over a period belongs to its middle.
        true_s += 0.5 * (period_s - 1 / 1200)
        errors.append(value.sampled_s - true_s)
        assert value.request_s < value.received_s
    assert np.sqrt(np.mean(np.square(errors))) < 0.35 * period_s
    assert abs(np.mean(errors)) < 0.05 * period_s


def test_all_nodes_are_identified_set_and_read_back(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    stations = Bus(transport, rig).start()
    assert [station.identity.serial_number for station in stations] == [
        f"SIM{number:04d}" for number in range(1, 9)
    ]
    for node, station in zip(bus.nodes, stations, strict=True):
        for mnemonic, answer in station.settings.items():
            assert node.settings[mnemonic] == int(answer)
        assert node.measuring
        assert (node.settings["TAS"], node.settings["ZTR"], node.settings["ASF"]) == (1, 0, 0)


def test_a_missing_amplifier_is_named(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    bus.nodes[2].powered = False
    with pytest.raises(DeviceError, match=r"do not answer: cable 3 \(address 03\)"):
        Bus(transport, rig).start()


def test_an_empty_bus_is_told_with_its_speed(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    for node in bus.nodes:
        node.powered = False
    with pytest.raises(DeviceError, match="no amplifier answers at 115200 baud 8E1"):
        Bus(transport, rig).start()


def test_a_swapped_amplifier_is_refused(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    bus.nodes[4].serial_number = "1234567"
    with pytest.raises(DeviceError, match=r"cable 5.*serial number is '1234567'"):
        Bus(transport, rig).start()


def test_a_filter_the_dialect_lacks_is_refused_by_the_node_not_ignored(rig: Rig) -> None:
    rig = with_bus(rig, filter=10)
    bus, transport = simulated_line(rig)
    for node in bus.nodes:
        node._type_name = "AD104"
    with pytest.raises(DeviceError, match="filter = 10 is none of the AD104"):
        Bus(transport, rig).start()


@pytest.mark.parametrize("cof", [8, 9, 25, 152])
def test_formats_without_bus_mode_are_refused(rig: Rig, cof: int) -> None:
    _, transport = simulated_line(rig)
    with pytest.raises(RigFileError, match=f"output_format = {cof}"):
        Bus(transport, with_bus(rig, output_format=cof))


def test_two_cables_cannot_share_an_address(rig: Rig) -> None:
    cables = (rig.cable[0], *rig.cable[:7])
    _, transport = simulated_line(rig)
    with pytest.raises(RigFileError, match="cables 1 and 2 share amplifier address 1"):
        Bus(transport, rig.model_copy(update={"cable": cables}))


Trouble = Callable[[SimulatedNode, float], None]


def record_with_trouble(
    rig: Rig, tmp_path: Path, trouble: Trouble, duration_s: float = 10.0
) -> tuple[Recording, Run]:
    """A recording during which `trouble(node, t_s)` is asked before each request."""
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    far_end = machine.transport._far_end
    origin: list[float] = []
    begin, hear = machine.begin, far_end.hear

    def note_origin(origin_s: float) -> None:
        origin.append(origin_s)
        begin(origin_s)

    def hear_with_trouble(data: bytes, start_s: float) -> None:
        if origin:
            for node in far_end.nodes:
                trouble(node, start_s - origin[0])
        hear(data, start_s)

    machine.begin, far_end.hear = note_origin, hear_with_trouble
    folder = tmp_path / "run"
    recording = record(
        rig, rig_text(), folder, excitation=motion(duration_s), clock=clock, machine=machine
    )
    return recording, load_run(folder)


def all_true(run: Run) -> bool:
    """Whether every good value is the tension of its own cable, within 8 sigma of its noise."""
    good = (run.tension["status"] & int(BAD_TENSION)) == 0
    rows = run.tension[good]
    return bool((np.abs(rows["tension_n"] - 5.0 - 2.0 * rows["cable"]) < 0.04).all())


def test_a_dead_node_leaves_the_others_their_rate(rig: Rig, tmp_path: Path) -> None:
    def die(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 3 and t_s > 1.0:
            node.powered = False

    recording, run = record_with_trouble(rig, tmp_path, die)
    for cable in (1, 2, 4, 5, 6, 7, 8):
        times = run.cable_tension(cable)["t_s"]
        after = times[times > 1.0]
        assert len(after) / 9.0 >= 0.9 * 131
    assert run.cable_tension(3)["t_s"].max() < 1.01
    lost = run.events[run.events["kind"] == "node_lost"]
    assert lost["cable"].tolist() == [3]
    assert 1.0 < lost["t_s"].iloc[0] < 1.3
    assert recording.stop.lost["node_lost"] == 1


def test_a_node_that_comes_back_is_recorded_again(rig: Rig, tmp_path: Path) -> None:
    def nap(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 5:
            node.powered = not 1.0 < t_s < 2.5

    _, run = record_with_trouble(rig, tmp_path, nap, 6.0)
    assert run.events["kind"].tolist().count("node_back") == 1
    gap = run.events[run.events["kind"] == "gap"].iloc[0]
    times = run.cable_tension(5)["t_s"].to_numpy()
    assert np.diff(times).max() == pytest.approx(gap["t_s"] - 1.0, abs=0.05)
    assert times.max() > 5.9
    assert all_true(run)


def test_a_node_reset_in_mid_run_is_set_up_again_before_it_is_trusted(
    rig: Rig, tmp_path: Path
) -> None:
    done = []

    def reset(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 2 and t_s > 1.0 and not done:
            done.append(t_s)
            node.settings["TAV"] = 123456
            node.power_on(0.0)
            node.settings["TAS"] = 0
            node.settings["TAV"] = 123456

    _, run = record_with_trouble(rig, tmp_path, reset, 5.0)
    assert {"node_lost", "node_back", "gap"} <= set(run.events["kind"])
    assert run.cable_tension(2)["t_s"].max() > 4.9
    assert all_true(run)


def test_a_node_fallen_back_to_factory_settings_is_lost_and_never_misread(
    rig: Rig, tmp_path: Path
) -> None:
    done = []

    def brown_out(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 6 and t_s > 1.0 and not done:
            done.append(t_s)
            node.brown_out(t_s)

    _, run = record_with_trouble(rig, tmp_path, brown_out, 4.0)
    assert run.events["kind"].tolist().count("node_lost") == 1
    assert run.cable_tension(6)["t_s"].max() < 1.02
    assert run.cable_tension(7)["t_s"].max() > 3.9
    assert all_true(run)


@pytest.mark.parametrize("kind", ["flip", "drop", "insert"])
def test_spoiled_bytes_never_become_good_values(rig: Rig, tmp_path: Path, kind: str) -> None:
    faults = LineFaults(np.random.default_rng(5))
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1, faults=faults)
    begin = machine.begin

    def spoil_from_now_on(origin_s: float) -> None:
        setattr(faults, kind, 1e-3)
        begin(origin_s)

    machine.begin = spoil_from_now_on
    folder = tmp_path / "run"
    recording = record(
        rig, rig_text(), folder, excitation=motion(20.0), clock=clock, machine=machine
    )
    run = load_run(folder)
    assert faults.count[kind] > 80
    assert all_true(run)
    counted = sum(recording.stop.lost.get(what, 0) for what in ("bad_frame", "no_answer"))
    assert counted > 0.5 * faults.count[kind]
    bad = run.events[run.events["kind"] == "bad_frame"]
    assert len(bad) == recording.stop.lost.get("bad_frame", 0)


def test_a_late_answer_is_not_taken_for_the_next_node(rig: Rig) -> None:
    _, transport = simulated_line(without_noise(rig))
    bus = Bus(transport, rig)
    stations = bus.start()
    first, second = stations[0], stations[1]
    late = LateOnce(transport)
    late_bus = Bus(late, rig)
    late.armed = True
    with pytest.raises(BadFrameError, match="nothing came"):
        late_bus.take(first)
    assert late_bus.take(second).reading.digits == pytest.approx(second.scaling.digits(9.0), abs=1)


class LateOnce:
    """Holds one answer back until after its deadline."""

    def __init__(self, inner: MemoryTransport) -> None:
        self._inner = inner
        self.armed = False

    def __getattr__(self, name: str) -> object:
        return getattr(self._inner, name)

    def write(self, data: bytes) -> None:
        if self.armed:
            self.armed = False
            bus = self._inner._far_end
            bus._answer_free_s = self._inner.clock.monotonic_s() + 0.03
        self._inner.write(data)


def test_overload_is_flagged_and_said_once(rig: Rig, tmp_path: Path) -> None:
    # Cable 8 rests at 21 N; the wave takes it over 120 % of 50 N and back.
    record_virtually(rig, tmp_path / "run", 2.0, platform=WavePlatform(45.0, 0.5), camera=False)
    run = load_run(tmp_path / "run")
    cable = run.tension[run.tension["cable"] == 8]
    over = (cable["status"] & int(TensionStatus.HOST_OVERLOAD)) != 0
    assert (cable["tension_n"][over] > 60).all()
    assert (cable["tension_n"][~over] <= 60).all()
    events = run.events[(run.events["kind"] == "overload") & (run.events["cable"] == 8)]
    assert len(events) == 1
    assert "above 120 % of the cell's 50 N" in events["detail"].iloc[0]


def test_an_input_beyond_the_electronics_is_kept_raw_and_not_good(rig: Rig, tmp_path: Path) -> None:
    record_virtually(
        rig, tmp_path / "run", 1.0, platform=WavePlatform(slope_n_per_s=400.0), camera=False
    )
    run = load_run(tmp_path / "run")
    clipped = run.tension[run.tension["digits"] >= 6_400_000]
    assert len(clipped) > 100
    assert ((clipped["status"] & int(TensionStatus.ADC_OVERFLOW)) != 0).all()
    assert run.cable_tension(1)["tension_n"].max() < 125.0


def test_a_stuck_value_is_flagged(rig: Rig, tmp_path: Path) -> None:
    record_virtually(without_noise(rig), tmp_path / "run", 2.0, camera=False)
    tension = load_run(tmp_path / "run").tension
    stale = (tension["status"] & int(TensionStatus.STALE)) != 0
    assert stale[tension["t_s"] > 0.6].all()
    assert not stale[tension["t_s"] < 0.5].any()


def test_lost_nodes_are_tried_less_and_less_often() -> None:
    quarantine = Quarantine()
    assert [quarantine.failed(3, 10.0) for _ in range(3)] == [False, False, True]
    tries, now_s = [], 10.0
    while now_s < 45.0:
        if quarantine.due(3, now_s):
            tries.append(round(now_s, 2))
            quarantine.still_lost(3, now_s)
        now_s += 0.01
    assert np.diff([10.0, *tries]) == pytest.approx([1.0, 2.0, 5.0, 10.0, 10.0], abs=0.02)
    assert quarantine.back(3) == 10.0
    assert not quarantine.holds(3)


def test_an_answer_forgives_failures() -> None:
    quarantine = Quarantine()
    for _ in range(5):
        assert not quarantine.failed(1, 0.0)
        assert not quarantine.failed(1, 0.0)
        quarantine.answered(1)


def test_a_thread_that_stood_still_after_a_request_pulls_no_later_value(rig: Rig) -> None:
    rig = without_noise(rig)
    _, transport = simulated_line(rig, WavePlatform(slope_n_per_s=0.5))
    bus = Bus(transport, rig)
    stations = bus.start()
    write = transport.write
    origin_s = transport.clock.monotonic_s()
    for node in transport._far_end.nodes:
        node.signal.begin(origin_s)

    def write_and_stand_still(data: bytes) -> None:
        write(data)
        transport.clock.sleep_until(transport.clock.monotonic_s() + 5e-3)

    transport.write = write_and_stand_still
    bus.take(stations[0])
    transport.write = write
    errors_s = []
    for _ in range(200):
        value = bus.take(stations[0])
        true_s = (stations[0].scaling.tension_n(value.reading.digits) - 7.0) / 0.5
        errors_s.append(value.sampled_s - origin_s - true_s)
    assert abs(np.mean(errors_s[20:])) < 0.1 * stations[0].period_s
