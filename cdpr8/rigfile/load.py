"""Reading a rig file, with every fault told as file, line, key, value and what is allowed."""

import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cdpr8.errors import RigFileError
from cdpr8.rigfile.checks import check_physics
from cdpr8.rigfile.lines import Location, key_lines, nearest_line
from cdpr8.rigfile.schema import Intrinsics, Rig

PACKAGED_RIG = "cdpr8.toml"


def packaged_rig_path() -> Path:
    """The packaged CDPR-8 rig file."""
    return Path(str(resources.files("cdpr8.rigfile").joinpath(PACKAGED_RIG)))


def find_rig_file(named: str | Path | None = None) -> Path:
    """The rig file a command uses: the one named, else ./rig.toml, else the packaged CDPR-8."""
    if named is not None:
        return Path(named)
    here = Path("rig.toml")
    return here if here.is_file() else packaged_rig_path()


def load_rig(path: str | Path | None = None) -> Rig:
    """Read and check a rig file.

    Parameters
    ----------
    path
        The file; None takes ./rig.toml, else the packaged CDPR-8.

    Raises
    ------
    RigFileError
        The file is missing, is not TOML, or describes no machine that can be.
    """
    path = find_rig_file(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise RigFileError(
            f"no rig file {str(path)!r}", remedy="name one with --rig, or leave --rig out"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise RigFileError(
            f"cannot be read: {error}", where=str(path), allowed="a TOML text in UTF-8"
        ) from None
    return parse_rig(text, str(path), path.parent)


def parse_rig(text: str, name: str, folder: Path) -> Rig:
    """Check the text of a rig file; `name` and `folder` say where it came from."""
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise RigFileError(f"is not TOML: {error}", where=name) from None
    lines = key_lines(text)
    try:
        rig = Rig.model_validate(raw)
    except ValidationError as error:
        raise _first_fault(error, raw, lines, name) from None
    rig = _with_intrinsics_file(rig, folder, name)
    check_physics(rig, lambda location: _where(name, lines, location))
    return rig


def files_beside(text: str, folder: Path) -> dict[str, bytes]:
    """The files that a sound rig file names, so that a run can carry them beside it.

    Parameters
    ----------
    text
        The rig file.
    folder
        Where it stands.

    Returns
    -------
    dict
        File name -> its bytes: the intrinsics file, or nothing.
    """
    intrinsics = tomllib.loads(text).get("camera", {}).get("intrinsics")
    if not isinstance(intrinsics, str):
        return {}
    return {intrinsics: (folder / intrinsics).read_bytes()}


def _with_intrinsics_file(rig: Rig, folder: Path, name: str) -> Rig:
    """The rig with the intrinsics file, where it names one, read into it."""
    if rig.camera is None or not isinstance(rig.camera.intrinsics, str):
        return rig
    from cdpr8.rigfile.intrinsics import load_intrinsics

    intrinsics: Intrinsics = load_intrinsics(folder / rig.camera.intrinsics, named_by=name)
    camera = rig.camera.model_copy(update={"intrinsics": intrinsics})
    return rig.model_copy(update={"camera": camera})


def _where(name: str, lines: dict[Location, int], location: Location) -> str:
    line = nearest_line(lines, location)
    return f"{name}:{line}, {_spelled(location)}" if line else f"{name}, {_spelled(location)}"


def _spelled(location: Location) -> str:
    """A location as a user reads it: cables and their like count from 1."""
    words = ""
    for part in location:
        if isinstance(part, int):
            words += f"[{part + 1}]"
        else:
            words += f".{part}" if words else part
    return words


def _first_fault(
    error: ValidationError, raw: dict[str, Any], lines: dict[Location, int], name: str
) -> RigFileError:
    """The first fault pydantic found, as one message; the others are counted."""
    faults = error.errors()
    unknown = [fault for fault in faults if fault["type"] == "extra_forbidden"]
    fault = (unknown or faults)[0]
    location = _spoken(raw, fault["loc"])
    more = f" (and {len(faults) - 1} more faults)" if len(faults) > 1 else ""
    where = _where(name, lines, location or ("file",)) if location else name
    if fault["type"] == "extra_forbidden":
        return RigFileError(
            f"unknown key {location[-1]!r}{more}",
            where=where,
            allowed=_allowed_keys(location[:-1]),
            remedy="correct the name or remove the line",
        )
    if fault["type"] == "missing" and isinstance(fault["loc"][-1], str):
        return RigFileError(
            f"{fault['loc'][-1]!r} is missing{more}",
            where=_where(name, lines, tuple(fault["loc"])),
            remedy=f"add it to {_spelled(location) or 'the file'}",
        )
    message = fault["msg"].removeprefix("Value error, ")
    if fault["type"] == "missing":
        message = f"a list of at least {int(fault['loc'][-1]) + 1} numbers"
    value = fault["input"]
    shown = "" if isinstance(value, dict | list | tuple) and len(str(value)) > 80 else f" {value!r}"
    return RigFileError(f"value{shown} is refused{more}", where=where, allowed=message)


def _spoken(raw: Any, location: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """The parts of a pydantic location that stand in the file (unions add parts of their own)."""
    parts: list[str | int] = []
    here = raw
    for part in location:
        in_table = isinstance(here, dict) and part in here
        in_array = isinstance(here, list) and isinstance(part, int) and part < len(here)
        if in_table or in_array:
            here = here[part]
            parts.append(part)
    return tuple(parts)


def _allowed_keys(location: Location) -> str:
    """The keys the schema has for a table."""
    schema = Rig.model_json_schema()
    node: dict[str, Any] = schema
    for part in location:
        if isinstance(part, str):
            node = node.get("properties", {}).get(part, {})
        node = _resolve(schema, node)
    return ", ".join(node.get("properties", {})) or "see the documentation of the rig file"


def _resolve(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    """Follow references, arrays and optional values to the table behind them."""
    while True:
        if "$ref" in node:
            node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
        elif "items" in node:
            node = node["items"]
        elif "anyOf" in node:
            node = next((option for option in node["anyOf"] if "$ref" in option), {})
        else:
            return node
