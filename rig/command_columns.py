"""What the columns of a winch controller's log mean, and reading its lines leniently."""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from cdpr8 import CABLES
from cdpr8.errors import DataError, UsageError
from cdpr8.runfolder.tables import COMMAND
from rig.foreign_table import ForeignTable

QUANTITIES: Mapping[str, tuple[str, float]] = {
    "commanded_m": ("commanded_m", 1.0),
    "commanded_mm": ("commanded_m", 1e-3),
    "measured_m": ("measured_m", 1.0),
    "measured_mm": ("measured_m", 1e-3),
    "commanded_deg": ("commanded_deg", 1.0),
    "commanded_rad": ("commanded_deg", math.degrees(1.0)),
    "measured_deg": ("measured_deg", 1.0),
    "measured_rad": ("measured_deg", math.degrees(1.0)),
}
"""What a column may hold: the column of command.csv, and the factor from one to the other."""

TIMES = {"time": 1.0, "time_s": 1.0, "time_ms": 1e-3}
"""What the time column may count, in s."""

DEFAULT = "commanded_m"
SEPARATORS = ("\t", ";", ",", None)
"""None: blanks."""

_ALLOWED = (
    "time=COLUMN (or time_ms),1=COLUMN,2.measured_deg=COLUMN,... with cables "
    f"1 to {CABLES} and one of {', '.join(QUANTITIES)} "
    f"({DEFAULT} where none is named); a column is named or numbered from 1"
)


@dataclass(frozen=True)
class CommandColumns:
    """Which column is the time, and which hold what of which cable.

    Attributes
    ----------
    time
        Name or number; None where the log has no clock of its own.
    cables
        (Cable, quantity) -> name or number. Empty: the log has the columns of command.csv itself,
        one row a cable.
    text
        As it was given.
    time_factor
        From the time column to s.
    """

    time: str | None
    cables: Mapping[tuple[int, str], str]
    text: str
    time_factor: float = 1.0

    @classmethod
    def parse(cls, text: str | None) -> "CommandColumns":
        """Read ``time=t,1=L1,2=L2,1.measured_deg=E1``.

        Raises
        ------
        UsageError
            It is none, or names no cable.
        """
        if text is None:
            names = ", ".join(COMMAND.names)
            return cls(None, {}, f"the columns of command.csv ({names})")
        time, factor, cables = None, 1.0, {}
        for part in text.split(","):
            key, equals, column = (word.strip() for word in part.partition("="))
            cable, _, quantity = key.partition(".")
            if not equals or not column:
                raise _bad_map(text, f"{part.strip()!r} is no key=column")
            if key in TIMES:
                time, factor = column, TIMES[key]
            elif not cable.isdecimal() or not 1 <= int(cable) <= CABLES:
                raise _bad_map(text, f"{key!r} is neither `time` nor a cable")
            elif (quantity or DEFAULT) not in QUANTITIES:
                raise _bad_map(text, f"{quantity!r} is no quantity")
            else:
                cables[int(cable), quantity or DEFAULT] = column
        if not cables:
            raise _bad_map(text, "it names no cable")
        return cls(time, cables, text, factor)


def _bad_map(text: str, why: str) -> UsageError:
    return UsageError(f"--command-map {text!r}: {why}", allowed=_ALLOWED)


@dataclass(frozen=True)
class Command:
    """What one line says of one cable.

    Attributes
    ----------
    cable
        1 to 8.
    values
        Column of command.csv -> value, in m and deg.
    log_s
        The log's own time, None where it has none.
    """

    cable: int
    values: Mapping[str, float]
    log_s: float | None


class LineReader:
    """Reads one line after the other; the first lines may be headings.

    Parameters
    ----------
    columns
        What the lines hold.
    """

    def __init__(self, columns: CommandColumns) -> None:
        self._columns = columns
        self._headings: list[str] = []
        self._separator: str | None = None
        self._places: dict[str, int] | None = None
        self._width = 0

    def heading(self, line: bytes) -> None:
        """Take a line that was there before; only names are of use.

        Raises
        ------
        UsageError
            The map names a column that the log lacks.
        """
        with suppress(DataError):
            self.read(line)

    def read(self, line: bytes) -> tuple[Command, ...]:
        """What a line says; nothing where it is a heading or empty.

        Raises
        ------
        DataError
            It is no row of the log.
        UsageError
            The map names a column that the log lacks.
        """
        text = line.decode("utf-8-sig", "replace").strip()
        if not text:
            return ()
        if self._places is None and not self._settle(text):
            self._headings.append(text)
            return ()
        cells = _split(text, self._separator)
        if len(cells) != self._width:
            raise DataError(
                f"the line {text[:60]!r} has {len(cells)} columns, and the log {self._width}"
            )
        return self._commands(cells, text)

    def _settle(self, text: str) -> bool:
        """Find separator and columns at the first line of numbers; False for a heading."""
        for separator in SEPARATORS:
            cells = _split(text, separator)
            if len(cells) < 2:
                continue
            numbers = sum(_number(cell, separator) is not None for cell in cells)
            if numbers < len([cell for cell in cells if cell]) or not numbers:
                continue
            self._separator, self._width = separator, len(cells)
            self._places = self._find(separator, len(cells))
            return True
        return False

    def _find(self, separator: str | None, width: int) -> dict[str, int]:
        """Where each wanted column stands."""
        split = (_split(line, separator) for line in self._headings)
        names = next((cells for cells in split if len(cells) == width), [])
        names = names or [str(number) for number in range(1, width + 1)]
        if not self._columns.cables:
            here = {name: names.index(name) for name in COMMAND.names if name in names}
            if "cable" not in here:
                raise UsageError(
                    f"the command log's columns are {', '.join(names)}",
                    allowed=self._columns.text,
                    remedy="say with --command-map which column is what",
                )
            return here
        wanted = [*self._columns.cables.values()]
        wanted += [] if self._columns.time is None else [self._columns.time]
        table = ForeignTable(tuple(names), np.arange(width, dtype=float)[None, :])
        return {key: int(table.column(key, "command log", "--command-map")[0]) for key in wanted}

    def _commands(self, cells: list[str], text: str) -> tuple[Command, ...]:
        places = self._places or {}

        def value(key: str) -> float | None:
            cell = cells[places[key]]
            number = _number(cell, self._separator)
            if number is None and cell:
                raise DataError(f"{cell!r} in the line {text[:60]!r} is no number")
            return number

        columns = self._columns
        if not columns.cables:
            cable = value("cable")
            if cable is None or cable not in range(1, CABLES + 1):
                raise DataError(f"the line {text[:60]!r} names no cable")
            time = next((name for name in ("log_s", "t_s") if name in places), None)
            values = {name: value(name) for name in QUANTITIES if name in places}
            some = {name: each for name, each in values.items() if each is not None}
            return (Command(int(cable), some, None if time is None else value(time)),)
        log_s = None if columns.time is None else value(columns.time)
        if columns.time is not None and log_s is None:
            raise DataError(f"the line {text[:60]!r} has no time")
        if log_s is not None:
            log_s *= columns.time_factor
        found: dict[int, dict[str, float]] = {}
        for (cable_, quantity), key in columns.cables.items():
            if (number := value(key)) is not None:
                name, factor = QUANTITIES[quantity]
                found.setdefault(cable_, {})[name] = factor * number
        return tuple(Command(cable_, values_, log_s) for cable_, values_ in sorted(found.items()))


def _split(text: str, separator: str | None) -> list[str]:
    return [cell.strip().strip('"') for cell in text.split(separator)]


def _number(cell: str, separator: str | None) -> float | None:
    """A number, with a decimal comma where no comma parts columns; or a date and time, in s."""
    spelled = cell if separator == "," else cell.replace(",", ".")
    with suppress(ValueError):
        number = float(spelled)
        return number if math.isfinite(number) else None
    try:
        return datetime.fromisoformat(cell).timestamp()
    except ValueError:
        return None


def read_command_table(path: Path, columns: CommandColumns) -> list[Command]:
    """Read a whole log that another program wrote.

    Raises
    ------
    DataError
        It cannot be read, a row is not understood, or no row has a time.
    UsageError
        The map names a column that the log lacks.
    """
    try:
        lines = path.read_bytes().splitlines()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", where=str(path)) from None
    reader, found = LineReader(columns), list[Command]()
    for number, line in enumerate(lines, start=1):
        try:
            found += reader.read(line)
        except DataError as fault:
            raise DataError(
                fault.what,
                where=f"{path}:{number}",
                remedy="remove the line; nothing is repaired silently",
            ) from None
    if not found or any(each.log_s is None for each in found):
        raise DataError(
            "holds no rows with a time" if found else "holds no row",
            where=str(path),
            allowed=columns.text,
            remedy="say with --command-map which column is the time: time=COLUMN",
        )
    return found
