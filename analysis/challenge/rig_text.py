"""A rig as the text of a rig file."""

import json
from collections.abc import Mapping

from cdpr8.rigfile import Rig


def rig_text(rig: Rig) -> str:
    """The rig file that describes a rig; hidden physics has no place in it.

    Parameters
    ----------
    rig
        Every parameter is written with its sigma.
    """
    written = rig.model_dump(mode="json", exclude_none=True, exclude={"physics"})
    lines = [f"name = {json.dumps(written.pop('name'))}", ""]
    cables = written.pop("cable")
    platform = {"platform": written.pop("platform")}
    for name, table in (platform | written).items():
        if table:
            lines += _table(f"[{name}]", table)
    for cable in cables:
        lines += _table("[[cable]]", cable)
    return "\n".join(lines).rstrip("\n") + "\n"


def _table(header: str, table: Mapping[str, object]) -> list[str]:
    rows = [f"{key} = {_value(value)}" for key, value in table.items()]
    return [header, *rows, ""]


def _value(value: object) -> str:
    if isinstance(value, Mapping):
        inside = ", ".join(f"{key} = {_value(item)}" for key, item in value.items())
        return "{" + inside + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value)
