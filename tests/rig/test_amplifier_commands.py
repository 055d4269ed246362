"""`rig set-address` and `rig set-baud` over a pseudo-terminal: asked, read back, saved last."""

import io
import os
import sys
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest
from rig_stand_ins import WavePlatform

from cdpr8.clock import RealClock
from cdpr8.rigfile import Rig, packaged_rig_path
from cdpr8.terminal import run_app
from rig.command import app
from rig.simulated.bus import SimulatedBus
from rig.simulated.pseudo_terminal import PseudoTerminal
from rig.simulated.rig import simulated_nodes
from rig.transport import LineSettings

pytestmark = pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")

SPEEDS = {termios.B115200: 115200, termios.B38400: 38400}


class BusOnPort:
    """Three amplifiers behind a pseudo-terminal that minds the speed its client sets."""

    def __init__(self, rig: Rig, folder: Path) -> None:
        clock = RealClock()
        nodes = simulated_nodes(rig, WavePlatform(), clock.monotonic_s(), 1)[:3]
        self.bus = SimulatedBus(nodes, LineSettings(115200, "even"))
        self.nodes = nodes
        hear = self.bus.hear

        def hear_at_the_clients_speed(data: bytes, start_s: float) -> None:
            speed = termios.tcgetattr(self.terminal._slave)[5]
            self.bus.line = LineSettings(SPEEDS[speed], "even")
            hear(data, start_s)

        self.bus.hear = hear_at_the_clients_speed
        self.terminal = PseudoTerminal(self.bus, clock, folder / "port")
        text = packaged_rig_path().read_text(encoding="utf-8")
        (folder / "rig.toml").write_text(
            text.replace('port = "simulated"', f'port = "{self.terminal.path}"')
        )

    def after_power_cycle(self, key: str) -> list[int]:
        for node in self.nodes:
            node.power_on(0.0)
        return [node.settings[key] for node in self.nodes]


@pytest.fixture
def on_port(rig: Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[BusOnPort]:
    from rig import scan

    monkeypatch.chdir(tmp_path)
    # Each address where nobody is takes 0.1 s: two of them are enough.
    monkeypatch.setattr(scan.scan, "__defaults__", (range(5),))
    port = BusOnPort(rig, tmp_path)
    yield port
    port.terminal.close()


def answer(monkeypatch: pytest.MonkeyPatch, words: str) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setattr(sys, "stdin", Terminal(words))


def test_an_amplifier_gets_another_address_and_keeps_it(
    on_port: BusOnPort, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answer(monkeypatch, "y\n")
    assert run_app(app, ["set-address", "--serial-number", "SIM0002", "--address", "9"]) == 0
    told = capsys.readouterr()
    assert "off and on undoes the change; after that it stays" in told.err
    assert "amplifier SIM0002 (FIT/5) has address 09, saved" in told.out
    assert "set `address = 9`" in told.out
    assert on_port.after_power_cycle("ADR") == [1, 9, 3]


def test_two_that_share_an_address_are_parted(
    on_port: BusOnPort, capsys: pytest.CaptureFixture[str]
) -> None:
    on_port.nodes[1].settings["ADR"] = on_port.nodes[1]._eeprom["ADR"] = 3
    arguments = ["set-address", "--serial-number", "SIM0002", "--address", "2", "--yes"]
    assert run_app(app, arguments) == 0
    assert on_port.after_power_cycle("ADR") == [1, 2, 3]


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--serial-number", "SIM0002", "--address", "3", "--yes"], 4, "is taken, by SIM0003"),
        (["--serial-number", "SIM0002", "--address", "2", "--yes"], 0, "has address 02 already"),
        (["--serial-number", "NOBODY", "--address", "9", "--yes"], 4, "'NOBODY' took address 09"),
        (["--serial-number", "SIM0002", "--address", "9"], 2, "add --yes where that is meant"),
        (["--serial-number", "SIM0002", "--address", "32", "--yes"], 2, "--address"),
    ],
)
def test_an_address_that_cannot_be_is_refused_and_nothing_changes(
    on_port: BusOnPort,
    arguments: list[str],
    code: int,
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert run_app(app, ["set-address", *arguments]) == code
    told = capsys.readouterr()
    assert message in told.err + told.out
    assert [node.settings["ADR"] for node in on_port.nodes] == [1, 2, 3]
    assert on_port.after_power_cycle("ADR") == [1, 2, 3]


def test_no_is_no(
    on_port: BusOnPort, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answer(monkeypatch, "\n")
    assert run_app(app, ["set-baud", "--baud", "38400"]) == 2
    assert "not agreed: nothing was changed" in capsys.readouterr().err
    assert [node.settings["BAUD"] for node in on_port.nodes] == [115200] * 3


def test_a_bus_changes_its_speed_and_keeps_it(
    on_port: BusOnPort, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app(app, ["set-baud", "--baud", "38400", "--yes"]) == 0
    told = capsys.readouterr()
    assert "3 amplifiers on" in told.err
    assert "from 115200 baud 8E1 to 38400 baud" in told.err
    assert "3 amplifiers answer at 38400 baud, parity even, saved" in told.out
    assert on_port.after_power_cycle("BAUD") == [38400] * 3


def test_a_speed_that_one_amplifier_does_not_reach_is_saved_by_none(
    on_port: BusOnPort, capsys: pytest.CaptureFixture[str]
) -> None:
    node = on_port.nodes[1]
    node._bdr = lambda asked, parameters, now_s: type(node)._bdr(
        node, asked, parameters if asked else "115200,1", now_s
    )
    assert run_app(app, ["set-baud", "--baud", "38400", "--yes"]) == 4
    told = capsys.readouterr().err
    assert "amplifier 02 is not at 38400 baud 8E1" in told
    assert "switch all amplifiers off and on: nothing was saved" in told
    assert on_port.after_power_cycle("BAUD") == [115200] * 3


def test_a_speed_no_amplifier_has_is_refused(
    on_port: BusOnPort, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app(app, ["set-baud", "--baud", "12345", "--yes"]) == 4
    told = capsys.readouterr().err
    assert "amplifier 01 (FIT class) has no 12345 baud" in told
    assert "allowed: 1200, 2400" in told
