"""Loops of tension against elongation, and the residual against the cable's speed."""

from typing import TYPE_CHECKING

import numpy as np

from analysis.diagnosis.figure_style import Look, below_key, key, most_off
from analysis.diagnosis.pictures import Array, Channel, Pictures, Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTS = 72
"""Parts of the cycle over which loops are averaged: what does not repeat, such as a ring, goes."""

SPEEDS = 15
"""Bins of the cable's speed."""


def loops(pictures: Pictures, record: str, look: Look) -> "Figure":
    """Tension against elongation of the worst cable, and of every cable less its elastic part.

    Each simulation stands over its own elongation, and the recording, whose camera is too slow for
    it, over that with the causes in.

    Parameters
    ----------
    pictures, record
        What, and which run; its motion repeats.
    look
        Colours and width.
    """
    tensions = pictures.of(record, "tension")
    figure, panels = panel_grid(len(tensions) + 1, look, 2.0)
    run = pictures.record(record)
    worst = most_off(tensions)
    assert worst is not None
    first = panels[0]
    _loop(first, worst, run, look, pictures.named, spring=False)
    first.set_title(f"cable {worst.cable}: T (N)", loc="left", weight="bold")
    for axes, one in zip(panels[1:], tensions, strict=False):
        _loop(axes, one, run, look, pictures.named, spring=True)
        axes.set_title(f"cable {one.cable}: T - k ΔL (N)", loc="left")
    for axes in panels[-(2 if look.narrow else 3) :]:
        axes.set_xlabel("elongation (mm)")
    key(figure, look, named=pictures.named)
    return figure


def speeds(pictures: Pictures, record: str, look: Look) -> "Figure":
    """Mean residual of every tension against the speed of its cable, before and after.

    Parameters
    ----------
    pictures, record
        What, and which run; its motion repeats.
    look
        Colours and width.
    """
    tensions = pictures.of(record, "tension")
    figure, panels = panel_grid(len(tensions), look, 1.9, columns=4)
    run = pictures.record(record)
    stages = (("before", look.before), ("after", look.after))
    for axes, one in zip(panels, tensions, strict=False):
        inside = run.steady(one.t_s)
        rate = 1e3 * one.rate_m_per_s[inside]
        axes.axhline(0.0, color=look.ink, linewidth=0.8)
        at, noise, _ = _binned(rate, 2.0 * one.sigma[inside], SPEEDS)
        axes.fill_between(at, -noise, noise, color=look.faint, lw=0)
        for stage, colour in stages if pictures.named else stages[:1]:
            off = (one.recorded - getattr(one, stage))[inside]
            at, mean, spread = _binned(rate, off, SPEEDS)
            axes.fill_between(at, mean - spread, mean + spread, color=colour, alpha=0.2, lw=0)
            axes.plot(at, mean, color=colour, linewidth=1.8)
        axes.set_title(f"cable {one.cable} (N)", loc="left")
    for axes in panels[-(2 if look.narrow else 4) :]:
        axes.set_xlabel("cable speed (mm/s)")
    key(figure, look, named=pictures.named, first="residual:")
    return figure


def _loop(
    axes: "Axes", one: Channel, run: Record, look: Look, named: bool, *, spring: bool
) -> None:
    inside = run.steady(one.t_s)
    if not inside.any():
        return
    place = (run.phase(one.t_s[inside]) * PARTS).astype(int) % PARTS
    for values, elongation, colour, style in (
        (one.before, one.elongation_before_m, look.before, "-"),
        (one.after, one.elongation_m, look.after, "-"),
        (one.recorded, one.elongation_m, look.recorded, "."),
    ):
        if values is one.after and not named:
            continue
        x = _averaged(place, 1e3 * elongation[inside])
        pull = one.stiffness_n_per_m * elongation
        level = float((values - pull)[inside].mean())
        y = _averaged(place, (values - (pull + level if spring else 0.0))[inside])
        if style == ".":
            axes.plot(x, y, style, color=colour, markersize=3.0)
        else:
            closed = np.append(np.arange(len(x)), 0)
            axes.plot(x[closed], y[closed], style, color=colour, linewidth=1.8)


def _averaged(place: Array, values: Array) -> Array:
    count = np.bincount(place.astype(int), minlength=PARTS)
    total = np.bincount(place.astype(int), values, minlength=PARTS)
    return np.asarray((total / np.maximum(count, 1))[count > 0])


def _binned(x: Array, y: Array, bins: int) -> tuple[Array, Array, Array]:
    """Middle, mean and spread of equally filled bins of x."""
    order = np.argsort(x, kind="stable")
    parts = [one for one in np.array_split(order, bins) if one.size]
    return (
        np.array([x[one].mean() for one in parts]),
        np.array([y[one].mean() for one in parts]),
        np.array([y[one].std() for one in parts]),
    )


def panel_grid(
    count: int, look: Look, height: float, columns: int = 3
) -> "tuple[Figure, list[Axes]]":
    """A figure with as many panels, and room above for the key."""
    from matplotlib.figure import Figure

    across = 2 if look.narrow else columns
    rows = -(-count // across)
    tall = height * rows + 0.35
    figure = Figure(figsize=(look.width, tall), layout="constrained")
    below_key(figure, tall)
    panels = list(figure.subplots(rows, across, squeeze=False).ravel())
    for panel in panels[count:]:
        panel.set_visible(False)
    return figure, panels[:count]
