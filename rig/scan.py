"""Who is on the bus: every address asked once (protocol note, section 3)."""

from collections.abc import Iterator
from dataclasses import dataclass

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import Dialogue, NoAnswerError
from rig.amplifier.node import NodeClient
from rig.amplifier.profile import Identity
from rig.bus import ALL_STOP, STOP_WAIT_S
from rig.transport import Transport

SHOWN = ("BDR", "COF", "ICR", "ASF", "FMD", "TAS", "NOV", "CSM")
"""Settings that are read."""


@dataclass(frozen=True)
class Found:
    """What one address answered.

    Attributes
    ----------
    address
        0..31.
    identity
        None where the answer was garbled.
    settings
        Command -> answer.
    trouble
        What was wrong with the answer; empty where nothing was.
    """

    address: int
    identity: Identity | None
    settings: dict[str, str]
    trouble: str = ""


def scan(transport: Transport, addresses: range = message.ADDRESSES) -> Iterator[Found]:
    """Ask every address; yields those where something answers, as they are found.

    Parameters
    ----------
    transport
        The line; streaming is stopped first.
    addresses
        Which to ask.
    """
    dialogue = Dialogue(transport)
    dialogue.tell(ALL_STOP)
    transport.drain(STOP_WAIT_S)
    for address in addresses:
        node = NodeClient(dialogue, address)
        try:
            identity = node.identify(tries=1)
            yield Found(address, identity, {name: node.read(name) for name in SHOWN})
        except NoAnswerError as silence:
            if silence.came:
                yield Found(address, None, {}, f"garbled: {silence.came!r}")
            dialogue.settle()
        except DeviceError as fault:
            dialogue.settle()
            yield Found(address, None, {}, fault.what)
