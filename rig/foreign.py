"""Recordings made by other programs: a video and a table of tensions, on two clocks, into a run.

catman, and most others, export a table as text: some lines of heading, a line of names, perhaps one
of units, then numbers; with tab, semicolon or comma between them, and a decimal point or comma.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from cdpr8.errors import DataError, UsageError

Array = NDArray[np.float64]
_NUMBER = re.compile(r"^[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?$")


@dataclass(frozen=True)
class ForeignTable:
    """A table of numbers as another program wrote it.

    Attributes
    ----------
    names
        Of the columns, in order.
    values
        Shape (rows, columns); NaN where a cell was empty.
    """

    names: tuple[str, ...]
    values: Array

    def column(self, key: str, where: str, option: str = "--map") -> Array:
        """A column by its name, or by its number from 1.

        Raises
        ------
        UsageError
            There is none.
        """
        if key in self.names:
            return self.values[:, self.names.index(key)]
        near = [name for name in self.names if name.lower().startswith(key.lower())]
        if len(near) == 1:
            return self.values[:, self.names.index(near[0])]
        if key.isdecimal() and 1 <= int(key) <= len(self.names):
            return self.values[:, int(key) - 1]
        raise UsageError(
            f"{option} names the column {key!r}, which the table lacks",
            allowed=", ".join(
                f"{number}: {name}" for number, name in enumerate(self.names, start=1)
            ),
            where=where,
        )


def read_foreign_table(path: Path) -> ForeignTable:
    """Read a text table, whatever stands between and above its numbers.

    Raises
    ------
    DataError
        The file cannot be read, or holds no table of numbers.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", where=str(path)) from None
    text = raw.decode("utf-8-sig") if _is_utf8(raw) else raw.decode("cp1252", "replace")
    lines = text.splitlines()
    for separator in ("\t", ";", ","):
        rows = [[cell.strip().strip('"') for cell in line.split(separator)] for line in lines]
        first = _first_numeric(rows)
        if first is not None and len(rows[first]) > 1:
            return _table(rows, first, path, decimal_comma=separator != ",")
    raise DataError(
        "holds no table of numbers",
        where=str(path),
        allowed="columns of numbers with tab, semicolon or comma between them, at least two",
        remedy="export it as ASCII with one time column",
    )


def _is_utf8(raw: bytes) -> bool:
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _first_numeric(rows: list[list[str]]) -> int | None:
    """The first row of numbers that is followed by one of the same width, or ends the file."""
    for at, row in enumerate(rows):
        if _numeric(row) and (at + 1 == len(rows) or len(rows[at + 1]) == len(row)):
            return at
    return None


def _numeric(row: list[str]) -> bool:
    cells = [cell for cell in row if cell]
    return bool(cells) and all(_NUMBER.match(cell) for cell in cells)


def _table(rows: list[list[str]], first: int, path: Path, *, decimal_comma: bool) -> ForeignTable:
    width = len(rows[first])
    # The names stand above the numbers; a line of units between them is none of names.
    headings = [row for row in rows[:first] if len(row) == width and any(row)]
    names = headings[0] if headings else [str(number) for number in range(1, width + 1)]
    values = []
    for line, row in enumerate(rows[first:], start=first + 1):
        if not any(row):
            continue
        if len(row) != width or not _numeric(row):
            raise DataError(
                f"is no row of {width} numbers: {row[:4]}",
                where=f"{path}:{line}",
                remedy="remove the line; nothing is repaired silently",
            )
        values.append([_value(cell, decimal_comma) for cell in row])
    return ForeignTable(tuple(names), np.array(values, dtype=float))


def _value(cell: str, decimal_comma: bool) -> float:
    if not cell:
        return float("nan")
    return float(cell.replace(",", ".") if decimal_comma else cell)


@dataclass(frozen=True)
class ColumnMap:
    """Which column is the time and which are the cables.

    Attributes
    ----------
    time
        Name or number.
    cables
        Cable -> name or number.
    """

    time: str
    cables: dict[int, str]

    @classmethod
    def parse(cls, text: str) -> "ColumnMap":
        """Read ``time=Time,1=Force 1,2=Force 2``: cables left out were not measured.

        Raises
        ------
        UsageError
            It is none, or names no time or no cable.
        """
        time, cables = None, {}
        for part in text.split(","):
            key, equals, column = (word.strip() for word in part.partition("="))
            if not equals or not column:
                raise _bad_map(text, f"{part.strip()!r} is no key=column")
            if key == "time":
                time = column
            elif key.isdecimal() and 1 <= int(key) <= CABLES:
                cables[int(key)] = column
            else:
                raise _bad_map(text, f"{key!r} is neither `time` nor a cable")
        if time is None or not cables:
            raise _bad_map(text, "it names no time" if time is None else "it names no cable")
        return cls(time, cables)


def _bad_map(text: str, why: str) -> UsageError:
    return UsageError(
        f"--map {text!r}: {why}",
        allowed=f"time=COLUMN,1=COLUMN,... with cables 1 to {CABLES}; "
        "a column is named or numbered from 1",
    )


@dataclass(frozen=True)
class ClockMap:
    """From the video's time to the table's: t = offset + rate * t_video.

    Attributes
    ----------
    offset_s
        The table's time at the video's zero.
    rate
        1, or as two common events tell.
    """

    offset_s: float = 0.0
    rate: float = 1.0

    @classmethod
    def of(cls, taps: list[tuple[float, float]]) -> "ClockMap":
        """From events seen in both, as (time in the table, time in the video).

        One gives the offset; two or more give the rate as well.

        Raises
        ------
        UsageError
            Two events at the same time of the video, or a rate that no two clocks have.
        """
        if not taps:
            return cls()
        table, video = np.array(taps, dtype=float).T
        if len(taps) == 1:
            return cls(float(table[0] - video[0]))
        if np.ptp(video) == 0.0:
            raise UsageError(
                "--sync names one time of the video twice", allowed="events some seconds apart"
            )
        rate, offset = np.polyfit(video, table, 1)
        if abs(rate - 1.0) > MOST_RATE_ERROR:
            raise UsageError(
                f"--sync makes the video's clock run {1e2 * (rate - 1.0):+.2f} % off the table's",
                allowed=f"up to {1e2 * MOST_RATE_ERROR:g} %",
                remedy="check which event is which; TABLE=VIDEO, both in s",
            )
        return cls(float(offset), float(rate))

    def to_table_s(self, video_s: float) -> float:
        """A time of the video on the table's clock."""
        return self.offset_s + self.rate * video_s


MOST_RATE_ERROR = 0.01
"""Clocks that differ by more than this were matched by the wrong events."""
