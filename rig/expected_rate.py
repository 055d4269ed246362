"""How many values a second are to be expected: what the line, or the amplifiers, can give."""

from collections.abc import Sequence

from cdpr8.rigfile.schema import Rig
from rig.amplifier import message
from rig.station import Station
from rig.transport import LineSettings


def expected_rates(stations: Sequence[Station], rig: Rig, line: LineSettings) -> dict[int, float]:
    """Values a second of each cable, where nothing is late or lost.

    Parameters
    ----------
    stations
        Started.
    rig
        Whose ``[bus]`` tells the kind of sweep.
    line
        Speed and framing of each line.

    Returns
    -------
    dict
        Cable -> values a second. On one bus those of a sweep without any time between answers and
        questions (protocol note, section 9), but for the mean wait of those that answer when their
        next value is ready; from a port of its own, an amplifier's output rate.
    """
    if rig.bus.streaming:
        return {each.cable: 1.0 / each.period_s for each in stations}
    chars = sum(len(each.request) + each.format.length for each in stations)
    sweep_s = chars * line.char_s + sum(each.waits_s / 2.0 for each in stations)
    if rig.bus.sweep == "broadcast":
        sweep_s += len(message.TRIGGER) * line.char_s
        sweep_s += max(each.period_s for each in stations)
    return {each.cable: 1.0 / sweep_s for each in stations}
