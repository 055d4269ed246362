"""Every published figure of Sections 4 and 5 beside ours."""

from dataclasses import asdict, dataclass

import pandas as pd

from model.reconstruct.published import (
    EXACT,
    LARGE_CABLE_5_MM,
    LOW_HZ,
    PEAKS_HZ,
    QUIET_AGAIN_HZ,
    QUIET_BELOW_HZ,
    QUIET_LIMITS,
    SMALL_LIMITS,
    VIOLENT,
    WITHOUT_EXCITATION_PITCH_DEG,
    Figure,
)
from model.summary import summarise
from model.sweep.paper import Runs

BAR = 0.10
"""Relative difference within which a violent figure counts as met."""

PEAK_BAR = 0.05
"""The same for the frequency of a peak: half the distance of the paper's figures, were its steps
1 Hz."""

UNITS = {"deg": "deg", "mm": "mm", "n": "N"}

WORDS = {
    "max_pitch_deg": "max \\|pitch\\|",
    "displacement_mm": "displacement",
    "rotation_deg": "rotation",
    "cable_mm": "largest cable amplitude",
    "tension_1_n": "max \\|T_1 - T_01\\|",
    "tension_7_n": "max \\|T_7 - T_07\\|",
}


@dataclass(frozen=True)
class Line:
    """One published figure beside ours.

    Parameters
    ----------
    what, source
        In words, and where it is published.
    published, own, median, low, high
        The figure; ours with the paper's start, median and range over changed starts and steps.
    ratio
        Median over published; None where the figure is a limit.
    met
        Whether the median is as published: to the digits, within 10 %, or within the limit.
    """

    what: str
    source: str
    published: str
    own: str
    median: str
    low: str
    high: str
    ratio: float | None
    met: bool

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)

    def as_row(self) -> tuple[str, ...]:
        """For a table."""
        ratio = "" if self.ratio is None else f"{self.ratio:.3g}"
        values = (self.published, self.own, self.median, f"{self.low} to {self.high}", ratio)
        return (self.what, *values, "yes" if self.met else "**no**", self.source)


def compare(statistics: pd.DataFrame, runs: Runs) -> list[Line]:
    """Every published figure of the simulations, in the paper's order.

    Parameters
    ----------
    statistics
        From `model.sweep.statistics.by_frequency`, of the paper's sweep.
    runs
        From `model.sweep.paper.run_shown`.
    """
    below = statistics[statistics["frequency_hz"] < QUIET_BELOW_HZ]
    first, last = QUIET_AGAIN_HZ
    again = statistics[statistics["frequency_hz"].between(first, last)]
    lines = [
        _limit(below, name, limit, stated, f"{LOW_HZ:g} Hz to below {QUIET_BELOW_HZ:g} Hz")
        for (name, limit), stated in zip(
            QUIET_LIMITS.items(), ("< 0.5", "< 0.3", "0.1"), strict=True
        )
    ]
    lines += [_figure(statistics, one, exact=False) for one in VIOLENT]
    lines += [_peak(statistics, peak) for peak in PEAKS_HZ]
    lines += [_large(statistics, peak) for peak in PEAKS_HZ]
    lines += [
        _limit(again, name, limit, "small", f"{first:g} to {last:g} Hz")
        for name, limit in SMALL_LIMITS.items()
    ]
    lines += [_without(runs, frequency) for frequency in sorted(runs.without_effect)]
    return lines + [_figure(statistics, one, exact=True) for one in EXACT]


def single_figures(statistics: pd.DataFrame) -> list[Line]:
    """The figures that are of one frequency: all a reconstruction needs to look at."""
    return [_figure(statistics, one, exact=one in EXACT) for one in (*EXACT, *VIOLENT)]


def _figure(statistics: pd.DataFrame, figure: Figure, *, exact: bool) -> Line:
    row = statistics.iloc[(statistics["frequency_hz"] - figure.frequency_hz).abs().argmin()]
    name, digits = figure.quantity, figure.decimals
    unit = UNITS[name.rsplit("_", 1)[1]]
    own, median, low, high = (
        float(row[name + suffix]) for suffix in ("", "_median", "_low", "_high")
    )
    ratio = median / figure.value
    shown = f".{digits}f"
    as_printed = f"{own:{shown}}" == f"{figure.value:{shown}}"
    return Line(
        what=f"{WORDS[name]} at {figure.frequency_hz:g} Hz, {unit}",
        source=figure.source,
        published=f"{figure.value:{shown}}",
        own=f"{own:{shown}}",
        median=f"{median:{shown}}",
        low=f"{low:{shown}}",
        high=f"{high:{shown}}",
        ratio=ratio,
        met=as_printed if exact else abs(ratio - 1.0) <= BAR,
    )


def _limit(rows: pd.DataFrame, name: str, limit: float, stated: str, what: str) -> Line:
    """A published upper limit over a range of frequencies: the largest we find there."""
    unit = UNITS[name.rsplit("_", 1)[1]]
    own, median, high = (float(rows[name + suffix].max()) for suffix in ("", "_median", "_high"))
    low = float(rows[f"{name}_low"].min())
    at_hz = float(rows["frequency_hz"].to_numpy()[rows[f"{name}_median"].to_numpy().argmax()])
    return Line(
        what=f"{WORDS[name]}, {what}, {unit}",
        source="Section 4.2, Figs. 4, 5",
        published=stated,
        own=f"{own:.2f}",
        median=f"{median:.2f}" + ("" if median < limit else f" (at {at_hz:g} Hz)"),
        low=f"{low:.2f}",
        high=f"{high:.2f}",
        ratio=None,
        met=median < limit,
    )


def _peak(statistics: pd.DataFrame, published_hz: float) -> Line:
    """Where the displacement has its largest median within 2 Hz of a published peak."""
    near = statistics[(statistics["frequency_hz"] - published_hz).abs() < 2.0]
    frequencies = near["frequency_hz"].to_numpy()
    own, median = (
        float(frequencies[near[name].to_numpy().argmax()])
        for name in ("displacement_mm", "displacement_mm_median")
    )
    return Line(
        what="frequency of a peak of the displacement, Hz",
        source="Section 4.2, Fig. 4(a)",
        published=f"{published_hz:g}",
        own=f"{own:g}",
        median=f"{median:g}",
        low=f"{median:g}",
        high=f"{median:g}",
        ratio=median / published_hz,
        met=abs(median / published_hz - 1.0) <= PEAK_BAR,
    )


def _large(statistics: pd.DataFrame, frequency_hz: float) -> Line:
    """Fig. 9: cable 5 in large vibration."""
    row = statistics.iloc[(statistics["frequency_hz"] - frequency_hz).abs().argmin()]
    own, median, low, high = (
        float(row["cable_5_mm" + suffix]) for suffix in ("", "_median", "_low", "_high")
    )
    return Line(
        what=f"amplitude of cable 5 at {frequency_hz:g} Hz, mm",
        source="Section 4.2, Fig. 9",
        published="large",
        own=f"{own:.2f}",
        median=f"{median:.2f}",
        low=f"{low:.2f}",
        high=f"{high:.2f}",
        ratio=None,
        met=median > LARGE_CABLE_5_MM,
    )


def _without(runs: Runs, frequency: float) -> Line:
    summary = summarise(runs.without_effect[frequency])
    value = float("nan") if summary is None else summary.max_pitch_deg
    shown = f"{value:.2f}"
    return Line(
        what=f"max \\|pitch\\| at {frequency:g} Hz without excitation effect, deg",
        source="Section 4.2, Table II, Figs. 6, 7",
        published=f"{WITHOUT_EXCITATION_PITCH_DEG:.2f}",
        own=shown,
        median=shown,
        low=shown,
        high=shown,
        ratio=value / WITHOUT_EXCITATION_PITCH_DEG,
        met=shown == f"{WITHOUT_EXCITATION_PITCH_DEG:.2f}",
    )
