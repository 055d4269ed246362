"""How much later than it was an amplifier's filter and averaging make a tension show.

A property of the set-up: stored in start.json, taken off where a run is read, never in tension.csv.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cdpr8.rigfile.schema import Rig
from rig.amplifier.profile import Profile
from rig.station import Station

FIRST_ORDER_SIGMA = 0.2
"""How far the first-order model is off the tables of settling times (protocol note, section 8)."""

PLAUSIBLE_FACTOR = 3.0
PLAUSIBLE_S = 0.02
"""A measured delay within this factor, and this much more, of the first-order one is not doubted:
analogue stages and adapters add some ms.
"""


@dataclass(frozen=True)
class FilterDelay:
    """A delay.

    Attributes
    ----------
    delay_s, sigma_s
        With its standard uncertainty.
    source
        Where it comes from.
    """

    delay_s: float
    sigma_s: float
    source: Literal["measured", "from the cut-off"]


def filter_delay(station: Station, rig: Rig) -> FilterDelay | None:
    """The delay of one cable's amplifier: the one measured, where the rig file has one.

    The amplifier's own comes before that of the bus, and both before the estimate. None where its
    type is not known, unless it has one of its own: the bus's filter is not written to it.
    """
    amplifier = rig.cable[station.cable - 1].amplifier
    own = None if amplifier is None else amplifier.filter_delay_s
    measured = rig.bus.filter_delay_s if own is None and station.profile is not None else own
    if measured is not None:
        return FilterDelay(measured.value, measured.sigma, "measured")
    return None if station.profile is None else from_cut_off(station, station.profile)


def from_cut_off(station: Station, profile: Profile) -> FilterDelay:
    """How late a steady change shows: first-order filter, then the mean over an output period.

    First-order behaviour is a fair model of the filter (protocol note, section 8).
    """
    cut_off_hz = profile.cut_offs_hz[int(station.state.settings["ASF"])]
    filter_s = 0.0 if cut_off_hz is None else 1.0 / (2.0 * math.pi * cut_off_hz)
    mean_s = (station.period_s - profile.period_s(0)) / 2.0
    return FilterDelay(filter_s + mean_s, FIRST_ORDER_SIGMA * filter_s, "from the cut-off")


def doubts(stations: Sequence[Station], rig: Rig) -> list[str]:
    """Measured delays that cannot well be of this filter, in words."""
    words: dict[str, list[str]] = {}
    for station in stations:
        delay = filter_delay(station, rig)
        if delay is None or station.profile is None:
            continue
        estimate = from_cut_off(station, station.profile)
        least_s = estimate.delay_s / PLAUSIBLE_FACTOR - PLAUSIBLE_S
        most_s = estimate.delay_s * PLAUSIBLE_FACTOR + PLAUSIBLE_S
        if delay.source == "measured" and not least_s <= delay.delay_s <= most_s:
            told = (
                f"filter_delay_s = {delay.delay_s:g} was measured, and its filter's cut-off gives "
                f"{estimate.delay_s:.4f} s: is it in s, and of this filter and output_rate?"
            )
            words.setdefault(told, []).append(str(station.cable))
    return [f"cable {', '.join(cables)}: {told}" for told, cables in words.items()]
