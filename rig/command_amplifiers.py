"""`rig set-address` and `rig set-baud`: what an amplifier keeps, changed with consent."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cdpr8.terminal import note, say

if TYPE_CHECKING:
    from cdpr8.rigfile import Rig
    from rig.scan import Found
    from rig.transport import Transport

RigOption = Annotated[
    Path | None,
    typer.Option("--rig", help="Rig file.  [default: ./rig.toml, else the packaged CDPR-8]"),
]
PortOption = Annotated[
    str | None, typer.Option("--port", help="Serial port.  [default: the rig file's [bus] port]")
]
YesOption = Annotated[bool, typer.Option("--yes", help="Do not ask.")]


def set_address_command(
    serial_number: Annotated[
        str, typer.Option("--serial-number", help="On the amplifier's label, or from `rig scan`.")
    ],
    address: Annotated[int, typer.Option(min=0, max=31, help="The new bus address, a free one.")],
    rig: RigOption = None,
    port: PortOption = None,
    yes: YesOption = False,
) -> None:
    """Give one amplifier another bus address, told apart by its serial number.

    It is read back at the new address before it is saved. This also parts two amplifiers that
    share an address, as new ones do (31).

    Example: rig set-address --serial-number 1234567 --address 3
    """
    from cdpr8.errors import DeviceError
    from rig.amplifier.dialogue import Dialogue
    from rig.amplifier.maintenance import readdress

    with _line(rig, port) as (line, _):
        found = _found(line)
        for node in found:
            if node.address != address:
                continue
            taken_by = node.identity.serial_number if node.identity else "more than one amplifier"
            if taken_by == serial_number:
                say(f"amplifier {serial_number} has address {address:02d} already")
                return
            raise DeviceError(
                f"address {address:02d} is taken, by {taken_by}",
                allowed=f"a free address: {_free(found)}",
                where=line.name,
            )
        note(
            f"amplifier {serial_number} on {line.name} will get address {address:02d}. Until it "
            "answers there and is saved, off and on undoes the change; after that it stays."
        )
        _ask_consent(yes)
        identity = readdress(Dialogue(line), serial_number, address)
        say(
            f"amplifier {identity.serial_number} ({identity.type}) has address {address:02d}, saved"
        )
        say(f"next:   set `address = {address}` for its cable in the rig file, then `rig scan`")


def set_baud_command(
    baud: Annotated[int, typer.Option(help="The new speed of the whole bus.")],
    parity: Annotated[
        Literal["even", "none"] | None, typer.Option(help="[default: the rig file's]")
    ] = None,
    rig: RigOption = None,
    port: PortOption = None,
    yes: YesOption = False,
) -> None:
    """Take all amplifiers of a bus to another line speed.

    Every one of them must answer at the new speed before any saves it.

    Example: rig set-baud --baud 38400
    """
    from cdpr8.errors import DeviceError
    from rig.amplifier.dialogue import Dialogue
    from rig.amplifier.maintenance import change_baud
    from rig.amplifier.profile import profile_of
    from rig.machine import open_line

    with _line(rig, port) as (line, machine):
        nodes = _found(line)
        if not nodes:
            raise DeviceError(
                f"no amplifier answers at {line.line}",
                where=line.name,
                remedy="check power and wiring, and baud and parity under [bus] in the rig file",
            )
        for node in nodes:
            if node.identity is None:
                raise DeviceError(
                    f"address {node.address:02d}: {node.trouble}",
                    where=line.name,
                    remedy="two amplifiers may share it: `rig set-address` first",
                )
            profile = profile_of(node.identity)
            if baud not in profile.bauds:
                raise DeviceError(
                    f"amplifier {node.address:02d} ({profile.name}) has no {baud} baud",
                    allowed=", ".join(str(each) for each in profile.bauds),
                    where=line.name,
                )
        parity = parity or machine.bus.parity
        there = machine.model_copy(
            update={"bus": machine.bus.model_copy(update={"baud": baud, "parity": parity})}
        )
        addresses = tuple(node.address for node in nodes)
        note(
            f"{len(nodes)} amplifiers on {line.name} ({', '.join(f'{a:02d}' for a in addresses)}) "
            f"will go from {line.line} to {baud} baud, parity {parity}. Until all of them answer "
            "there and are saved, off and on undoes the change; after that it stays. An amplifier "
            "that is not switched on now is left behind."
        )
        _ask_consent(yes)

        def reopen() -> "Transport":
            line.close()
            return open_line(there)

        change_baud(Dialogue(line), addresses, baud, 1 if parity == "even" else 0, reopen).close()
        say(f"{len(nodes)} amplifiers answer at {baud} baud, parity {parity}, saved")
        say(f'next:   set `baud = {baud}` and `parity = "{parity}"` under [bus] in the rig file')


@contextmanager
def _line(path: Path | None, port: str | None) -> "Iterator[tuple[Transport, Rig]]":
    """The silent line of a rig file, and its rig; the simulated one forgets what it was told."""
    from cdpr8.errors import UsageError
    from cdpr8.rigfile import find_rig_file, load_rig
    from rig.machine import open_line

    rig = load_rig(find_rig_file(path))
    if rig.bus.streaming and port is None:
        raise UsageError(
            "[bus] streaming = true: each amplifier has a port of its own",
            allowed="--port with the port of the one amplifier",
        )
    if port is not None:
        bus = rig.bus.model_copy(update={"port": port, "streaming": False})
        rig = rig.model_copy(update={"bus": bus})
    if rig.bus.port == "simulated":
        note("the simulated rig, no hardware: it forgets the change at once")
    line = open_line(rig)
    try:
        yield line, rig
    finally:
        line.close()


def _found(line: "Transport") -> "Sequence[Found]":
    from rig.scan import scan

    note(f"looking who is on {line.name} at {line.line} ...")
    return list(scan(line))


def _free(found: "Sequence[Found]") -> str:
    taken = {node.address for node in found}
    return ", ".join(str(address) for address in range(32) if address not in taken)


def _ask_consent(yes: bool) -> None:
    from cdpr8.errors import UsageError

    if yes:
        return
    if not sys.stdin.isatty():
        raise UsageError(
            "this changes amplifiers for good, and nobody can be asked here",
            remedy="add --yes where that is meant",
        )
    note("go on? [y/N]")
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise UsageError("not agreed: nothing was changed", allowed="y or yes")
