"""Changing what a node keeps: its address and its line (protocol note, sections 3 and 10).

Nothing here is done by a recording. What is changed is read back before it is saved, so that a
power cycle undoes what went wrong.
"""

from collections.abc import Callable

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue
from rig.amplifier.node import NodeClient
from rig.amplifier.profile import Identity
from rig.transport import Transport

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
    identity = node.identify()
    if identity.serial_number != serial_number:
        raise DeviceError(
            f"address {address:02d} answers with serial number {identity.serial_number!r}",
            allowed=repr(serial_number),
            where=dialogue.transport.name,
            remedy="choose a free address; nothing was saved, so a power cycle undoes it",
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
    for node in nodes:
        node.identify()
        if node.read("BDR") != f"{baud},{parity}":
            raise DeviceError(
                f"amplifier {node.address:02d} is not at {baud} baud",
                where=transport.name,
                remedy="switch the amplifiers off and on: nothing was saved",
            )
    for node in nodes:
        node.identify()
        node.write("TDD", SAVE)
    return transport
