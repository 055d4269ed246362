"""The table of a scored challenge for a terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from analysis.challenge.bars import Row
from analysis.challenge.report import cells_of

if TYPE_CHECKING:
    from rich.table import Table


def printed(rows: Sequence[Row]) -> "Table":
    """One figure a line and kind: value with interval, bar, met or not.

    Parameters
    ----------
    rows
        From `analysis.challenge.bars`.
    """
    from rich.table import Table

    table = Table("figure", "runs", "value (95 % interval; cases)", "bar", "")
    for row in rows:
        value, bar, verdict = cells_of(row)
        table.add_row(row.figure, row.kind, value, bar, verdict.strip("*"))
    return table
