"""`rig scan`, and the options that it shares with `rig record`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8.terminal import say_json, say_table

if TYPE_CHECKING:
    from cdpr8.rigfile import Rig

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
    """List the amplifiers that answer on the bus, with their settings and what they measure.

    Example: rig scan --rig lab.toml
    """
    from rich.table import Table

    from cdpr8.clock import RealClock
    from cdpr8.errors import DeviceError
    from rig.assignment import amplifiers
    from rig.machine import open_machine
    from rig.scan import SHOWN, scan

    _, __, machine = load(rig, simulated)
    cables = {amplifier.address: cable for cable, amplifier in amplifiers(machine).items()}
    opened = open_machine(machine, machine.excitation, RealClock())
    try:
        found = list(scan(opened.transport))
    finally:
        opened.close()
    if as_json:
        say_json(
            [
                {
                    "address": node.address,
                    "cable": cables.get(node.address),
                    "identity": node.identity.text if node.identity else None,
                    "settings": node.settings,
                    "own_scaling": node.own_scaling or None,
                    "signal_mv_per_v": node.signal_mv_per_v,
                    "trouble": node.trouble or None,
                }
                for node in found
            ]
        )
    elif found:
        table = Table(title=f"{len(found)} amplifiers on {opened.transport.name}")
        for heading in (
            "address",
            "cable",
            "type",
            "serial",
            "mV/V",
            *SHOWN,
            "own scaling",
            "trouble",
        ):
            table.add_column(heading)
        for node in found:
            who = node.identity
            table.add_row(
                f"{node.address:02d}",
                str(cables.get(node.address, "-")),
                who.type if who else "?",
                who.serial_number if who else "?",
                "" if node.signal_mv_per_v is None else f"{node.signal_mv_per_v:+.4f}",
                *(node.settings.get(name, "") for name in SHOWN),
                node.own_scaling,
                node.trouble,
            )
        say_table(table)
    if not found:
        raise DeviceError(
            f"no amplifier answers at {opened.transport.line}",
            where=opened.transport.name,
            remedy="check power and wiring, and baud and parity under [bus] in the rig file",
        )


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
