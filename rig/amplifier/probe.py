"""How a node's values really look on the line: asked of the node, never assumed from COF.

Manuals and drivers disagree on which formats carry CR LF (section 5, "ambiguities").
"""

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import LATE_S, SETTLE_S, TRIES, Dialogue
from rig.amplifier.frame import BadFrameError, FrameFormat

VALUES = 16
"""How many values must all fit one format."""

LONGEST_PROBE_S = 1.0
"""Triggered values come at the output rate: of a slow one fewer are asked for, 2 at least."""

LONGEST_FRAME = 8

MISSED = 4
"""How many values may be late in one try: that tells of a busy computer, nothing of the format."""


def probe_format(
    dialogue: Dialogue, address: int, cof: int, csm: int, wait_s: float = 0.0
) -> FrameFormat:
    """The one format that fits the values a measuring node gives when it is selected.

    Parameters
    ----------
    dialogue
        Of the bus, after ``MSV?0;``, or with nothing measuring where values are triggered.
    address
        Of the node.
    cof, csm
        As read back.
    wait_s
        Where each value is triggered: how long after that it is ready.

    Raises
    ------
    DeviceError
        No format of this COF fits all of `VALUES` answers, or more than one does, in three tries.
        An answer that is late is waited for, thrown away and asked for again: a computer that
        stood still for a moment is not an amplifier at fault.
    """
    for _ in range(TRIES):
        fitting, raws, late = _probe(dialogue, address, cof, csm, wait_s)
        if len(fitting) == 1 and not late:
            return fitting[0]
    shown = ", ".join(raw.hex(" ").upper() or "nothing" for raw in raws[:3])
    raise DeviceError(
        f"amplifier {address:02d} gives values that fit {len(fitting)} formats of COF {cof}: "
        f"{shown}" + (f"; then {late.hex(' ').upper()}" if late else ""),
        allowed="values of 2 or 4 bytes, all with CR LF or all without",
        where=dialogue.transport.name,
        remedy="check that [bus] output_format is a code of binary values such as 24, "
        "and the wiring if values are cut"
        + ('; or set sweep = "polled": it may obey the trigger otherwise' if wait_s else ""),
    )


def _probe(
    dialogue: Dialogue, address: int, cof: int, csm: int, wait_s: float
) -> tuple[list[FrameFormat], list[bytes], bytes]:
    """Formats that fit all values, the values, and what came after them."""
    dialogue.settle()
    candidates = [FrameFormat.of_output_format(cof, csm, crlf) for crlf in (True, False)]
    # The first answer is taken to its end in silence, which tells the length; the others quickly.
    missed = 0
    raws = [_value(dialogue, address, LONGEST_FRAME, SETTLE_S, wait_s)]
    while not raws[0]:
        late = dialogue.hush(LATE_S)
        if missed == MISSED:
            return [], raws, late
        missed += 1
        raws = [_value(dialogue, address, LONGEST_FRAME, SETTLE_S, wait_s)]
    more = VALUES - 1 if not wait_s else max(1, min(VALUES - 1, int(LONGEST_PROBE_S / wait_s)))
    while len(raws) <= more:
        raw = _value(dialogue, address, len(raws[0]), 0.0, wait_s)
        if len(raw) < len(raws[0]) and missed < MISSED:
            missed += 1
            dialogue.hush(LATE_S)
            continue
        raws.append(raw)
    late = dialogue.settle()
    fitting = [format_ for format_ in candidates if all(_fits(format_, raw) for raw in raws)]
    return fitting, raws, late


def _value(dialogue: Dialogue, address: int, count: int, quiet_s: float, wait_s: float) -> bytes:
    transport = dialogue.transport
    if wait_s:
        trigger_s = len(message.TRIGGER) * transport.line.char_s
        dialogue.tell(message.TRIGGER)
        transport.clock.sleep_until(transport.clock.monotonic_s() + trigger_s + wait_s)
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
