"""The ranking of rivals: how far each explanation is behind the best, and its probability."""

from collections.abc import Mapping
from textwrap import fill
from typing import TYPE_CHECKING, Any

from analysis.diagnosis.figure_style import Look
from analysis.diagnosis.tables import probability
from analysis.diagnosis.titles import short

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = 9
"""Rivals that are drawn."""


def ranking_figure(said: Mapping[str, Any], look: Look) -> "Figure":
    """Log odds of every explanation against the best one.

    The bar reaches from how the evidence counts (tempered, since laws are never quite the
    library's) to what it says at face value; the dot is what counts.

    Parameters
    ----------
    said
        The statement, with its ranking.
    look
        Colours and width.
    """
    from matplotlib.figure import Figure

    ranked = said["ranking"]
    rows = ranked[:SHOWN] + [one for one in ranked[SHOWN:] if not one["effects"] or one["chosen"]]
    figure = Figure(
        figsize=(look.width, (0.75 if look.narrow else 0.5) * len(rows) + 1.1), layout="constrained"
    )
    axes = figure.subplots()
    axes.set_xscale("symlog", linthresh=10.0, linscale=1.0)
    far = max(-min(one["log_odds"] for one in rows), 10.0)
    for i, one in enumerate(rows):
        colour = look.after if one["chosen"] else look.before if one["effects"] else look.ink
        low, high = -one["log_odds"], -one["tempered"]
        axes.plot([low, high], [i, i], color=colour, linewidth=3, alpha=0.45,
                  solid_capstyle="butt")  # fmt: skip
        axes.plot(high, i, "o", color=colour, markersize=8)
        axes.text(1.0, i, f" {probability(one['probability'])}", ha="left", va="center",
                  transform=axes.get_yaxis_transform(), fontsize=9)  # fmt: skip
        names = [short(name) for name in one["effects"]] or ["nothing left out"]
        if one["implausible"]:
            names[-1] += ", implausibly"
        weight = "bold" if one["chosen"] else "normal"
        if look.narrow:
            words = fill(" + ".join(names).replace(" at the pulleys +", " +"), 46)
            label = axes.text(
                0.0, i - 0.45, words, transform=axes.get_yaxis_transform(), va="center",
                fontsize=8, weight=weight, linespacing=0.95,
            )  # fmt: skip
            label.set_in_layout(False)
        else:
            axes.text(-0.02, i, "\n".join(names), ha="right", va="center", fontsize=8.5,
                      transform=axes.get_yaxis_transform(), linespacing=0.95,
                      weight=weight)  # fmt: skip
    axes.text(
        1.0,
        -0.85,
        " probability",
        ha="right" if look.narrow else "left",
        transform=axes.get_yaxis_transform(),
        fontsize=9,
    )
    axes.set_yticks(range(len(rows)), [""] * len(rows))
    axes.set_ylim(len(rows) - 0.4, -1.0)
    axes.set_xlim(-2.0, 2.0 * far)
    marks = [0.0, *(10.0**n for n in range(1, 7, 2 if look.narrow else 1) if 10.0**n < far)]
    axes.set_xticks(marks, [f"{one:,.0f}" for one in marks])
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    how = "" if look.narrow else " (dot: as it counts; bar: at face value)"
    axes.set_xlabel(f"log odds behind the best{how}")
    return figure
