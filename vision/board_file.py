"""Board files: what `vision track VIDEO --board FILE` looks for.

A board file is TOML and holds one of two tables. ``[plate]`` as in a rig file (its pose may be left
out; a whole rig file serves too) describes markers whose places relative to each other are known.
``[singles]`` describes markers of which only the size is known::

    [singles]
    dictionary = "DICT_ARUCO_ORIGINAL"
    size_m = 0.05
    ids = [101, 601]      # left out: every marker of the dictionary
    sizes_m = {701 = 0.03}  # markers of another size
"""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from cdpr8.errors import DataError
from cdpr8.rigfile import schema
from vision.plate import Plate, Singles

ALLOWED = (
    "a TOML file with [plate] (dictionary and [plate.grid] or [[plate.marker]], as in a rig file) "
    "or [singles] (dictionary, size_m, ids)"
)

_UNMOUNTED = {"position_m": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "up": [0.0, 1.0, 0.0]}
"""Stands in for the mounting, which a board in the hand does not have."""


class _Singles(schema.Section):
    dictionary: str
    size_m: float = Field(gt=0.0)
    ids: tuple[int, ...] | None = None
    sizes_m: dict[int, float] = Field(default_factory=dict)


def load_board(path: Path) -> Plate | Singles:
    """Read a board file.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    DataError
        The file is missing, is not TOML, or describes no board.
    """
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(
            f"the board file cannot be read: {error.strerror}", where=str(path), allowed=ALLOWED
        ) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise DataError(f"is no TOML: {error}", where=str(path), allowed=ALLOWED) from None
    tables = {"plate", "singles"} & raw.keys()
    if len(tables) != 1 or not isinstance(raw[table := tables.pop()], dict):
        raise DataError("holds no board, or two", where=str(path), allowed=ALLOWED)
    try:
        return _singles(raw[table]) if table == "singles" else _plate(raw[table])
    except ValidationError as error:
        fault = error.errors()[0]
        key = ".".join([table, *(str(part) for part in fault["loc"])])
        raise DataError(
            f"{key}: {fault['msg'].removeprefix('Value error, ')}", where=str(path), allowed=ALLOWED
        ) from None
    except DataError as error:
        raise DataError(
            error.what, allowed=error.allowed, where=f"{path}, {error.where}", remedy=error.remedy
        ) from None


def _plate(table: dict[str, Any]) -> Plate:
    return Plate.from_rig(schema.Plate.model_validate({"pose": _UNMOUNTED, **table}))


def _singles(table: dict[str, Any]) -> Singles:
    given = _Singles.model_validate(table)
    return Singles(given.dictionary, given.size_m, given.ids, tuple(given.sizes_m.items()))
