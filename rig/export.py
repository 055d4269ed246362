"""A run for other programs: Parquet tables, or one MCAP file that Foxglove opens.

Both formats depend on what is written last, so they are made from a finished run and never live.
"""

import base64
import json
import math
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from cdpr8 import CABLES
from cdpr8.errors import UsageError
from cdpr8.runfolder import POSE_AXES, Run, read_video

PARQUET_FOLDER = "parquet"
_NS = 1_000_000_000

_COMMANDS = ("commanded_m", "measured_m", "commanded_deg", "measured_deg")
_INFO, _WARNING = 2, 3
_ORDINARY = frozenset({"motion_start", "motion_end", "clock_anchor", "sync_tap"})


def export_parquet(run: Run, folder: Path) -> list[Path]:
    """Write one Parquet file a table.

    Raises
    ------
    UsageError
        pyarrow is not installed.
    """
    try:
        pa: Any = import_module("pyarrow")
        pq: Any = import_module("pyarrow.parquet")
    except ImportError:
        raise _not_installed("Parquet", "pyarrow") from None
    folder.mkdir(parents=True, exist_ok=True)
    tables = {"tension": run.tension, "frames": run.frames, "events": run.events}
    if run.pose is not None:
        tables["pose"] = run.pose
    if run.command is not None:
        tables["command"] = run.command
    about = {"cdpr8.start": run.start.model_dump_json()}
    written = []
    for name, frame in tables.items():
        table = pa.Table.from_pandas(frame, preserve_index=False)
        table = table.replace_schema_metadata({**(table.schema.metadata or {}), **about})
        path = folder / f"{name}.parquet"
        pq.write_table(table, path)
        written.append(path)
    return written


def export_mcap(run: Run, path: Path) -> Path:
    """Write tensions, poses, events and pictures on one time line.

    Raises
    ------
    UsageError
        mcap is not installed.
    """
    try:
        mcap: Any = import_module("mcap.writer")
    except ImportError:
        raise _not_installed("MCAP", "mcap") from None
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        writer = mcap.Writer(file)
        writer.start(profile="", library="cdpr8")
        writer.add_metadata("start.json", {"json": run.start.model_dump_json()})
        channels: dict[str, int] = {}
        for time_ns, topic, schema, message in _in_order(run):
            if topic not in channels:
                text = json.dumps(_SCHEMAS[schema]).encode()
                channels[topic] = writer.register_channel(
                    topic=topic,
                    message_encoding="json",
                    schema_id=writer.register_schema(schema, "jsonschema", text),
                )
            writer.add_message(
                channels[topic],
                log_time=time_ns,
                publish_time=time_ns,
                data=json.dumps(message, allow_nan=False).encode(),
            )
        writer.finish()
    return path


_Message = tuple[int, str, str, dict[str, Any]]


def _in_order(run: Run) -> Iterator[_Message]:
    """All messages, each kind in order of time (MCAP's index puts them together)."""
    anchor = run.start.clock_anchor
    origin_ns = round((anchor.wall.timestamp() - anchor.t_s) * 1e6) * 1000

    def at(t_s: Any) -> int:
        return origin_ns + round(float(t_s) * _NS)

    for cable in range(1, CABLES + 1):
        rows = run.tension[run.tension["cable"] == cable].sort_values("t_s", kind="stable")
        times_s = rows["t_s"] - run.filter_delay_s(cable)
        for t_s, tension_n, status in zip(times_s, rows["tension_n"], rows["status"], strict=True):
            value = {"tension_n": float(tension_n), "status": int(status)}
            yield at(t_s), f"/tension/{cable}", "cdpr8.Tension", value
    for t_s, kind, detail in zip(
        run.events["t_s"], run.events["kind"], run.events["detail"], strict=True
    ):
        yield at(t_s), "/events", "foxglove.Log", _log(at(t_s), str(kind), str(detail))
    if run.command is not None:
        for row in run.command[["t_s", "cable", *_COMMANDS]].itertuples(index=False):
            told = {name: float(getattr(row, name)) for name in _COMMANDS}
            some = {name: value for name, value in told.items() if math.isfinite(value)}
            yield at(row.t_s), f"/command/{row.cable}", "cdpr8.Command", some
    if run.pose is not None:
        for row in run.pose[["t_s", *POSE_AXES]].dropna().itertuples(index=False):
            values = {name: float(getattr(row, name)) for name in POSE_AXES}
            yield at(row.t_s), "/pose/axes", "cdpr8.Pose", values
            yield at(row.t_s), "/pose", "foxglove.PoseInFrame", _pose(at(row.t_s), values)
    if run.video is not None and len(run.frames):
        yield from _pictures(run, at)


def _stamp(time_ns: int) -> dict[str, int]:
    return {"sec": time_ns // _NS, "nsec": time_ns % _NS}


def _log(time_ns: int, kind: str, detail: str) -> dict[str, Any]:
    level = _INFO if kind in _ORDINARY else _WARNING
    return {
        "timestamp": _stamp(time_ns),
        "level": level,
        "message": f"{kind}: {detail}",
        "name": "rig record",
        "file": "events.csv",
        "line": 0,
    }


def _pose(time_ns: int, values: dict[str, float]) -> dict[str, Any]:
    """Position in m, and the quaternion of R = Rz(yaw) Ry(pitch) Rx(roll)."""
    half = [math.radians(values[f"{axis}_deg"]) / 2.0 for axis in ("roll", "pitch", "yaw")]
    (sr, sp, sy), (cr, cp, cy) = map(math.sin, half), map(math.cos, half)
    return {
        "timestamp": _stamp(time_ns),
        "frame_id": "O-XYZ",
        "pose": {
            "position": {axis: values[f"{axis}_m"] for axis in "xyz"},
            "orientation": {
                "x": sr * cp * cy - cr * sp * sy,
                "y": cr * sp * cy + sr * cp * sy,
                "z": cr * cp * sy - sr * sp * cy,
                "w": cr * cp * cy + sr * sp * sy,
            },
        },
    }


def _pictures(run: Run, at: Any) -> Iterator[_Message]:
    import cv2

    for (image, _), t_s in zip(read_video(run.video or Path()), run.frames["t_s"], strict=False):
        time_ns = at(t_s)
        _, png = cv2.imencode(".png", image)
        yield (
            time_ns,
            "/camera",
            "foxglove.CompressedImage",
            {
                "timestamp": _stamp(time_ns),
                "frame_id": "camera",
                "format": "png",
                "data": base64.b64encode(png.tobytes()).decode("ascii"),
            },
        )


def _object(**properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(properties)}


def _named(title: str, **properties: dict[str, Any]) -> dict[str, Any]:
    return {"title": title, **_object(**properties)}


_NUMBER, _TEXT, _WHOLE = {"type": "number"}, {"type": "string"}, {"type": "integer"}
_COUNT = {**_WHOLE, "minimum": 0}

_TIME = _named("time", sec=_COUNT, nsec={**_COUNT, "maximum": _NS - 1})
_POINT = _named("foxglove.Vector3", x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION = _named("foxglove.Quaternion", x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_LEVEL = {
    "title": "foxglove.LogLevel",
    "oneOf": [
        {"title": name, "const": level}
        for level, name in enumerate(("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"))
    ],
}

_SCHEMAS = {
    "cdpr8.Tension": _object(tension_n=_NUMBER, status=_WHOLE),
    # What the log does not give is left out.
    "cdpr8.Command": {**_object(**dict.fromkeys(_COMMANDS, _NUMBER)), "required": []},
    "cdpr8.Pose": _object(**dict.fromkeys(POSE_AXES, _NUMBER)),
    # Those that Foxglove's panels know by name; the fields are as it publishes them.
    "foxglove.Log": _named(
        "foxglove.Log",
        timestamp=_TIME,
        level=_LEVEL,
        message=_TEXT,
        name=_TEXT,
        file=_TEXT,
        line=_COUNT,
    ),
    "foxglove.PoseInFrame": _named(
        "foxglove.PoseInFrame",
        timestamp=_TIME,
        frame_id=_TEXT,
        pose=_named("foxglove.Pose", position=_POINT, orientation=_QUATERNION),
    ),
    "foxglove.CompressedImage": _named(
        "foxglove.CompressedImage",
        timestamp=_TIME,
        frame_id=_TEXT,
        data={"type": "string", "contentEncoding": "base64"},
        format=_TEXT,
    ),
}


def _not_installed(what: str, package: str) -> UsageError:
    return UsageError(
        f"{what} needs the package {package}, which is not installed",
        remedy="pip install 'cdpr8[export]'",
    )
