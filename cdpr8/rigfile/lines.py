"""Where a key of a TOML file stands: tomllib gives values without lines."""

import re

_TABLE = re.compile(r"^\s*\[(\[)?\s*([^\[\]]+?)\s*\]\]?\s*(#.*)?$")
_KEY = re.compile(r"""^\s*(?:"([^"]+)"|'([^']+)'|([A-Za-z0-9_.-]+))\s*=""")

Location = tuple[str | int, ...]


def key_lines(text: str) -> dict[Location, int]:
    """Line number (from 1) of every table and key of a TOML text.

    Parameters
    ----------
    text
        A TOML document; keys inside inline tables stand at the line of their table.

    Returns
    -------
    dict
        From a location such as ``("cable", 2, "base_m")`` to its line; array-of-table indices
        count from 0.
    """
    found: dict[Location, int] = {}
    counts: dict[Location, int] = {}
    table: Location = ()
    for number, line in enumerate(text.splitlines(), start=1):
        if header := _TABLE.match(line):
            parts = tuple(part.strip().strip("\"'") for part in header[2].split("."))
            table = (*_with_indices(parts[:-1], counts), parts[-1])
            if header[1]:
                counts[table] = counts.get(table, -1) + 1
                table += (counts[table],)
            found.setdefault(table, number)
        elif key := _KEY.match(line):
            name = key[1] or key[2] or key[3]
            found.setdefault(table + tuple(name.split(".")), number)
    return found


def _with_indices(parts: tuple[str, ...], counts: dict[Location, int]) -> Location:
    """The location of a sub-table: inside the newest element of each array of tables."""
    location: Location = ()
    for part in parts:
        location += (part,)
        if location in counts:
            location += (counts[location],)
    return location


def nearest_line(lines: dict[Location, int], location: Location) -> int | None:
    """The line of `location`, or of the innermost table round it that the text has."""
    for length in range(len(location), 0, -1):
        if location[:length] in lines:
            return lines[location[:length]]
    return None
