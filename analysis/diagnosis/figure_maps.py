"""Residual maps: channel by harmonic and channel by part of the cycle, against the noise."""

from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.diagnosis.figure_style import Look, shown
from analysis.diagnosis.pictures import Array, Channel, Pictures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PHASES = 24
"""Parts of a cycle."""

TICKS = (1.0, 10.0, 100.0, 1000.0)


def residual_map(pictures: Pictures, record: str, look: Look) -> "Figure":
    """Where recording and simulation differ, before and after.

    Parameters
    ----------
    pictures
        What to draw.
    record
        Which run; its motion repeats.
    look
        Colours and width.
    """
    from matplotlib.colors import LogNorm, SymLogNorm
    from matplotlib.figure import Figure

    channels = pictures.of(record)
    stages = [("before", "before"), ("after", "after, causes in")][: 2 if pictures.named else 1]
    rows = len(stages) * (2 if look.narrow else 1)
    height = (0.26 * len(channels) + 0.75) * rows + 0.9
    figure = Figure(figsize=(look.width, height), layout="constrained")
    panels = figure.subplots(rows, 1 if look.narrow else 2, squeeze=False)
    flat = panels.ravel()
    lines = [by_harmonic(channels, stage) for stage, _ in stages]
    cycles = [by_phase(pictures, record, stage) for stage, _ in stages]
    top = max(float(np.nanmax(lines[0])), 10.0)
    most = max(float(np.abs(cycles[0]).max()), 10.0)
    # A phone shows all harmonics and then all phases, a page both side by side.
    half = len(stages)
    lefts = flat[:half] if look.narrow else flat[::2]
    rights = flat[half:] if look.narrow else flat[1::2]
    for i, (_, words) in enumerate(stages):
        left, right = lefts[i], rights[i]
        image = paint(left, lines[i], channels, "magma_r", LogNorm(1.0, top))
        _numbers(left, lines[i], top)
        left.set_xticks(range(lines[i].shape[1]))
        left.set_xlabel("harmonic of the drive (0: mean)")
        left.set_title(f"{words}: by harmonic", loc="left", weight="bold")
        norm = SymLogNorm(max(1.0, most / 20.0), vmin=-most, vmax=most)
        other = paint(right, cycles[i], channels, "PuOr", norm)
        right.set_xticks(np.linspace(-0.5, PHASES - 0.5, 5), ["0", "1/4", "1/2", "3/4", "1"])
        right.set_xlabel("part of the drive's cycle")
        right.set_title(f"{words}: by phase", loc="left", weight="bold")
        if not look.narrow:
            right.set_yticklabels([])
    marks = [one for one in TICKS if one < top]
    bar = figure.colorbar(image, ax=list(lefts), location="bottom", aspect=40, pad=0.02)
    bar.set_ticks(marks, labels=[f"{one:g}" for one in marks])
    bar.set_label("residual, times the noise")
    marks = [one for one in TICKS if max(1.0, most / 20.0) <= one < most]
    bar = figure.colorbar(other, ax=list(rights), location="bottom", aspect=40, pad=0.02)
    both = [*(-one for one in reversed(marks)), 0.0, *marks]
    bar.set_ticks(both, labels=[f"{one:g}" for one in both])
    bar.set_label("recorded - simulated, times the noise")
    return figure


def by_harmonic(channels: tuple[Channel, ...], stage: str) -> Array:
    """Residual at each harmonic in units of its noise, shape (channels, harmonics).

    What is sampled too slowly for a harmonic, or over too short a stretch, has none: not a number.

    Parameters
    ----------
    channels
        Of one run, one of them with harmonics.
    stage
        "before" or "after".
    """
    rows = [getattr(one, f"harmonics_{stage}") for one in channels]
    lines = np.full((len(rows), max(row.size for row in rows)), np.nan)
    for line, row in zip(lines, rows, strict=True):
        line[: row.size] = row
    return lines


def by_phase(pictures: Pictures, record: str, stage: str) -> Array:
    """Mean residual in each part of the cycle over the noise of a sample, shape (channels, parts).

    Parameters
    ----------
    pictures, record
        What, and which run.
    stage
        "before" or "after".
    """
    run = pictures.record(record)
    rows = []
    for one in pictures.of(record):
        inside = run.steady(one.t_s)
        place = (run.phase(one.t_s[inside]) * PHASES).astype(int) % PHASES
        off = (one.recorded - getattr(one, stage))[inside] / one.sigma[inside]
        count = np.bincount(place, minlength=PHASES)
        rows.append(np.bincount(place, off, minlength=PHASES) / np.maximum(count, 1))
    return np.stack(rows)


def paint(
    axes: "Axes", values: Array, channels: tuple[Channel, ...], colours: str, norm: Any
) -> Any:
    """Channels below each other, one square for each value, in colours.

    Parameters
    ----------
    axes
        Where.
    values
        Shape (channels, columns); on a scale of sizes, what is below 1 is painted as 1.
    channels
        The rows.
    colours, norm
        matplotlib's colour map and scale.
    """
    axes.grid(False)
    lifted = values if norm.vmin < 0 else np.maximum(values, 1.0)
    image = axes.imshow(lifted, aspect="auto", cmap=colours, norm=norm, interpolation="nearest")
    axes.set_yticks(range(len(channels)), [shown(one)[2] for one in channels])
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)
    return image


def _numbers(axes: "Axes", values: Array, top: float) -> None:
    """The numbers themselves, in the cells that stand out."""
    for row, column in np.argwhere(values >= 3.0):
        value = values[row, column]
        dark = np.log(max(value, 1.0)) > 0.55 * np.log(top)
        axes.text(
            column, row, f"{value:.0f}", ha="center", va="center", fontsize=6.5,
            color="#ffffff" if dark else "#1c1c1c",
        )  # fmt: skip
