"""Changing what a node keeps: its address and its line (protocol note, sections 3 and 10).

Nothing here is done by a recording. What is changed is read back before it is saved, so that a
power cycle undoes what went wrong.
"""

from collections.abc import Callable, Sequence

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue, NoAnswerError
from rig.amplifier.node import NodeClient
from rig.amplifier.profile import Identity
from rig.transport import Transport

UNDONE = "nothing was saved, so a power cycle undoes it"

SAVE = 1
"""TDD1: save the settings in the node's EEPROM."""


def readdress(dialogue: Dialogue, serial_number: str, address: int) -> Identity:
    """Give the node with a serial number an address, verify, and save it.

    Parameters
    ----------
    dialogue
        Of the bus, silent.
    serial_number
        Of `IDN?`: the only way to tell apart nodes that share an address.
    address
        0 to 31, free.

    Raises
    ------
    DeviceError
        The address is none or is taken, or the node does not answer at it.
    """
    if address not in message.ADDRESSES:
        raise DeviceError(f"{address} is no bus address", allowed="0 to 31")
    request = message.command("ADR", address, serial_number).replace(
        b"ADR%d," % address, b"ADR%02d," % address
    )
    dialogue.tell(message.END, message.select(message.BROADCAST), request)
    dialogue.transport.drain(0.1)
    node = NodeClient(dialogue, address)
    where = dialogue.transport.name
    try:
        identity = node.identify()
    except NoAnswerError as fault:
        if fault.came:
            raise DeviceError(
                f"address {address:02d} answers garbled: another amplifier has it too",
                where=where,
                remedy=f"choose a free address; {UNDONE}",
            ) from None
        raise DeviceError(
            f"no amplifier with the serial number {serial_number!r} took address {address:02d}",
            where=where,
            remedy="check the serial number on its label; `rig scan` lists who answers",
        ) from None
    if identity.serial_number != serial_number:
        raise DeviceError(
            f"address {address:02d} answers with serial number {identity.serial_number!r}",
            allowed=repr(serial_number),
            where=where,
            remedy=f"choose a free address; {UNDONE}",
        )
    node.write("TDD", SAVE)
    return identity


def change_baud(
    dialogue: Dialogue,
    addresses: tuple[int, ...],
    baud: int,
    parity: int,
    reopen: Callable[[], Transport],
) -> Transport:
    """Take a whole bus to another speed; saved only once every node answers at it.

    Parameters
    ----------
    dialogue
        At the present speed, silent.
    addresses
        Of all nodes on the bus.
    baud, parity
        The new line; parity 0 none, 1 even.
    reopen
        Opens the host's port at the new speed.

    Returns
    -------
    Transport
        At the new speed.

    Raises
    ------
    DeviceError
        A node is not there at the new speed: a power cycle brings all of them back to the old.
    """
    for address in addresses:
        # Answered at the new speed, which is not understood here: told, not asked.
        change = message.command("BDR", baud, parity)
        dialogue.tell(message.END, message.select(address), change)
        dialogue.transport.drain(0.1)
    transport = reopen()
    there = Dialogue(transport)
    there.settle()
    nodes = [NodeClient(there, address) for address in addresses]
    try:
        for node in nodes:
            if not _is_at(node, baud, parity):
                raise DeviceError(
                    f"amplifier {node.address:02d} is not at {transport.line}",
                    where=transport.name,
                    remedy=f"switch all amplifiers off and on: {UNDONE}",
                )
        _save(nodes, transport)
    except DeviceError:
        transport.close()
        raise
    return transport


def _is_at(node: NodeClient, baud: int, parity: int) -> bool:
    try:
        node.identify()
        return node.read("BDR") == f"{baud},{parity}"
    except NoAnswerError:
        return False


def _save(nodes: Sequence[NodeClient], transport: Transport) -> None:
    saved: list[str] = []
    for node in nodes:
        try:
            node.identify()
            node.write("TDD", SAVE)
        except DeviceError as fault:
            raise DeviceError(
                f"amplifier {node.address:02d} did not save its new speed ({fault.what}); "
                f"saved by: {', '.join(saved) or 'none'}",
                where=transport.name,
                remedy="leave the amplifiers on, set [bus] baud and parity in the rig file to the "
                "new speed, and give the same command again: off and on would divide the bus",
            ) from None
        saved.append(f"{node.address:02d}")
