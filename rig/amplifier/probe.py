"""How a node's values really look on the line: asked of the node, never assumed from COF.

Manuals and drivers disagree on which formats carry CR LF (section 5, "ambiguities").
"""

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import SETTLE_S, TRIES, Dialogue
from rig.amplifier.frame import BadFrameError, FrameFormat

VALUES = 16
"""How many values must all fit one format."""

LONGEST_FRAME = 8


def probe_format(dialogue: Dialogue, address: int, cof: int, csm: int) -> FrameFormat:
    """The one format that fits the values a measuring node gives in bus mode.

    Parameters
    ----------
    dialogue
        Of the bus, after ``S98;MSV?0;``.
    address
        Of the node.
    cof, csm
        As read back.

    Raises
    ------
    DeviceError
        No format of this COF fits all of `VALUES` answers, or more than one does, in three tries:
        a computer that stood still for a moment is not an amplifier at fault.
    """
    for _ in range(TRIES):
        fitting, raws, late = _probe(dialogue, address, cof, csm)
        if len(fitting) == 1 and not late:
            return fitting[0]
    shown = ", ".join(raw.hex(" ").upper() or "nothing" for raw in raws[:3])
    raise DeviceError(
        f"amplifier {address:02d} gives values that fit {len(fitting)} formats of COF {cof}: "
        f"{shown}" + (f"; then {late.hex(' ').upper()}" if late else ""),
        allowed="values of 2 or 4 bytes, all with CR LF or all without",
        where=dialogue.transport.name,
        remedy="check that [bus] output_format is a bus-mode code such as 24, "
        "and the wiring if values are cut",
    )


def _probe(
    dialogue: Dialogue, address: int, cof: int, csm: int
) -> tuple[list[FrameFormat], list[bytes], bytes]:
    """Formats that fit all values, the values, and what came after them."""
    dialogue.settle()
    candidates = [FrameFormat.of_output_format(cof, csm, crlf) for crlf in (True, False)]
    # The first answer is taken to its end in silence, which tells the length; the others quickly.
    raws = [_value(dialogue, address, LONGEST_FRAME, SETTLE_S)]
    if not raws[0]:
        return [], raws, dialogue.settle()
    raws += [_value(dialogue, address, len(raws[0]), 0.0) for _ in range(VALUES - 1)]
    late = dialogue.settle()
    fitting = [format_ for format_ in candidates if all(_fits(format_, raw) for raw in raws)]
    return fitting, raws, late


def _value(dialogue: Dialogue, address: int, count: int, quiet_s: float) -> bytes:
    transport = dialogue.transport
    request = message.select(address)
    line_s = (len(request) + count) * transport.line.char_s
    dialogue.tell(request)
    received = transport.read(count, transport.clock.monotonic_s() + line_s + SETTLE_S)
    return received.data + (transport.drain(quiet_s) if quiet_s else b"")


def _fits(format_: FrameFormat, raw: bytes) -> bool:
    try:
        format_.decode(raw)
    except BadFrameError:
        return False
    return True
