"""Who is on the bus and what each measures: every address asked (protocol note, section 3)."""

from collections.abc import Iterator
from dataclasses import dataclass

from cdpr8.errors import DeviceError
from rig.amplifier import message, own_scaling
from rig.amplifier.dialogue import Dialogue, NoAnswerError
from rig.amplifier.node import NodeClient
from rig.amplifier.profile import Identity, find_profile
from rig.amplifier.text_frame import DIGITS_PER_MV_PER_V
from rig.bus import STOP_WAIT_S
from rig.transport import Transport

SHOWN = ("BDR", "COF", "ICR", "ASF", "FMD", "TAS", "TAV", "NOV", "ZSE", "ZTR", "CSM")
"""Settings that are shown, each in a column."""

READ = tuple(dict.fromkeys((*SHOWN, *own_scaling.JUDGED, *own_scaling.AS_FOUND)))
"""Settings that are read; the others are told where they are not the factory's."""

ASKED = 2
"""So often an address is asked before it counts as empty."""


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
    signal_mv_per_v
        What the cell gives now; None where a scaling inside the amplifier hides it.
    """

    address: int
    identity: Identity | None
    settings: dict[str, str]
    trouble: str = ""
    signal_mv_per_v: float | None = None

    @property
    def dialect(self) -> str:
        """What the toolkit takes it for; empty where it did not tell who it is."""
        if self.identity is None:
            return ""
        profile = find_profile(self.identity)
        return "unknown: text, polled" if profile is None else profile.name

    @property
    def own_scaling(self) -> str:
        """What the amplifier does to its digits, in words; empty before its settings were read."""
        if not set(self.settings) >= set(READ):
            return ""
        told = own_scaling.concerns(self.settings, self.settings)
        words = [*own_scaling.deviations(self.settings).values(), *told]
        return "; ".join(words) or "factory"


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
    dialogue.tell(message.ALL_STOP)
    transport.drain(STOP_WAIT_S)
    for address in addresses:
        node = NodeClient(dialogue, address)
        identity, settings = None, {}
        try:
            identity = _identify(node, dialogue)
            for name in READ:
                settings[name] = node.read(name)
            signal_mv_per_v = _signal(node, settings)
            yield Found(address, identity, settings, signal_mv_per_v=signal_mv_per_v)
        except NoAnswerError as silence:
            dialogue.settle()
            if identity is not None:
                yield Found(address, identity, settings, silence.what)
            elif silence.came:
                yield Found(address, None, {}, f"garbled: {silence.came!r}")
        except DeviceError as fault:
            dialogue.settle()
            yield Found(address, identity, settings, fault.what)


def _identify(node: NodeClient, dialogue: Dialogue) -> Identity:
    """Once more where something else came, such as a value that waited to be fetched."""
    try:
        return node.identify(tries=ASKED)
    except NoAnswerError as fault:
        if not fault.came:
            raise
        dialogue.settle()
        return node.identify(tries=1)


def _signal(node: NodeClient, settings: dict[str, str]) -> float | None:
    """What the cell gives, from the factory curve."""
    if own_scaling.numbers(settings["NOV"]) != (0,) or own_scaling.deviations(settings):
        return None
    return node.measure() / DIGITS_PER_MV_PER_V
