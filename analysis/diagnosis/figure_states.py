"""The missing force as a map over the cable's state: what was left out, with no law assumed."""

from typing import TYPE_CHECKING

import numpy as np

from analysis.diagnosis.figure_loops import panel_grid
from analysis.diagnosis.figure_style import Look
from analysis.diagnosis.pictures import Array, Channel, Pictures, Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELLS = 11
"""Parts of the range of elongation, and of the speed."""

FEWEST = 3
"""Samples that a mean is taken of."""


def states(pictures: Pictures, record: str, look: Look) -> "Figure":
    """Mean of recorded less simulated tension over elongation and speed of each cable.

    Parameters
    ----------
    pictures, record
        What, and which run; its motion repeats.
    look
        Colours and width.
    """
    tensions = pictures.of(record, "tension")
    figure, panels = panel_grid(len(tensions), look, 2.0, columns=4)
    run = pictures.record(record)
    maps = [force_map(one, run) for one in tensions]
    top = max((float(np.nanmax(np.abs(one))) for _, _, one in maps if np.isfinite(one).any()),
              default=1.0)  # fmt: skip
    for axes, one, (elongation, speed, force) in zip(panels, tensions, maps, strict=True):
        axes.grid(False)
        image = axes.pcolormesh(
            1e3 * elongation, 1e3 * speed, force, cmap="PuOr", vmin=-top, vmax=top, rasterized=True
        )
        axes.set_title(f"cable {one.cable}", loc="left")
    across = 2 if look.narrow else 4
    for axes in panels[-across:]:
        axes.set_xlabel("elongation (mm)")
    for axes in panels[::across]:
        axes.set_ylabel("speed (mm/s)")
    if panels:
        bar = figure.colorbar(image, ax=panels, location="bottom", aspect=40, pad=0.02)
        bar.set_label("recorded - simulated, nothing left out, less its mean (N)")
    return figure


def force_map(channel: Channel, run: Record) -> tuple[Array, Array, Array]:
    """Mean residual of a tension, in cells of the cable's state.

    Parameters
    ----------
    channel, run
        A tension, and the run it belongs to.

    Returns
    -------
    elongation_m, speed_m_per_s
        Edges of the cells, shape (CELLS + 1,).
    force_n
        E[residual | elongation, speed] less the mean of all, shape (speed, elongation); not a
        number where there are fewer than `FEWEST` samples.
    """
    inside = run.steady(channel.t_s)
    off = (channel.recorded - channel.before)[inside]
    places, edges = [], []
    for values in (channel.rate_m_per_s[inside], channel.elongation_m[inside]):
        low, high = (values.min(), values.max()) if len(values) else (0.0, 1.0)
        edge = np.linspace(low, high if high > low else low + 1e-9, CELLS + 1)
        edges.append(edge)
        places.append(np.clip(np.digitize(values, edge) - 1, 0, CELLS - 1))
    cell = places[0] * CELLS + places[1]
    count = np.bincount(cell, minlength=CELLS**2)
    total = np.bincount(cell, off - (off.mean() if len(off) else 0.0), minlength=CELLS**2)
    mean = np.where(count >= FEWEST, total / np.maximum(count, 1), np.nan)
    return edges[1], edges[0], mean.reshape(CELLS, CELLS)
