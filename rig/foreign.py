"""Recordings made by other programs: which columns are what, in which units, and two clocks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from cdpr8.errors import DataError, UsageError
from rig.foreign_table import ForeignTable

Array = NDArray[np.float64]

FORCES = {"N": 1.0, "Newton": 1.0, "mN": 1e-3, "daN": 10.0, "kN": 1e3, "KN": 1e3, "MN": 1e6}
"""Units a table may say its forces are in, in N."""

TIMES = {"s": 1.0, "sec": 1.0, "Sek": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0}
"""Units a table may say its times are in, in s."""

OTHERS = frozenset(
    {
        *(
            "V",
            "mV",
            "mV/V",
            "V/V",
            "A",
            "mA",
            "%",
            "kg",
            "g",
            "t",
            "lb",
            "lbf",
            "Pa",
            "kPa",
            "bar",
        ),
        *("m", "cm", "mm", "µm", "µm/m", "um/m", "°", "°C", "K", "Hz", "h", "d"),
    }
)
"""Units of other things: a column in one of them is not what it is taken for."""


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
        time, cables = None, dict[int, str]()
        for part in text.split(","):
            key, equals, column = (word.strip() for word in part.partition("="))
            if not equals or not column:
                raise _bad_map(text, f"{part.strip()!r} is no key=column")
            if key == "time" and time is not None:
                raise _bad_map(text, "it names the time twice")
            if key.isdecimal() and int(key) in cables:
                raise _bad_map(text, f"it names cable {int(key)} twice")
            if column == time or column in cables.values():
                raise _bad_map(text, f"the column {column!r} is given twice")
            if key == "time":
                time = column
            elif key.isdecimal() and 1 <= int(key) <= CABLES:
                cables[int(key)] = column
            else:
                raise _bad_map(text, f"{key!r} is neither `time` nor a cable")
        if time is None or not cables:
            raise _bad_map(text, "it names no time" if time is None else "it names no cable")
        return cls(time, cables)


def times_s(table: ForeignTable, key: str, where: str) -> Array:
    """The column of times, shape (rows,), in s.

    Parameters
    ----------
    table, key, where
        Its column, by name or number, and the file's name.

    Raises
    ------
    DataError
        It holds no time, is in another unit, or runs backwards.
    """
    times = table.column(key, where) * _factor(table, key, where, TIMES)
    known = np.flatnonzero(np.isfinite(times))
    if not len(known):
        raise DataError(f"the column {key!r} holds no time", where=where)
    backwards = np.flatnonzero(np.diff(times[known]) < 0.0)
    if len(backwards):
        before, row = known[backwards[0]], known[backwards[0] + 1]
        line = f":{table.lines[row]}" if table.lines else ""
        raise DataError(
            f"the time runs backwards: {times[row]:g} s after {times[before]:g} s",
            where=f"{where}{line}",
            allowed="rows in the order of their time",
            remedy="where two measurements follow each other, make a table of each",
        )
    return times


def forces_n(table: ForeignTable, key: str, where: str) -> Array:
    """A column of tensions, shape (rows,), in N.

    Raises
    ------
    DataError
        It holds no number, or the table says that it is in the unit of something else.
    """
    forces = table.column(key, where) * _factor(table, key, where, FORCES)
    if not np.isfinite(forces).any():
        raise DataError(f"the column {key!r} holds no number", where=where)
    return forces


def conversions(table: ForeignTable, columns: "ColumnMap", where: str) -> tuple[str, ...]:
    """What is in other units than s and N and is converted, in words."""
    asked = [(columns.time, "s"), *((key, "N") for key in columns.cables.values())]
    units = [(key, table.unit(key, where), to) for key, to in asked]
    return tuple(
        f"{key!r} is in {unit}, and is taken to {to}"
        for key, unit, to in units
        if (FORCES if to == "N" else TIMES).get(unit, 1.0) != 1.0
    )


def _factor(table: ForeignTable, key: str, where: str, units: dict[str, float]) -> float:
    """From what a column is in; where the table does not say, from the first of the units."""
    unit = table.unit(key, where)
    if unit in units:
        return units[unit]
    if unit in OTHERS or unit in FORCES or unit in TIMES:
        raise DataError(
            f"the column {key!r} is in {unit}",
            where=where,
            allowed=", ".join(units),
            remedy="name another column in --map, or export this one in one of these units",
        )
    return 1.0


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
        if not (np.isfinite(table) & np.isfinite(video)).all():
            raise UsageError("--sync names no time", allowed="TABLE=VIDEO, both in s")
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
