"""Fit before and after: over time on used and held-out data, and its size against the noise."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.diagnosis.figure_style import Look, below_key, key, most_off, shown
from analysis.diagnosis.pictures import Channel, Pictures, Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CYCLES = 2.0
"""Cycles shown on each side of where held-out data begin."""


def fit(pictures: Pictures, record: str, look: Look) -> "Figure":
    """Recorded and simulated over time, with residuals, where used and held-out data meet.

    Parameters
    ----------
    pictures, record
        What, and which run.
    look
        Colours and width.
    """
    from matplotlib.figure import Figure

    run = pictures.record(record)
    angle = next((c for c in pictures.of(record, "pose") if c.name.startswith(run.axis)), None)
    chosen = [one for one in (angle, most_off(pictures.of(record, "tension"))) if one is not None]
    across = 1 if look.narrow else len(chosen)
    down = 2 * len(chosen) // across
    tall = 2.3 * down + 0.35
    figure = Figure(figsize=(look.width, tall), layout="constrained")
    below_key(figure, tall)
    ratios = [1.0, 1.1] * (down // 2)
    panels = figure.subplots(down, across, squeeze=False, height_ratios=ratios)
    window, border = _window(run)
    for i, one in enumerate(chosen):
        above, below = panels[2 * i : 2 * i + 2, 0] if look.narrow else panels[:, i]
        _course(above, one, window, look, pictures.named)
        _rest(below, one, window, look, pictures.named)
        for axes in (above, below):
            axes.set_xlim(window)
            if border is not None:
                axes.axvspan(border, window[1], color=look.faint, alpha=0.45, linewidth=0)
        if border is not None:
            above.text(border, 1.0, " held out", transform=above.get_xaxis_transform(), va="bottom")
            above.text(border, 1.0, "used ", transform=above.get_xaxis_transform(), va="bottom",
                       ha="right")  # fmt: skip
    key(figure, look, named=pictures.named)
    return figure


def improvement(said: Mapping[str, Any], look: Look) -> "Figure":
    """Residual over noise before and after, for each kind of channel, used and held out.

    Parameters
    ----------
    said
        The statement.
    look
        Colours and width.
    """
    from matplotlib.figure import Figure

    before, after = said["fit"].get("before", {}), said["fit"].get("after", {})
    words = {"used": "data used", "held_out": "held out"}
    rows = [
        (f"{kind}, {words.get(part, part)}", value, after.get(part, {}).get(kind))
        for part, kinds in before.items()
        for kind, value in kinds.items()
    ]
    figure = Figure(figsize=(look.width, 0.45 * len(rows) + 1.0), layout="constrained")
    axes = figure.subplots()
    axes.set_xscale("log")
    for i, (_, first, last) in enumerate(rows):
        side = 1 if last is None or last <= first else -1
        _dot(axes, first, i, look.before, f"{first:.3g}" + " before" * (i == 0), side)
        if last is not None:
            join = {"arrowstyle": "-", "color": look.ink, "lw": 1.2, "shrinkA": 6, "shrinkB": 6}
            axes.annotate("", (last, i), (first, i), arrowprops=join)
            _dot(axes, last, i, look.after, "after " * (i == 0) + f"{last:.3g}", -side)
    axes.axvline(1.0, color=look.ink, linewidth=1.2, linestyle=":")
    axes.text(1.0, -0.75, " noise alone", va="center")
    axes.set_yticks(range(len(rows)), [one[0] for one in rows])
    axes.set_ylim(len(rows) - 0.4, -1.1)
    values = [v for row in rows for v in row[1:] if v is not None]
    axes.set_xlim(min(0.6, 0.6 * min(values)), 2.2 * max(values))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("rms residual over the noise")
    axes.grid(False, axis="y")
    return figure


def _dot(axes: "Axes", at: float, row: int, colour: str, word: str, side: int) -> None:
    """A dot with its number beside it, to the right (1) or to the left (-1)."""
    axes.plot(at, row, "o", color=colour, markersize=8)
    axes.annotate(word, (at, row), xytext=(8 * side, 0), textcoords="offset points", va="center",
                  ha="left" if side > 0 else "right", color=colour)  # fmt: skip


def _window(run: Record) -> tuple[tuple[float, float], float | None]:
    """Times shown, and where held-out data begin; None: nothing was held out."""
    steady = [one for one in run.stretches if one.repeats]
    held = next((one for one in steady if one.held_out), None)
    period = 1.0 / run.frequency_hz
    if held is not None:
        return (held.start_s - CYCLES * period, held.start_s + CYCLES * period), held.start_s
    if steady:
        return (steady[0].start_s, steady[0].start_s + 2 * CYCLES * period), None
    return (run.stretches[0].start_s, run.stretches[-1].end_s), None


def _course(
    axes: "Axes", one: Channel, window: tuple[float, float], look: Look, named: bool
) -> None:
    inside = (one.t_s >= window[0]) & (one.t_s <= window[1])
    factor, unit, name = shown(one)
    t_s = one.t_s[inside]
    axes.plot(t_s, factor * one.before[inside], color=look.before, linewidth=1.5)
    if named:
        axes.plot(t_s, factor * one.after[inside], color=look.after, linewidth=1.5)
    axes.plot(t_s, factor * one.recorded[inside], ".", color=look.recorded,
              markersize=5 if np.count_nonzero(inside) < 80 else 3)  # fmt: skip
    axes.set_title(f"{name} ({unit})", loc="left", weight="bold", pad=14)
    axes.tick_params(labelbottom=False)


def _rest(axes: "Axes", one: Channel, window: tuple[float, float], look: Look, named: bool) -> None:
    inside = (one.t_s >= window[0]) & (one.t_s <= window[1])
    factor, unit, _ = shown(one)
    t_s, noise = one.t_s[inside], 2.0 * factor * one.sigma[inside]
    axes.fill_between(t_s, -noise, noise, color=look.ink, alpha=0.25, lw=0)
    off = factor * (one.recorded - one.before)[inside]
    axes.plot(t_s, off, ".-", color=look.before, markersize=3, linewidth=0.8)
    if named:
        off = factor * (one.recorded - one.after)[inside]
        axes.plot(t_s, off, ".-", color=look.after, markersize=3, linewidth=0.8)
    axes.set_title(f"residual ({unit}); band: noise ± 2 sigma", loc="left", fontsize=9)
    axes.set_xlabel("time (s)")
