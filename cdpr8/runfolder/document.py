"""The run folder told to others: JSON Schemas for programs and docs/run-folder.md for people.

``python -m cdpr8.runfolder.document`` writes both from the definitions; a test holds them to it.
"""

import json
from enum import IntFlag
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel

from cdpr8.rigfile.excitation import Excitation
from cdpr8.runfolder.records import Node, StartRecord, StopRecord
from cdpr8.runfolder.tables import (
    SCHEMA_VERSION,
    TABLES,
    Column,
    EventKind,
    FrameFlag,
    Table,
    TensionStatus,
)

SCHEMA_FOLDER = Path(__file__).parent / "schemas" / f"v{SCHEMA_VERSION}"

_MEANING: dict[type[IntFlag], dict[IntFlag, str]] = {
    TensionStatus: {
        TensionStatus.NET_OVERFLOW: "net overflow; not used",
        TensionStatus.GROSS_OVERFLOW: "gross overflow; not used",
        TensionStatus.ADC_OVERFLOW: "input beyond the converter (about 2.5 mV/V); not used",
        TensionStatus.STANDSTILL: "the amplifier sees standstill",
        TensionStatus.LIMIT_1: "limit switch 1",
        TensionStatus.LIMIT_2: "limit switch 2",
        TensionStatus.TRIGGER: "trigger active",
        TensionStatus.NOT_CONTIGUOUS: "the amplifier skipped values",
        TensionStatus.HOST_OVERLOAD: "beyond the host's own limit for the force cell",
        TensionStatus.STALE: "repeats an old value; not used",
        TensionStatus.UNCONFIRMED: "a jump that a second reading did not confirm; not used",
        TensionStatus.UNTIMED: "came too late for its time to be known, or may be of an earlier "
        "trigger; not used",
    },
    FrameFlag: {
        FrameFlag.DROPPED_BEFORE: "a frame was lost before this one",
        FrameFlag.REPEATED: "the same picture as the one before",
        FrameFlag.BLACK: "nothing to be seen",
        FrameFlag.NO_MARKER: "no marker found: the pose is empty",
        FrameFlag.FEW_MARKERS: "some markers of the plate were not found",
        FrameFlag.AMBIGUOUS: "both solutions of the planar pose fit about as well",
        FrameFlag.BRANCH_FROM_PREVIOUS: "the solution nearest the frame before was taken",
        FrameFlag.HIGH_REPROJECTION: "the plate fits this picture worse than the others",
    },
}
"""By class, then by bit: bits of two classes are equal integers, and would share one dictionary."""


def schemas() -> dict[str, dict[str, Any]]:
    """File name -> JSON Schema, for the two records and for one row of each table."""
    found = {
        "start.schema.json": StartRecord.model_json_schema(),
        "stop.schema.json": StopRecord.model_json_schema(),
    }
    for table in TABLES:
        name = table.file.removesuffix(".csv")
        found[f"{name}.row.schema.json"] = {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": f"one row of {table.file}",
            "description": table.meaning,
            "type": "object",
            "properties": {column.name: _property(column) for column in table.columns},
            "required": [
                column.name
                for column in table.columns
                if not column.optional and column.left_out is None
            ],
        }
    return found


def page() -> str:
    """docs/run-folder.md."""
    sections = [_HEAD, _start_section()]
    sections += [_table_section(table) for table in TABLES]
    sections.append("## Status bits of tension.csv\n\n" + _bits(TensionStatus))
    sections.append("## Flag bits of frames.csv and pose.csv\n\n" + _bits(FrameFlag))
    sections.append(
        "## Kinds of event\n\n" + ", ".join(f"`{kind.value}`" for kind in EventKind) + "\n"
    )
    return "\n".join(sections)


_HEAD = f"""# The run folder (schema version {SCHEMA_VERSION})

<!-- written by `python -m cdpr8.runfolder.document`; edit cdpr8/runfolder/, not this page -->

A recording is a folder of plain files. Any program that writes them makes a run that every command
here reads; the JSON Schemas are in `cdpr8/runfolder/schemas/`.

| file | what it is |
|---|---|
| `start.json` | what was known before the first sample: on disk before it (`start.schema.json`) |
| `rig.toml` | the rig file as it was (see [rig-file.md](rig-file.md)) |
| `tension.csv` | the tensions, appended as they come |
| `video.mkv` | the frames, grey and lossless (FFV1 in Matroska) |
| `frames.csv` | the time of each frame |
| `events.csv` | gaps, bad frames, lost amplifiers, start and end of the motion |
| `command.csv` | what the winch controller commanded and measured, where it gives a log |
| `command.txt` | that log as it arrived: each line after its time of arrival and a tab |
| `stop.json` | how the run ended (`stop.schema.json`); absent: interrupted, and still readable |
| `pose.csv` | written by `vision track` |
| `results/` | written by `analysis` (into `./results/RUN` where the run is packaged or read-only) |

`start.json`, `rig.toml` and `tension.csv` must be there; `analysis` needs a pose as well, from
`pose.csv` or tracked in the video.

Every file is valid when cut at any byte: a torn last line is dropped and said. Nothing is repaired:
a damaged cell is refused with its file, line and column. An empty cell means: not measured. Times
are seconds from the run's monotonic origin; positions in m, forces in N, angles in deg; cables are
numbered 1 to 8; the pose is that of the point that the rig file takes for the platform's centre of
mass, in O-XYZ.
"""


def _property(column: Column) -> dict[str, Any]:
    kind: Any = [column.type, "null"] if column.optional else column.type
    description = f"{column.meaning} [{column.unit}]" if column.unit else column.meaning
    return {"type": kind, "description": description}


def _table_section(table: Table) -> str:
    rows = "\n".join(f"| `{c.name}` | {c.unit} | {c.meaning}{_freedom(c)} |" for c in table.columns)
    head = "| column | unit | meaning |\n|---|---|---|"
    return f"## {table.file}\n\n{table.meaning}\n\n{head}\n{rows}\n"


def _freedom(column: Column) -> str:
    if column.optional:
        return " (may be empty, or left out)"
    return "" if column.left_out is None else f" (left out: {column.left_out})"


def _start_section() -> str:
    """The keys of start.json that do not speak for themselves, of the motion, of an amplifier."""
    records = (("", StartRecord), ("excitation.", Excitation), ("nodes[].", Node))
    rows = [
        f"| `{prefix}{name}` | {_allowed(field.annotation)}{field.description} |"
        for prefix, record in records
        for name, field in record.model_fields.items()
        if field.description
    ]
    needed = ", ".join(f"`{name}`" for name in _needed(StartRecord))
    others = ", ".join(f"`{name}`" for name in _needed(Node))
    head = (
        f"It must have {needed}; each of `nodes`, which may be empty, {others}. All else may be\n"
        "left out, or be null where it is not known.\n\n"
    )
    table = "| key | meaning |\n|---|---|\n" + "\n".join(rows) + "\n"
    return "## start.json\n\n" + head + table + _MOTION


def _needed(record: type[BaseModel]) -> list[str]:
    return [name for name, field in record.model_fields.items() if field.is_required()]


def _allowed(annotation: Any) -> str:
    """The values of a key that has a few, as a beginning of what it means."""
    for one in (annotation, *get_args(annotation)):
        if get_origin(one) is Literal:
            return " or ".join(f"`{value}`" for value in get_args(one)) + ": "
    return ""


_MOTION = """
### The motion

X* = 0 until `motion_start_s` (left out: `rest_s`). From there, with tau counted from it, the
angle about `axis` is `amplitude_deg` w(tau) sin(2 pi `frequency_hz` tau), and then 0 again. w rises
from 0 to 1 over `ramp_s` by the law `ramp` and falls by the same law as `ending` says. A program
that leaves `ramp` or `ending` out does not state them: `analysis` then finds out from the onset and
the end of the motion which of these laws it was, and says so. X_p0 and X_w0
are added to the state at tau = 0.

What the rig file's pretensions and weight do not balance, a constant wrench holds: the rig file's
machine rests at X = 0 with its pretensions, whatever drives it.

Winches alone do not make the angle: cables give, and a platform that is paid out 2 deg moves less.

A free decay is a run with `amplitude_deg` 0 and a `platform_offset_m` other than 0: from
`motion_start_s` on the platform rings about its rest for `motion_s`. Whether it was held there and
let go, or knocked there, `analysis diagnose` finds out where a law with a memory asks for it
(`let_go_share` in [effects.md](effects.md)). `analysis compare` needs a motion and refuses it.
"""


def _bits(flags: type[IntFlag]) -> str:
    meaning = _MEANING[flags]
    rows = "\n".join(f"| {bit.value} | `{bit.name}` | {meaning[bit]} |" for bit in flags)
    return f"| bit | name | meaning |\n|---|---|---|\n{rows}\n"


def write() -> None:
    """Write the schemas and the page."""
    SCHEMA_FOLDER.mkdir(parents=True, exist_ok=True)
    for name, schema in schemas().items():
        (SCHEMA_FOLDER / name).write_text(json.dumps(schema, indent=1) + "\n")
    docs = Path(__file__).parents[2] / "docs"
    (docs / "run-folder.md").write_text(page())


if __name__ == "__main__":
    write()
