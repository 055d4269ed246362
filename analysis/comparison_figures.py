"""Figures like the paper's 11 and 12, and the spectra behind its remark on frequencies."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.compare import SHOWN_CABLES, Comparison, Quantity
from analysis.spectrum import SampleTimes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIMULATED = "#1f5fa8"
MEASURED = "#d1495b"
GRID = "#d8d8d8"

SHOWN_PERIODS = 6
"""Periods in a figure: enough to see the cycles repeat, few enough to see their shape."""

_STYLE: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "svg.hashsalt": "cdpr8",
    "savefig.dpi": 150,
}


def write_figures(comparison: Comparison, folder: Path) -> list[Path]:
    """Write every figure as PNG and SVG.

    Parameters
    ----------
    comparison
        What to draw.
    folder
        Where; made if absent.

    Returns
    -------
    list of Path
        The files.
    """
    import matplotlib as mpl

    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with mpl.rc_context(_STYLE):
        drawings = {f"{comparison.angle.measured.name}": _overlay(comparison, comparison.angle)}
        for cable in SHOWN_CABLES:
            if cable in comparison.tensions:
                drawings[f"tension_{cable}"] = _overlay(comparison, comparison.tensions[cable])
        drawings["all"] = _all_quantities(comparison)
        drawings["spectra"] = _spectra(comparison)
        for name, figure in drawings.items():
            figure.draw_without_rendering()
            figure.set_layout_engine("none")  # laid out once; each format would do it again
            for ending in ("png", "svg"):
                path = folder / f"compare_{name}.{ending}"
                figure.savefig(path, metadata={"Date": None} if ending == "svg" else None)
                written.append(path)
    return written


def _overlay(comparison: Comparison, quantity: Quantity) -> "Figure":
    """Simulated line and measured points over a few periods, the residual below."""
    from matplotlib.figure import Figure

    series = quantity.measured
    first, last = _shown_window(comparison)
    shown = series.within((first, last))
    line = (quantity.simulated_t_s >= first) & (quantity.simulated_t_s <= last)
    residual = shown.value - np.interp(shown.t_s, quantity.simulated_t_s, quantity.simulated)
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1.2))
    above.plot(
        quantity.simulated_t_s[line],
        quantity.simulated[line],
        color=SIMULATED,
        linewidth=1.5,
        label=f"simulated, max {quantity.simulated_amplitude:.2f} {series.unit}",
    )
    above.plot(
        shown.t_s,
        shown.value,
        "o",
        color=MEASURED,
        markersize=3.5 if len(shown.t_s) < 200 else 2.0,
        label=f"measured, max {quantity.measured_amplitude:.2f} {series.unit}",
    )
    above.set_ylabel(f"{_axis_name(series.name)} ({series.unit})")
    above.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    below.axhspan(-2 * series.noise, 2 * series.noise, color=GRID)
    below.plot(shown.t_s, residual, ".-", color=MEASURED, markersize=3, linewidth=0.6)
    below.set_ylabel(f"measured −\nsimulated ({series.unit})")
    below.set_xlabel("time (s)")
    below.set_title("residual; grey: noise, ±2 sigma", loc="right", fontsize=8)
    kind = " (reconstruction)" if comparison.run.start.reconstruction else ""
    figure.suptitle(
        f"{comparison.run.name}{kind}: {_axis_name(series.name)}, relative error of the "
        f"amplitude {quantity.relative_error:.2%}",
        fontsize=11,
    )
    return figure


def _shown_window(comparison: Comparison) -> tuple[float, float]:
    """The first periods of the steady window."""
    first, last = comparison.window_s
    periods = SHOWN_PERIODS / comparison.run.start.excitation.frequency_hz
    return first, min(first + periods, last)


def _panels(quantities: Sequence[Quantity]) -> "tuple[Figure, list[Axes]]":
    """A figure with a panel for each quantity, three in a row."""
    from matplotlib.figure import Figure

    rows = (len(quantities) + 2) // 3
    figure = Figure(figsize=(11.0, 2.5 * rows), layout="constrained")
    panels = list(figure.subplots(rows, 3, squeeze=False).ravel())
    for panel in panels[len(quantities) :]:
        panel.set_visible(False)
    return figure, panels[: len(quantities)]


def _all_quantities(comparison: Comparison) -> "Figure":
    """Every quantity over a few periods: the pitch and all eight cables on one sheet."""
    window = _shown_window(comparison)
    figure, panels = _panels(comparison.quantities)
    for panel, quantity in zip(panels, comparison.quantities, strict=True):
        shown = quantity.measured.within(window)
        line = (quantity.simulated_t_s >= window[0]) & (quantity.simulated_t_s <= window[1])
        panel.plot(
            quantity.simulated_t_s[line],
            quantity.simulated[line],
            color=SIMULATED,
            linewidth=1.0,
            label="simulated",
        )
        panel.plot(shown.t_s, shown.value, ".", color=MEASURED, markersize=2.0, label="measured")
        panel.set_title(f"{quantity.measured.name}: {quantity.relative_error:.2%}", fontsize=10)
        panel.set_xlabel("time (s)")
        panel.set_ylabel(quantity.measured.unit)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    return figure


def _spectra(comparison: Comparison) -> "Figure":
    """Amplitude spectra of every quantity, simulated and measured at the same sample times."""
    figure, panels = _panels(comparison.quantities)
    for panel, quantity in zip(panels, comparison.quantities, strict=True):
        steady = quantity.measured.within(comparison.window_s)
        times = SampleTimes(steady.t_s)
        simulated = np.interp(steady.t_s, quantity.simulated_t_s, quantity.simulated)
        floor = times.noise_level(quantity.measured.noise)
        panel.semilogy(
            times.frequency_hz,
            times.amplitude(simulated),
            color=SIMULATED,
            linewidth=1.0,
            label="simulated",
        )
        panel.semilogy(
            times.frequency_hz,
            times.amplitude(steady.value),
            color=MEASURED,
            linewidth=0.8,
            label="measured",
        )
        panel.axhline(floor, color="#707070", linestyle=":", linewidth=1.0, label="noise level")
        panel.set_ylim(bottom=floor / 10)
        panel.set_title(quantity.measured.name, fontsize=10)
        panel.set_xlabel("frequency (Hz)")
        panel.set_ylabel(f"amplitude ({quantity.measured.unit})")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=3)
    return figure


def _axis_name(name: str) -> str:
    return f"{name} angle" if name in {"roll", "pitch", "yaw"} else f"variation of {name}"
