"""Board files: what `vision track VIDEO --board FILE` looks for.

A board file is TOML and holds one of four tables. ``[plate]`` as in a rig file (its pose may be
left out; a whole rig file serves too) describes markers whose places relative to each other are
known.
``[singles]`` describes markers of which only the size is known::

    [singles]
    dictionary = "DICT_ARUCO_ORIGINAL"
    size_m = 0.05
    ids = [101, 601]      # left out: every marker of the dictionary
    sizes_m = {701 = 0.03}  # markers of another size

``[charuco]`` describes the markers of a ChArUco board (``dictionary``, ``columns`` and ``rows`` of
squares, ``square_m``, ``marker_m``). ``[[plane]]``, several times, describes plates in several
planes: each as ``[plate]``, with its ``pose`` in the board's own frame. A dictionary may be a YAML
file, named from the board file's folder.
"""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from cdpr8.errors import DataError
from cdpr8.rigfile import schema
from cdpr8.rigfile.section import Section
from vision.mounting import unit
from vision.plate import Plate, Singles

ALLOWED = (
    "a TOML file with [plate] (dictionary and [plate.grid] or [[plate.marker]], as in a rig file) "
    "or [singles] (dictionary, size_m, ids), [charuco] (dictionary, columns, rows, square_m, "
    "marker_m), or [[plane]] tables, each a plate with its pose"
)

_UNMOUNTED = {"position_m": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "up": [0.0, 1.0, 0.0]}
"""Stands in for the mounting, which a board in the hand does not have."""


class _Charuco(Section):
    dictionary: str
    columns: int = Field(gt=1)
    rows: int = Field(gt=1)
    square_m: float = Field(gt=0.0)
    marker_m: float = Field(gt=0.0)

    @model_validator(mode="after")
    def _markers_fit_squares(self) -> Self:
        if self.marker_m >= self.square_m:
            raise ValueError("marker_m must be less than square_m")
        return self


class _Singles(Section):
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
    kinds: dict[str, Callable[[Any], Plate | Singles]] = {
        "plate": _plate,
        "singles": _singles,
        "charuco": _charuco,
        "plane": _planes,
    }
    tables = kinds.keys() & raw.keys()
    if len(tables) != 1 or not isinstance(raw[table := tables.pop()], dict | list):
        raise DataError("holds no board, or two", where=str(path), allowed=ALLOWED)
    content = raw[table]
    if isinstance(content, list) != (table == "plane"):
        raise DataError(f"[{table}] is not a table of its kind", where=str(path), allowed=ALLOWED)
    for part in content if isinstance(content, list) else [content]:
        _find_dictionary(part, path.parent)
    try:
        return kinds[table](content)
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


def _find_dictionary(table: Any, folder: Path) -> None:
    """Name a dictionary file from the board file's folder."""
    name = table.get("dictionary") if isinstance(table, dict) else None
    if isinstance(name, str) and name.endswith((".yml", ".yaml")):
        table["dictionary"] = str(folder / name)


def _charuco(table: dict[str, Any]) -> Plate:
    given = _Charuco.model_validate(table)
    return Plate.charuco(
        given.dictionary, given.columns, given.rows, given.square_m, given.marker_m
    )


def _planes(tables: list[Any]) -> Plate:
    """One plate of several planes."""
    planes = [schema.Plate.model_validate(table) for table in tables]
    parts = [Plate.from_rig(plane) for plane in planes]
    ids = tuple(marker for part in parts for marker in part.ids)
    if len({part.dictionary for part in parts}) > 1 or len(set(ids)) < len(ids):
        raise DataError(
            "planes of several dictionaries, or an id in two of them",
            where="plane",
            allowed="one dictionary, each id once",
        )
    corners = []
    for plane, part in zip(planes, parts, strict=True):
        normal = unit(plane.pose.normal, "plane.pose.normal")
        x = unit(np.cross(plane.pose.up, normal), "plane.pose: up and normal")
        axes = np.stack([x, np.cross(normal, x), normal])
        corners.append(part.corners @ axes + np.asarray(plane.pose.position_m))
    return Plate(parts[0].dictionary, ids, np.concatenate(corners))


def _plate(table: dict[str, Any]) -> Plate:
    return Plate.from_rig(schema.Plate.model_validate({"pose": _UNMOUNTED, **table}))


def _singles(table: dict[str, Any]) -> Singles:
    given = _Singles.model_validate(table)
    return Singles(given.dictionary, given.size_m, given.ids, tuple(given.sizes_m.items()))
