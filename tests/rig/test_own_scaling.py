"""What amplifiers do to their digits themselves: read, told, and never scaled wrong in silence."""

import json
from pathlib import Path

import pytest
from rig_stand_ins import (
    WavePlatform,
    motion,
    rig_text,
    simulated_line,
    virtual_clock,
    with_bus,
    without_noise,
)

from cdpr8.errors import DeviceError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import load_run
from cdpr8.terminal import run_app
from rig.amplifier import message
from rig.amplifier.own_scaling import concerns, deviations
from rig.bus import Bus
from rig.command import app
from rig.finding import Verdict
from rig.recorder import record
from rig.scan import scan
from rig.simulated import rig as simulated_rig
from rig.simulated.conversion import FACTORY_SPAN, converted
from rig.simulated.node import SimulatedNode
from rig.simulated.registers import factory_settings
from rig.simulated.rig import assemble
from rig.verify import verify

OF_NODE_3 = ';S03;SPW"AED";'


@pytest.mark.parametrize(
    ("setting", "value", "told", "allowed", "restore"),
    [
        ("LDW", 1234, "LDW is 00001234: a dead weight", "LDW 0", "LDW0;LWT1000000;TDD1;"),
        ("LWT", 500000, "LWT is 00500000: the span", "LWT 1000000", "LDW0;LWT1000000;TDD1;"),
        (
            "LIC2",
            -300,
            "LIC is 00000000,01000000,-0000300,00000000: values are linearised",
            "LIC 0,1000000,0,0",
            "LIC0,0;LIC1,1000000;LIC2,0;LIC3,0;TDD1;",
        ),
        ("ZSE", 3, "ZSE is 3: a zero is taken at power-on", "ZSE 0", "ZSE0;TDD1;"),
        ("TRC0", 1, "TRC is 1,0,00000000,00,00: only triggered", "TRC 0", "TRC0,0,0,0,0;TDD1;"),
    ],
)
@pytest.mark.parametrize("streaming", [False, True])
def test_a_scaling_of_its_own_is_refused_with_its_values_and_the_way_back(
    rig: Rig, setting: str, value: int, told: str, allowed: str, restore: str, streaming: bool
) -> None:
    rig = with_bus(rig, streaming=streaming)
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    port = machine.ports[2] if streaming else machine.transport
    node = port._far_end.nodes[0 if streaming else 2]
    node.settings[setting] = value
    folder = Path("never")
    with pytest.raises(DeviceError) as fault:
        record(rig, rig_text(), folder, excitation=motion(1.0), clock=clock, machine=machine)
    assert not folder.exists()
    assert fault.value.exit_code == 4
    assert f"its digits would be scaled wrong: {told}" in fault.value.what
    assert fault.value.allowed == allowed
    assert fault.value.where.startswith("amplifier 03 on ")
    assert f"`{OF_NODE_3}{restore}`" in fault.value.remedy
    assert ("clears its tare" in fault.value.remedy) == (setting in ("LDW", "LWT"))
    assert ("off and on" in fault.value.remedy) == (setting == "ZSE")
    assert node.settings[setting] == value  # it is somebody's


def test_the_way_back_leads_back(rig: Rig) -> None:
    line, transport = simulated_line(rig)
    node = line.nodes[2]
    node.settings.update({"LDW": 5, "LWT": 7, "LIC0": 1, "ZSE": 2, "TRC0": 1, "TRC2": 44, "TAV": 9})
    with pytest.raises(DeviceError) as fault:
        Bus(transport, rig).start()
    commands = fault.value.remedy.split("`")[1]
    transport.write(commands.encode("ascii"))
    assert transport.drain(0.1) == message.ACCEPTED * (commands.count(";") - 2)
    node.power_on(0.0)
    own = {"LDW": 0, "LWT": 1_000_000, "LIC0": 0, "ZSE": 0, "TRC0": 0, "TRC2": 44, "TAV": 0}
    assert {name: node.settings[name] for name in own} == own
    assert len(Bus(transport, rig).start()) == 8


def test_the_curve_is_read_while_the_node_is_locked(rig: Rig) -> None:
    # A question that loses its ? would measure the curve anew: the lock is what keeps it.
    line, transport = simulated_line(rig)
    Bus(transport, rig).start()
    assert not any(node._unlocked for node in line.nodes)
    transport.write(b";S98;STP;S01;LDW;")
    assert transport.drain(0.1) == message.REFUSED
    transport.write(b'SPW"AED";LDW;')
    transport.drain(5.0)
    assert line.nodes[0].settings["LDW"] == pytest.approx(1e6 * (7.0 / 50.0) / 2.0, abs=200)


def test_the_tare_is_never_changed(rig: Rig) -> None:
    line, transport = simulated_line(without_noise(rig))
    line.nodes[3].settings.update({"TAV": 250_000, "TAS": 0})
    bus = Bus(transport, rig)
    station = bus.start()[3]
    assert line.nodes[3].settings["TAV"] == 250_000
    assert station.state.found["TAV"] == "00250000"
    assert station.scaling.tension_n(bus.take(station).reading.digits) == pytest.approx(13.0)
    (words,) = concerns(station.state.settings, station.state.found)
    assert words.startswith("is tared (TAV 00250000): the tare is left alone")


def test_what_a_user_must_know_is_told_kept_and_verified(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    for node in machine.transport._far_end.nodes:
        node.settings.update({"ZTR": 1, "NOV": 5000})
    machine.transport._far_end.nodes[4].settings["RSN"] = 10
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
    scales, tracks, steps = told
    assert (
        scales == "every amplifier scales by itself (NOV 0005000): off while recording, not "
        "for good"
    )
    assert tracks.startswith("every amplifier tracks its zero (ZTR 1)")
    assert steps == "the amplifier of cable 5 gives digits in steps of 10 (RSN)"
    run = load_run(tmp_path / "run")
    node = run.start.nodes[4]
    assert node.found | {"NOV": "0005000", "ZTR": "1", "RSN": "010"} == node.found
    assert node.settings | {"NOV": "0000000", "ZTR": "0", "LWT": "01000000"} == node.settings
    found = {each.what: each for each in verify(run)}
    assert found["amplifiers"].verdict is Verdict.WARN
    assert all(words in found["amplifiers"].words for words in told)


def test_an_amplifier_that_does_not_tell_is_told(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    refuse = lambda node, asked, parameters, now_s: node._refuse(32)  # noqa: E731
    monkeypatch.setattr(SimulatedNode, "_lic", refuse)
    _, transport = simulated_line(rig)
    station = Bus(transport, rig).start()[0]
    assert station.state.settings["LIC"] == "?"
    (words,) = concerns(station.state.settings, station.state.found)
    assert words.startswith("does not tell its LIC")
    assert deviations(station.state.settings) == {}


def test_a_scan_shows_it_and_hides_no_signal_behind_it(
    rig: Rig, here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    line, transport = simulated_line(without_noise(rig))
    line.nodes[1].settings["LWT"] = 500_000
    found = list(scan(transport, range(1, 4)))
    assert [each.own_scaling for each in found] == [
        "factory",
        "LWT is 00500000: the span is the user's",
        "factory",
    ]
    assert found[1].signal_mv_per_v is None
    assert found[0].settings | {"LIC": "00000000,01000000,00000000,00000000"} == found[0].settings
    make = simulated_rig.simulated_nodes

    def with_zero_at_power_on(*arguments: object) -> tuple[SimulatedNode, ...]:
        nodes = make(*arguments)
        nodes[0].settings["ZSE"] = 1
        return nodes

    monkeypatch.setattr(simulated_rig, "simulated_nodes", with_zero_at_power_on)
    from rig import scan as scan_module

    monkeypatch.setattr(scan_module.scan, "__defaults__", (range(3),))
    assert run_app(app, ["scan", "--json"]) == 0
    first, second = json.loads(capsys.readouterr().out)
    assert first["own_scaling"] == "ZSE is 1: a zero is taken at power-on"
    assert (first["signal_mv_per_v"], second["own_scaling"]) == (None, "factory")


def test_the_simulated_node_scales_as_it_is_set(rig: Rig) -> None:
    factory = factory_settings()
    half = FACTORY_SPAN // 2
    assert converted(half, factory) == half
    assert converted(half, factory | {"LDW": 250_000, "LWT": 750_000}) == half
    assert converted(half, factory | {"LWT": 500_000}) == FACTORY_SPAN
    assert converted(half, factory | {"LIC2": 100_000}) == half + FACTORY_SPAN // 40
    assert converted(half, factory | {"NOV": 5003, "RSN": 5}) == 2500
    line, _ = simulated_line(without_noise(rig))
    node = line.nodes[0]
    before = node.frame(5000)
    node._eeprom["ZSE"] = 2
    node.power_on(0.0)  # 7 of 50 N are beyond 5 % of its range
    assert node.frame(5000) == before
    node._eeprom["ZSE"] = 4
    node.power_on(0.0)
    assert node.frame(5000) != before
    assert abs(int.from_bytes(node._zero.to_bytes(4, "big"), "big") - 358_400) < 100
