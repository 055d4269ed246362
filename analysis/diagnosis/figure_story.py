"""One run in three panels: what was missed, where, and what is left once the causes are in."""

from collections.abc import Mapping
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.diagnosis.figure_maps import TICKS, by_harmonic, paint
from analysis.diagnosis.figure_style import Look, key, shown
from analysis.diagnosis.fit_words import KINDS
from analysis.diagnosis.pictures import Array, Channel, Pictures, Record
from analysis.diagnosis.spelling import listed
from analysis.diagnosis.words import headline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTS = 48
"""Of the mean cycle: what does not repeat, such as a ring, is in the shade about it."""

LINE_IN = 0.19
"""A line of text."""

QUARTERS, QUARTER_WORDS = (0.0, 0.25, 0.5, 0.75, 1.0), ("0", "1/4", "1/2", "3/4", "1")

HEADS = ("BEFORE", "WHERE", "AFTER")


def story(said: Mapping[str, Any], pictures: Pictures, record: str, look: Look) -> "Figure":
    """The channel farthest off before, all channels by harmonic, and that channel after.

    Where nothing was named there is no panel of after.

    Parameters
    ----------
    said
        The statement.
    pictures, record
        What, and which run; its motion repeats.
    look
        Colours and width.
    """
    from matplotlib.figure import Figure

    run = pictures.record(record)
    worst = shown_channel(pictures.of(record, "tension") or pictures.of(record))
    letters = 46 if look.narrow else 112
    above, below = fill(headline(said), letters), fill(improved(said), letters)
    top = LINE_IN * (above.count("\n") + 1) + 0.42
    foot = LINE_IN * (below.count("\n") + 1) + 0.06 if below else 0.0
    stages = ["before", "after"] if pictures.named else ["before"]
    tall = (3.1 * len(stages) + 4.4 if look.narrow else 4.0) + top + foot
    figure = Figure(figsize=(look.width, tall), layout="constrained")
    engine: Any = figure.get_layout_engine()
    engine.set(rect=(0, foot / tall, 1, 1 - (top + foot) / tall))
    pairs, where = _panels(figure, len(stages), look)
    for stage, head, (curve, rest) in zip(stages, HEADS[::2], pairs, strict=False):
        _cycle(curve, worst, run, stage, head, look)
        _residual(rest, worst, run, stages[: stages.index(stage) + 1], look)
        for axes in (curve, rest):
            axes.set_xlim(0.0, 1.0)
            axes.set_xticks(QUARTERS, QUARTER_WORDS if axes is rest else [""] * len(QUARTERS))
            axes.sharey(pairs[0][axes is rest])
    _where(figure, where, pictures.of(record))
    figure.text(0.02, 1 - 0.03 / tall, above, va="top", weight="bold", fontsize=10)
    figure.text(0.02, 0.06 / tall, below, va="bottom", weight="bold", fontsize=10)
    key(figure, look, named=pictures.named, top=1 - (top - 0.32) / tall)
    return figure


def shown_channel(channels: tuple[Channel, ...]) -> Channel:
    """The channel that is farthest off before, as a share of what it swings."""

    def share(one: Channel) -> float:
        return float((one.recorded - one.before).std() / max(one.recorded.std(), one.noise))

    return max(channels, key=share)


def improved(said: Mapping[str, Any]) -> str:
    """By how much the fit improves, on held-out data where there are any; "" where it was not."""
    before, after = said["fit"].get("before", {}), said["fit"].get("after", {})
    for part, words in (("held_out", "On held-out data"), ("used", "On the data used")):
        kinds = before.get(part, {})
        if kinds and said["causes"]:
            numbers = [
                f"{KINDS.get(kind, kind)} {value:.3g} \N{RIGHTWARDS ARROW} {after[part][kind]:.3g}"
                for kind, value in kinds.items()
                if kind in after.get(part, {})
            ]
            return f"{words}, rms residual in units of the noise: {listed(numbers)}."
    return ""


def mean_cycle(run: Record, t_s: Array, values: Array) -> tuple[Array, Array, Array]:
    """Middle, mean and spread of values in each part of the drive's cycle that has any.

    Parameters
    ----------
    run
        Whose drive; only where its motion repeats.
    t_s, values
        Samples, shape (n,).
    """
    inside = run.steady(t_s)
    place = (run.phase(t_s[inside]) * PARTS).astype(int) % PARTS
    count = np.bincount(place, minlength=PARTS)
    some = count > 0
    mean = np.bincount(place, values[inside], minlength=PARTS) / np.maximum(count, 1)
    square = np.bincount(place, (values[inside] - mean[place]) ** 2, minlength=PARTS)
    spread = np.sqrt(square / np.maximum(count, 1))
    return (np.arange(PARTS)[some] + 0.5) / PARTS, mean[some], spread[some]


def _panels(figure: "Figure", stages: int, look: Look) -> "tuple[list[tuple[Axes, Axes]], Axes]":
    """A curve over its residual for each stage, and the map: after the first of them."""
    if look.narrow:
        ratios = [1.25, 1.0, 2.7, 1.25, 1.0][: 1 + 2 * stages]
        rows = figure.subplots(len(ratios), 1, height_ratios=ratios)
        return [(rows[0], rows[1]), (rows[-2], rows[-1])][:stages], rows[2]
    grid = figure.add_gridspec(2, 1 + stages, height_ratios=[1.25, 1.0])
    pairs = [
        (figure.add_subplot(grid[0, column]), figure.add_subplot(grid[1, column]))
        for column in (0, 2)[:stages]
    ]
    return pairs, figure.add_subplot(grid[:, 1])


def _cycle(axes: "Axes", one: Channel, run: Record, stage: str, head: str, look: Look) -> None:
    factor, unit, name = shown(one)
    at, simulated, _ = mean_cycle(run, one.t_s, factor * getattr(one, stage))
    axes.plot(at, simulated, color=getattr(look, stage), linewidth=2.0)
    at, recorded, _ = mean_cycle(run, one.t_s, factor * one.recorded)
    axes.plot(at, recorded, ".", color=look.recorded, markersize=4.5)
    axes.set_title(f"{head}: {name} ({unit})", loc="left", weight="bold")


def _residual(axes: "Axes", one: Channel, run: Record, stages: list[str], look: Look) -> None:
    factor, unit, _ = shown(one)
    at, noise, _ = mean_cycle(run, one.t_s, 2.0 * factor * one.sigma)
    axes.fill_between(at, -noise, noise, color=look.ink, alpha=0.25, lw=0)
    for stage in stages:
        off = factor * (one.recorded - getattr(one, stage))
        at, mean, spread = mean_cycle(run, one.t_s, off)
        colour = getattr(look, stage)
        axes.fill_between(at, mean - spread, mean + spread, color=colour, alpha=0.2, lw=0)
        axes.plot(at, mean, color=colour, linewidth=1.8)
    axes.set_title(f"recorded - simulated ({unit}); grey: noise", loc="left", fontsize=9)
    axes.set_xlabel("part of the drive's cycle")


def _where(figure: "Figure", axes: "Axes", channels: tuple[Channel, ...]) -> None:
    from matplotlib.colors import LogNorm

    lines = by_harmonic(channels, "before")
    top = max(float(np.nanmax(lines)), 10.0)
    image = paint(axes, lines, channels, "magma_r", LogNorm(1.0, top))
    axes.set_xticks(range(lines.shape[1]))
    axes.set_xlabel("harmonic of the drive (0: mean)")
    axes.set_title(f"{HEADS[1]}: all channels", loc="left", weight="bold")
    bar = figure.colorbar(image, ax=axes, location="bottom", aspect=30, pad=0.02)
    marks = [one for one in TICKS if one < top]
    bar.set_ticks(marks, labels=[f"{one:g}" for one in marks])
    bar.set_label("times the noise, before")
