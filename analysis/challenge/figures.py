"""Figures of a scored challenge: confusion matrix and calibration."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.challenge.bars import BINS
from analysis.challenge.intervals import wilson

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg")

HIGH = 0.95
"""From here on a number stands below its dot: above, the frame would cut it."""


def draw_confusion(confusion: Mapping[tuple[str, str], int], stem: Path) -> list[Path]:
    """Concealed down, named across; each row in shares of its cases.

    Parameters
    ----------
    confusion
        (concealed, named) -> how often.
    stem
        Path without suffix.

    Returns
    -------
    list of Path
        What was written.
    """
    from matplotlib.figure import Figure

    down = sorted({pair[0] for pair in confusion})
    across = [name for name in down if any(pair[1] == name for pair in confusion)]
    across += sorted({pair[1] for pair in confusion} - set(down))
    counts = np.zeros((len(down), len(across)))
    for (concealed, named), count in confusion.items():
        counts[down.index(concealed), across.index(named)] = count
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    size = (2.5 + 0.24 * len(across), 2.0 + 0.2 * len(down))
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.add_subplot()
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    axes.set_xticks(range(len(across)), across, rotation=90, fontsize=7)
    axes.set_yticks(range(len(down)), down, fontsize=7)
    axes.set_xlabel("named")
    axes.set_ylabel("concealed")
    for row, column in zip(*np.nonzero(counts), strict=True):
        dark = shares[row, column] > 0.55
        text = f"{counts[row, column]:.0f}"
        colour = "white" if dark else "black"
        axes.text(column, row, text, ha="center", va="center", fontsize=6, color=colour)
    return _saved(figure, stem)


def draw_calibration(pairs: Sequence[Sequence[float]], stem: Path) -> list[Path]:
    """Hit rate over stated probability, ten bins with their intervals.

    Parameters
    ----------
    pairs
        Probability stated, and 1 where it was right.
    stem
        Path without suffix.

    Returns
    -------
    list of Path
        What was written.
    """
    from matplotlib.figure import Figure

    values = np.asarray(pairs, dtype=float)
    bins = np.minimum((values[:, 0] * BINS).astype(int), BINS - 1)
    figure = Figure(figsize=(4.2, 4.0), layout="constrained")
    axes = figure.add_subplot()
    axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    for number in np.unique(bins):
        chosen = values[bins == number]
        hits, of = int(chosen[:, 1].sum()), len(chosen)
        low, high = wilson(hits, of)
        x, y = chosen[:, 0].mean(), hits / of
        bars = [[max(y - low, 0.0)], [max(high - y, 0.0)]]
        axes.errorbar([x], [y], yerr=bars, fmt="o", color="tab:blue", capsize=2)
        beside = (5, 3) if y < HIGH else (5, -9)
        axes.annotate(str(of), (x, y), xytext=beside, textcoords="offset points", fontsize=7)
    axes.set_xlabel("probability stated")
    axes.set_ylabel("share that was right")
    axes.set_xlim(0, 1.06)
    axes.set_ylim(0, 1.02)
    return _saved(figure, stem)


def _saved(figure: "Figure", stem: Path) -> list[Path]:
    from matplotlib import rc_context

    paths = [stem.with_suffix(suffix) for suffix in SUFFIXES]
    for path in paths:
        # The same bytes for the same score: neither date nor random identifiers.
        metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
        with rc_context({"svg.hashsalt": "cdpr8"}):
            figure.savefig(path, dpi=150, metadata=metadata)
    return paths
