"""All kept sets together: one page with their figures, and each set beside the others."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analysis.challenge.bars import KINDS, Row, rows
from analysis.challenge.grade import Grade
from analysis.challenge.kept import Kept
from analysis.challenge.report import calibration, shown, table

HEADER = """# Proof on concealed data: all sets kept

<!-- written by `analysis challenge pool --report`; run it again, do not edit this page -->

Every set was diagnosed blind, by the engine of its day, and is graded as sets are graded now. What
went wrong in one was studied for the next: of the engine as it is, the latest sets tell most.
"""

COLUMNS = (
    "false alarm where nothing is concealed",
    "true effect inside the reported set",
    "named alone and right, of those that can be told apart",
    "both of two effects found",
    "right cables, where it names cables",
    "error of the named parameter, median",
    "held-out error after, in noise, median",
)
"""Figures that the table of sets has."""


def pooled(sets: Sequence[Kept]) -> tuple[Row, ...]:
    """The figures of all sets together.

    Parameters
    ----------
    sets
        Kept sets.
    """
    return tuple(rows([one for each in sets for one in done(each)]))


def done(kept: Kept) -> list[Grade]:
    """Its cases that were diagnosed."""
    return [one for one in kept.grades if one.verdict != "missing"]


def page(sets: Sequence[Kept]) -> str:
    """The page, in Markdown, but for its figure.

    Parameters
    ----------
    sets
        Kept sets, the oldest first.
    """
    count = sum(len(done(one)) for one in sets)
    parts = [
        HEADER.rstrip("\n"),
        f"{count} cases in {len(sets)} sets.",
        "## Figures\n\nWith 95 % intervals (Wilson for shares, bootstrap over cases for the rest). "
        "`open`: the figure misses its bar, and its interval does not.",
        table(pooled(sets)),
        "## Set by set, the latest first",
        *[text for kind in KINDS if (text := sets_table(sets, kind))],
    ]
    return "\n\n".join(parts) + "\n"


def sets_table(sets: Sequence[Kept], kind: str) -> str:
    """One set a line; empty where no set has cases of the kind."""
    heads = ["set", "engine", "false alarms", "in the set", "alone", "both of two", "cables",
             "number", "held out", "median (longest)"]  # fmt: skip
    lines = [
        f"**{kind.capitalize()}s**\n",
        "| " + " | ".join(heads) + " |",
        "|---" * len(heads) + "|",
    ]
    for one in reversed(sets):
        grades = [grade for grade in done(one) if grade.kind == kind]
        if not grades:
            continue
        figures = {row.figure: row for row in rows(grades) if row.kind == kind}
        cells = [_cell(figures[name]) for name in COLUMNS]
        times = [grade.seconds for grade in grades]
        took = f"{np.median(times):.0f} s ({max(times):.0f})"
        name = f"{one.plant} {one.seed}"
        lines.append("| " + " | ".join([name, one.engine, *cells, took]) + " |")
    return "\n".join(lines) if len(lines) > 3 else ""


def _cell(row: Row) -> str:
    """A share as a count, a median as it is."""
    if row.value is None:
        return ""
    if row.counts:
        return f"{round(row.value * row.of)} of {row.of}"
    return shown(row.value, row.percent)


def write_page(sets: Sequence[Kept], path: Path) -> list[Path]:
    """Write the page, its figure beside it in `figures/`.

    Returns
    -------
    list of Path
        What was written.
    """
    calibrated, drawn = calibration([one for each in sets for one in done(each)], path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page(sets) + calibrated, encoding="utf-8")
    return [path, *drawn]
