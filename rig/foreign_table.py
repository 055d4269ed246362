"""Tables of numbers as other programs write them, read without guessing.

catman, and most others, export a table as text: some lines of heading, a line of names, perhaps one
of units, then numbers; with tab, semicolon, comma or blanks between them, and a decimal point or
comma. What could be read in two ways is refused.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError, UsageError
from rig.foreign_time import date_s

Array = NDArray[np.float64]

SEPARATORS = ("\t", ";", ",", None)
"""None: blanks."""

MISSING = frozenset({"", "nan", "n/a", "-", "--", "---"})
"""What stands where a value is missing, in small letters."""

_NUMBER = re.compile(r"^[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?$")
_UNIT_IN_NAME = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]$")
_MARKS = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig"))
"""How a text in Unicode may begin, and its encoding."""


@dataclass(frozen=True)
class ForeignTable:
    """A table of numbers as another program wrote it.

    Attributes
    ----------
    names
        Of the columns, in order.
    values
        Shape (rows, columns); NaN where a cell was empty. A column of dates or times of day is in
        s from its first row.
    lines
        Of each row, its number in the file from 1; empty where there is none.
    units
        Of each column, as written below its name or behind it in brackets, "" where nothing is.
    """

    names: tuple[str, ...]
    values: Array
    lines: tuple[int, ...] = ()
    units: tuple[str, ...] = ()

    def column(self, key: str, where: str, option: str = "--map") -> Array:
        """A column by its name, the start of its name, or its number from 1.

        Raises
        ------
        UsageError
            There is none.
        """
        return self.values[:, self.place(key, where, option)]

    def unit(self, key: str, where: str) -> str:
        """What the table says a column is in, "" where it says nothing."""
        return self.units[self.place(key, where)] if self.units else ""

    def place(self, key: str, where: str, option: str = "--map") -> int:
        """Where a column stands, from 0.

        Raises
        ------
        UsageError
            There is none, or the name begins as several do.
        """
        if key in self.names:
            return self.names.index(key)
        near = [name for name in self.names if name.lower().startswith(key.lower())]
        if len(near) == 1:
            return self.names.index(near[0])
        if key.isdecimal() and 1 <= int(key) <= len(self.names):
            return int(key) - 1
        what = f"{len(near)} columns begin so" if near else "which the table lacks"
        raise UsageError(
            f"{option} names the column {key!r}, {what}",
            allowed=", ".join(
                f"{number}: {name}" for number, name in enumerate(self.names, start=1)
            ),
            where=where,
        )


def read_foreign_table(path: Path) -> ForeignTable:
    """Read a text table, whatever stands between and above its numbers.

    Parameters
    ----------
    path
        In UTF-8, UTF-16 with its mark, or Windows' western encoding.

    Raises
    ------
    DataError
        The file cannot be read, holds no table of numbers, or one that reads in two ways.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", where=str(path)) from None
    lines = _text(raw).splitlines()
    for separator in SEPARATORS:
        rows = [split_cells(line, separator) for line in lines]
        first = _first_numeric(rows)
        if first is not None and len(rows[first]) > 1:
            if separator == ",":
                _require_no_decimal_comma(rows, first, path)
            return _table(rows, first, path, decimal_comma=separator != ",")
    raise DataError(
        "holds no table of numbers",
        where=str(path),
        allowed="two columns of numbers or more; tab, semicolon, comma or blanks between them",
        remedy="export it as ASCII with one time column",
    )


def split_cells(text: str, separator: str | None) -> list[str]:
    """The cells of a line; None parts at blanks."""
    return [cell.strip().strip('"') for cell in text.split(separator)]


def _text(raw: bytes) -> str:
    for mark, encoding in _MARKS:
        if raw.startswith(mark):
            return raw.decode(encoding, "replace")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("cp1252", "replace")


def _first_numeric(rows: list[list[str]]) -> int | None:
    """The first row of numbers that is followed by one of the same width, or ends the file."""
    for at, row in enumerate(rows):
        if _numeric(row) and (at + 1 == len(rows) or len(rows[at + 1]) == len(row)):
            return at
    return None


def _numeric(row: Sequence[str]) -> bool:
    """Whether a row holds numbers and dates, at least one number, and nothing else."""
    return all(map(_readable, row)) and any(map(_NUMBER.match, row))


def _readable(cell: str) -> bool:
    missing = cell.lower() in MISSING
    return missing or _NUMBER.match(cell) is not None or date_s(cell) is not None


def _require_no_decimal_comma(rows: list[list[str]], first: int, path: Path) -> None:
    """Refuse commas that part columns and decimals alike: what is what cannot be told."""
    table = [row for row in rows[first:] if any(row)]
    width = len(table[0])
    if width % 2 or any("." in cell for row in table for cell in row):
        return
    named = {len(row) for row in rows[:first] if sum(map(bool, row)) > 1}
    decimals = {len(cell) for row in table for cell in row[1::2]}
    if width // 2 in named or (width not in named and len(decimals) == 1 and min(decimals) > 1):
        raise DataError(
            f"has commas between its columns and in its numbers: {','.join(table[0])[:40]!r}",
            where=f"{path}:{first + 1}",
            allowed="a decimal point, or tab, semicolon or blanks between the columns",
            remedy="export it with another separator",
        )


def _table(rows: list[list[str]], first: int, path: Path, *, decimal_comma: bool) -> ForeignTable:
    width = len(rows[first])
    numbered = [(line, row) for line, row in enumerate(rows[first:], start=first + 1) if any(row)]
    for line, row in numbered:
        if len(row) != width or not all(_readable(cell) for cell in row):
            raise DataError(
                f"is no row of {width} numbers: {row[:4]}",
                where=f"{path}:{line}",
                remedy="remove the line; nothing is repaired silently",
            )
    # Some programs end each line with a separator: a column without name or number.
    while width > 1 and not any(row[width - 1] for _, row in numbered):
        width -= 1
    # The names stand above the numbers; a line of units between them is none of names.
    headings = [cells for row in rows[:first] if len(cells := _trimmed(row, width)) == width]
    names = headings[0] if headings else [str(number) for number in range(1, width + 1)]
    below = headings[1] if len(headings) > 1 else [""] * width
    found = (_UNIT_IN_NAME.search(name) for name in names)
    units = [
        unit or (match.group(1) if match else "") for unit, match in zip(below, found, strict=True)
    ]
    values = np.array(
        [[_value(cell, decimal_comma) for cell in row[:width]] for _, row in numbered]
    )
    for place, cell in enumerate(numbered[0][1][:width]):
        if not _NUMBER.match(cell):
            values[:, place] -= np.nan_to_num(values[0, place])  # dates count from the first
    return ForeignTable(tuple(names), values, tuple(line for line, _ in numbered), tuple(units))


def _trimmed(row: list[str], width: int) -> list[str]:
    """A heading without the empty cells that stand beyond the table's columns."""
    return row if any(row[width:]) or not any(row) else row[:width]


def _value(cell: str, decimal_comma: bool) -> float:
    if cell.lower() in MISSING:
        return float("nan")
    if _NUMBER.match(cell):
        return float(cell.replace(",", ".") if decimal_comma else cell)
    seconds = date_s(cell)
    return float("nan") if seconds is None else seconds
