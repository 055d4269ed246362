"""Figures like the paper's 4 to 9. A leaf: nothing that computes imports this."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from cdpr8 import CABLES
from model.simulation import Simulation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

OURS = "#1f5fa8"
OTHER = "#d1495b"
GREY = "#8a8a8a"
CABLE_COLOURS = ("#1f5fa8", "#e08a1e", "#2f8f5b", "#8a4fa3")

FIRST_GROUP = (1, 2, 6, 7)
"""Fig. 5(a); the others are in Fig. 5(b)."""

SHOWN_CABLE = 5
"""Fig. 9."""

STYLE: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#d8d8d8",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "svg.hashsalt": "cdpr8",
    "savefig.dpi": 130,
}

Marks = Sequence[tuple[float, float]]


def _styled() -> AbstractContextManager[None]:
    import matplotlib as mpl

    context: AbstractContextManager[None] = mpl.rc_context(STYLE)
    return context


def write_figure(figure: "Figure", path: Path) -> Path:
    """Save a figure; without a date, so that the same numbers give the same file."""
    with _styled():
        dated = {"Date": None} if path.suffix == ".svg" else {"Software": None}
        figure.savefig(path, metadata=dated)
    return path


def platform_figure(statistics: pd.DataFrame, published: Mapping[str, Marks]) -> "Figure":
    """Fig. 4: displacement and rotation of the platform against frequency.

    Parameters
    ----------
    statistics
        From `model.sweep.statistics.by_frequency`.
    published
        Marks to draw, (frequency, value), by column.
    """
    panels = (
        ("displacement_mm", "displacement from X* (mm)", "(a)"),
        ("rotation_deg", "rotation from X* (deg)", "(b)"),
    )
    with _styled():
        figure, axes = _panels(2, (8.0, 6.4))
        for axis, (column, label, letter) in zip(axes, panels, strict=True):
            _band(axis, statistics, column, OURS, "median and range")
            single = statistics["runs"].max() == 1
            if not single:
                axis.plot(
                    statistics["frequency_hz"],
                    statistics[column],
                    ".",
                    color="black",
                    markersize=3,
                    label="the motion's own start",
                )
            _marks(axis, published.get(column, ()))
            axis.set_ylabel(label)
            axis.set_title(letter, loc="left")
        axes[0].legend(loc="upper left")
        axes[-1].set_xlabel("frequency of the commanded motion (Hz)")
    return figure


def cable_figure(statistics: pd.DataFrame, published: Mapping[str, Marks]) -> "Figure":
    """Fig. 5: amplitudes of the cables against frequency, medians."""
    second = tuple(number for number in range(1, CABLES + 1) if number not in FIRST_GROUP)
    with _styled():
        figure, axes = _panels(2, (8.0, 6.4))
        for axis, group, letter in zip(axes, (FIRST_GROUP, second), "ab", strict=True):
            for number, colour in zip(group, CABLE_COLOURS, strict=True):
                _band(axis, statistics, f"cable_{number}_mm", colour, f"cable {number}")
            _marks(axis, published.get("cable_mm", ()), "published, largest of the eight")
            axis.set_ylabel("max |X_w| (mm)")
            axis.set_title(f"({letter})", loc="left")
            axis.legend(loc="upper left")
        axes[-1].set_xlabel("frequency of the commanded motion (Hz)")
    return figure


def pitch_series_figure(
    with_effect: Simulation, without_effect: Simulation, title: str
) -> "Figure":
    """Figs. 6 and 7: pitch over time with and without excitation effect."""
    with _styled():
        figure, (axis,) = _panels(1, (8.0, 3.4))
        for simulation, colour, line, label in (
            (with_effect, OURS, "-", "with excitation effect"),
            (without_effect, OTHER, "--", "without"),
        ):
            pitch = np.rad2deg(simulation.pose[:, 4])
            shown = f"{label}: max |θ| {np.abs(pitch).max():.2f} deg"
            axis.plot(simulation.t_s, pitch, line, color=colour, linewidth=0.9, label=shown)
        axis.set_xlabel("time (s)")
        axis.set_ylabel("pitch (deg)")
        axis.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        axis.set_title(title, loc="left", fontsize=9, pad=22)
    return figure


def pitch_phase_figure(simulations: Mapping[float, Simulation]) -> "Figure":
    """Fig. 8: pitch and its rate, by frequency."""
    curves = {
        frequency: (np.rad2deg(one.pose[:, 4]), np.rad2deg(one.pose_rate[:, 4]))
        for frequency, one in simulations.items()
    }
    return _phase(curves, "pitch (deg)", "rate of pitch (deg/s)")


def cable_phase_figure(simulations: Mapping[float, Simulation], cable: int) -> "Figure":
    """Fig. 9: mid-span amplitude of a cable and its rate, by frequency."""
    curves = {
        frequency: (
            1e3 * one.cable_offset_m[:, cable - 1],
            one.cable_offset_rate_m_per_s[:, cable - 1],
        )
        for frequency, one in simulations.items()
    }
    return _phase(curves, f"X_w of cable {cable} (mm)", "its rate (m/s)")


def _phase(
    curves: Mapping[float, tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]],
    across: str,
    up: str,
) -> "Figure":
    from matplotlib.figure import Figure

    with _styled():
        figure = Figure(figsize=(4.0 * len(curves), 3.8), layout="constrained")
        axes = figure.subplots(1, len(curves), squeeze=False)[0]
        for axis, letter, (frequency, (value, rate)) in zip(
            axes, "abcdefgh", curves.items(), strict=False
        ):
            axis.plot(value, rate, color=OURS, linewidth=0.4)
            axis.set_title(f"({letter}) {frequency:g} Hz", loc="left")
            axis.set_xlabel(across)
            axis.set_ylabel(up)
    return figure


def _panels(rows: int, size: tuple[float, float]) -> "tuple[Figure, list[Axes]]":
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    return figure, list(figure.subplots(rows, 1, sharex=True, squeeze=False).ravel())


def _band(axis: "Axes", statistics: pd.DataFrame, column: str, colour: str, label: str) -> None:
    frequency = statistics["frequency_hz"]
    axis.fill_between(
        frequency,
        statistics[f"{column}_low"],
        statistics[f"{column}_high"],
        color=colour,
        alpha=0.25,
        linewidth=0,
    )
    axis.plot(frequency, statistics[f"{column}_median"], color=colour, linewidth=1.2, label=label)


def _marks(axis: "Axes", marks: Marks, label: str = "published") -> None:
    if marks:
        frequency, value = zip(*marks, strict=True)
        axis.plot(
            frequency,
            value,
            "o",
            color=OTHER,
            markerfacecolor="none",
            markersize=8,
            label=label,
            zorder=5,
        )
