"""What a user must know of the amplifiers: told once for all that share it."""

from collections.abc import Iterable, Mapping, Sequence

from cdpr8 import CABLES
from rig.amplifier import own_scaling
from rig.amplifier.profile import ADD_A_PROFILE
from rig.amplifier.text_frame import DIGITS_PER_MV_PER_V
from rig.station import Station


def concerns(stations: Sequence[Station]) -> list[str]:
    """Of types that are not known, and of what amplifiers do to their digits themselves."""
    strange = (
        (each.cable, each.identity.type, each.period_s) for each in stations if each.profile is None
    )
    told = ((each.cable, each.state.settings, each.state.found) for each in stations)
    return [*of_unknown_types(strange), *by_cables(told)]


def of_unknown_types(found: Iterable[tuple[int, str, float]]) -> list[str]:
    """How those are recorded of which no dialect is known, and what it costs, type by type.

    Parameters
    ----------
    found
        Cable, type as `IDN?` tells it, and output period in s as measured.
    """
    types: dict[str, dict[int, float]] = {}
    for cable, type_, period_s in found:
        types.setdefault(type_, {})[cable] = period_s
    return [
        f"{_whose([str(cable) for cable in periods_s])} is of the type {type_!r}, of which no "
        "dialect is known. Its values are asked for as text, and a sweep waits for each up to its "
        f"output period, measured as {1e3 * max(periods_s.values()):.2f} ms. [bus] filter, "
        "output_rate and output_format are not written to it: its filter is as it was, and its "
        "delay, unknown, is not taken off. Overload is told by the force alone, and "
        f"{DIGITS_PER_MV_PER_V} digits are taken for 1 mV/V: check that with a known load. "
        f"Remedy: {ADD_A_PROFILE}"
        for type_, periods_s in types.items()
    ]


def by_cables(told: Iterable[tuple[int, Mapping[str, str], Mapping[str, str]]]) -> list[str]:
    """Own scalings from cable numbers, settings as read back and settings as found."""
    cables: dict[str, list[str]] = {}
    for cable, settings, found in told:
        for words in own_scaling.concerns(settings, found):
            cables.setdefault(words, []).append(str(cable))
    return [f"{_whose(of)} {words}" for words, of in cables.items()]


def _whose(cables: Sequence[str]) -> str:
    if len(cables) == CABLES:
        return "every amplifier"
    return f"the amplifier of cable {', '.join(cables)}"
