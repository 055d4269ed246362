"""When an amplifier of unknown type has its values ready: measured before a run, never assumed.

``MSV?0;`` has it send values one after the other: they come an output period apart, or as fast as
the line carries them, which then is no shorter than the period. ``MSV?;``, asked at all phases of
that period, tells more, whatever the line's speed: one that answers with its next value has it wait
between nothing and a period. Answers that come late for the computer's sake are outvoted: medians
are taken, and what did not come is asked again.
"""

from dataclasses import dataclass

import numpy as np

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import LATE_S, MARGIN_S, SETTLE_S, TRIES, Dialogue
from rig.amplifier.frame import BadFrameError
from rig.amplifier.node import SLOWEST_VALUE_S
from rig.amplifier.text_frame import MOST_DIGITS, TextFormat
from rig.transport import Received

FORMAT = TextFormat(clamp=MOST_DIGITS)
"""COF 3: ten characters, nothing but the value."""

VALUES = 24
"""Values that are sent, and values that are asked for."""

LEAST_VALUES = 4

LONGEST_S = 2.0
"""Of slow ones fewer are taken, `LEAST_VALUES` at least, once this time has gone by."""

PACED_BY_LINE = 1.2
"""Values that follow each other within this many times their length say nothing but the line's
speed.
"""

RESOLVED_S = 0.002
"""Adapters and computers let answers vary by less than this most of the time."""

GOLDEN = 0.618034
"""The fractions of its multiples lie evenly between 0 and 1."""

SPREAD_S = 0.05
"""Over so long, and a period at least, it is asked: the phases of a shorter period are met evenly
then, whatever its length.
"""


@dataclass(frozen=True)
class Pace:
    """How a node of unknown type gives its values.

    Attributes
    ----------
    request
        What asks it for one.
    period_s
        Between two of its values, measured; where the line was too slow to tell, at most so long.
    next_value
        Whether it answers with its next value, when that is ready: it is new then. Otherwise its
        answers are taken to begin with one that is between 0 and one period old.
    waits_s
        By how much answers vary: a period where they wait for the next value.
    least_s
        What an answer takes at least, beyond its bytes on the line.
    """

    request: bytes
    period_s: float
    next_value: bool
    waits_s: float
    least_s: float


def measure_pace(dialogue: Dialogue, address: int, nobody: int) -> Pace:
    """Measure a node that gives text, nothing else being under way.

    Parameters
    ----------
    dialogue
        Of the bus.
    address
        Of the node.
    nobody
        An address that no node has (`message.next_value`).

    Raises
    ------
    DeviceError
        It does not send values, or not as text.
    """
    request = message.next_value(address, nobody)
    apart_s = _apart_s(dialogue, address)
    waits_s = _waits_s(dialogue, request, apart_s)
    # Evenly spread, they lie between the least and twice as far from it as the median.
    evenly = len(waits_s) / (len(waits_s) - 1)
    varied_s = 2.0 * evenly * float(np.median(waits_s) - min(waits_s))
    period_s = apart_s
    by_line = apart_s < PACED_BY_LINE * FORMAT.length * dialogue.transport.line.char_s
    if by_line and varied_s >= min(apart_s / 2.0, RESOLVED_S):
        period_s = min(apart_s, varied_s)
    next_value = 0.5 * period_s <= varied_s <= 1.5 * period_s
    may_wait_s = period_s if next_value else min(varied_s, period_s)
    return Pace(request, period_s, next_value, may_wait_s, min(waits_s))


def _apart_s(dialogue: Dialogue, address: int) -> float:
    """How long after each other values come that it sends by itself."""
    transport = dialogue.transport
    received: list[Received] = []
    for _ in range(TRIES):
        dialogue.settle()
        dialogue.tell(message.select(address), message.MEASURE)
        received = _taken(dialogue)
        for _ in ("STP", "STP"):  # one that did not hear it would send for ever
            dialogue.tell(message.END, message.select(address), message.command("STP"))
            dialogue.hush(SETTLE_S)
        if len(received) >= LEAST_VALUES and all(_is_value(each) for each in received):
            return _slope([each.last_byte_s for each in received])
        dialogue.hush(LATE_S)
    came = b"".join(each.data for each in received)
    raise DeviceError(
        f"amplifier {address:02d}, of a type that is not known, answers "
        f"{message.MEASURE.decode()} with {came[:20]!r}",
        allowed=f"values of {FORMAT.length} characters: sign, 7 digits, CR LF",
        where=transport.name,
        remedy="its type needs a Profile in rig/amplifier/profile.py, from its manual",
    )


def _taken(dialogue: Dialogue) -> list[Received]:
    """Up to `VALUES` answers of a value's length, the last of which may be short."""
    transport = dialogue.transport
    began_s = transport.clock.monotonic_s()
    taken: list[Received] = []
    while len(taken) < VALUES:
        now_s = transport.clock.monotonic_s()
        if len(taken) >= LEAST_VALUES and now_s > began_s + LONGEST_S:
            break
        taken.append(transport.read(FORMAT.length, now_s + SLOWEST_VALUE_S + MARGIN_S))
        if len(taken[-1].data) < FORMAT.length:
            break
    return taken


def _slope(times_s: list[float]) -> float:
    """Time from one to the next: the median over pairs far apart (Theil, Sen)."""
    far = len(times_s) // 2
    pairs = [
        (times_s[last] - times_s[first]) / (last - first)
        for first in range(len(times_s) - far)
        for last in range(first + far, len(times_s))
    ]
    return float(np.median(pairs))


def _waits_s(dialogue: Dialogue, request: bytes, apart_s: float) -> list[float]:
    """How long answers take beyond their bytes on the line, asked at phases of the period."""
    transport = dialogue.transport
    line_s = (len(request) + FORMAT.length) * transport.line.char_s
    began_s = transport.clock.monotonic_s()
    spread_s = max(apart_s, SPREAD_S)
    waits_s: list[float] = []
    for number in range(1, 2 * VALUES + 1):
        now_s = transport.clock.monotonic_s()
        enough = now_s > began_s + LONGEST_S and len(waits_s) >= LEAST_VALUES
        if enough or len(waits_s) == VALUES:
            break
        transport.clock.sleep_until(now_s + number * GOLDEN % 1.0 * spread_s)
        asked_s = transport.clock.monotonic_s()
        dialogue.tell(request)
        deadline_s = asked_s + line_s + 2.0 * apart_s + MARGIN_S
        received = transport.read(FORMAT.length, deadline_s)
        if _is_value(received):
            waits_s.append(received.last_byte_s - asked_s - line_s)
        else:
            dialogue.hush(LATE_S)
    if len(waits_s) < LEAST_VALUES:
        raise DeviceError(
            f"{request.decode()} was answered {len(waits_s)} times with a value",
            allowed=f"at least {LEAST_VALUES} of {2 * VALUES} times",
            where=transport.name,
            remedy="check wiring, baud and parity; `rig scan` lists who answers",
        )
    return waits_s


def _is_value(received: Received) -> bool:
    if received.damaged:
        return False
    try:
        FORMAT.decode(received.data)
    except BadFrameError:
        return False
    return True
