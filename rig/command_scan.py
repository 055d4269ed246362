"""`rig scan`, and the options that it shares with `rig record`."""

from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8.terminal import note, say_json, say_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from cdpr8.rigfile import Rig
    from rig.scan import Found
    from rig.transport import Transport

SIMULATED = "simulated"

RigOption = Annotated[
    Path | None,
    typer.Option("--rig", help="Rig file.  [default: ./rig.toml, else the packaged CDPR-8]"),
]
SimulatedOption = Annotated[
    bool, typer.Option("--simulated", help="Use the simulated rig, whatever port is named.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def scan_command(
    rig: RigOption = None, simulated: SimulatedOption = False, as_json: JsonOption = False
) -> None:
    """List the amplifiers that answer, with their settings and what they measure.

    Example: rig scan --rig lab.toml
    """
    from cdpr8.clock import RealClock
    from cdpr8.errors import DeviceError
    from rig.machine import open_machine

    _, __, machine = load(rig, simulated)
    opened = open_machine(machine, machine.excitation, RealClock())
    lines = opened.ports or (opened.transport,)
    try:
        answers = [_on_line(machine, place, line) for place, line in enumerate(lines)]
    finally:
        opened.close()
    found = [
        (line.name, _cable(machine, place, node.address), node)
        for place, (line, nodes) in enumerate(zip(lines, answers, strict=True))
        for node in nodes
    ]
    if as_json:
        say_json([_for_machines(*those) for those in found])
    elif found:
        say_table(_table(found))
    for line, nodes in zip(lines, answers, strict=True):
        if found and not nodes:
            note(f"no amplifier answers on {line.name}")
    if not found:
        raise DeviceError(
            f"no amplifier answers at {opened.transport.line}",
            where=opened.transport.name,
            remedy="check power and wiring, and baud and parity under [bus] in the rig file",
        )


def _on_line(rig: "Rig", place: int, line: "Transport") -> "list[Found]":
    """Who is on a line; on a port of its own the one amplifier, first sought where it should be."""
    from rig.assignment import amplifiers
    from rig.scan import scan

    if not rig.bus.streaming:
        return list(scan(line))
    address = list(amplifiers(rig).values())[place].address
    return list(scan(line, range(address, address + 1))) or list(islice(scan(line), 1))


def _cable(rig: "Rig", place: int, address: int) -> int | None:
    """Whose amplifier it is: of one bus the address tells, else the port."""
    from rig.assignment import amplifiers

    known = amplifiers(rig)
    if rig.bus.streaming:
        return list(known)[place]
    return next((cable for cable, each in known.items() if each.address == address), None)


def _for_machines(port: str, cable: int | None, node: "Found") -> dict[str, Any]:
    return {
        "port": port,
        "address": node.address,
        "cable": cable,
        "identity": node.identity.text if node.identity else None,
        "dialect": node.dialect or None,
        "settings": node.settings,
        "own_scaling": node.own_scaling or None,
        "signal_mv_per_v": node.signal_mv_per_v,
        "trouble": node.trouble or None,
    }


def _table(found: "Sequence[tuple[str, int | None, Found]]") -> "Table":
    from rich.table import Table

    from rig.scan import SHOWN

    ports = sorted({port for port, _, __ in found})
    where = ports[0] if len(ports) == 1 else f"{len(ports)} ports"
    table = Table(title=f"{len(found)} amplifiers on {where}")
    first = ("address", "cable") if len(ports) == 1 else ("port", "address", "cable")
    for heading in (*first, "type", "dialect", "serial", "mV/V", *SHOWN, "own scaling", "trouble"):
        table.add_column(heading)
    for port, cable, node in found:
        who = node.identity
        table.add_row(
            *([port] if len(ports) > 1 else []),
            f"{node.address:02d}",
            "-" if cable is None else str(cable),
            who.type if who else "?",
            node.dialect,
            who.serial_number if who else "?",
            "" if node.signal_mv_per_v is None else f"{node.signal_mv_per_v:+.4f}",
            *(node.settings.get(name, "") for name in SHOWN),
            node.own_scaling,
            node.trouble,
        )
    return table


def load(path: Path | None, simulated: bool) -> "tuple[Path, str, Rig]":
    """The rig file's path and text, and the rig, simulated where that was asked for."""
    from cdpr8.rigfile import find_rig_file, load_rig

    path = find_rig_file(path)
    rig = load_rig(path)
    text = path.read_text(encoding="utf-8")
    if simulated:
        update: dict[str, Any] = {"bus": rig.bus.model_copy(update={"port": SIMULATED})}
        if rig.camera is not None:
            update["camera"] = rig.camera.model_copy(update={"source": SIMULATED})
        rig = rig.model_copy(update=update)
    return path, text, rig
