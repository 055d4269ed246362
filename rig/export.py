"""A run for other programs: Parquet tables, or one MCAP file that Foxglove opens.

Both formats depend on what is written last, so they are made from a finished run and never live.
"""

import base64
import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from cdpr8 import CABLES
from cdpr8.errors import UsageError
from cdpr8.runfolder import Run, read_video

PARQUET_FOLDER = "parquet"
_NS = 1_000_000_000


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
                data=json.dumps(message).encode(),
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
        for t_s, tension_n, status in zip(
            rows["t_s"], rows["tension_n"], rows["status"], strict=True
        ):
            value = {"tension_n": float(tension_n), "status": int(status)}
            yield at(t_s), f"/tension/{cable}", "cdpr8.Tension", value
    for t_s, kind, detail in zip(
        run.events["t_s"], run.events["kind"], run.events["detail"], strict=True
    ):
        yield at(t_s), "/events", "cdpr8.Event", {"kind": str(kind), "detail": str(detail)}
    if run.pose is not None:
        names = ("x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg")
        for row in run.pose[["t_s", *names]].dropna().itertuples(index=False):
            yield at(row.t_s), "/pose", "cdpr8.Pose", {n: float(getattr(row, n)) for n in names}
    if run.video is not None and len(run.frames):
        yield from _pictures(run, at)


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
                "timestamp": {"sec": time_ns // _NS, "nsec": time_ns % _NS},
                "frame_id": "camera",
                "format": "png",
                "data": base64.b64encode(png.tobytes()).decode("ascii"),
            },
        )


def _object(**properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties}


_NUMBER, _TEXT, _WHOLE = {"type": "number"}, {"type": "string"}, {"type": "integer"}

_SCHEMAS = {
    "cdpr8.Tension": _object(tension_n=_NUMBER, status=_WHOLE),
    "cdpr8.Event": _object(kind=_TEXT, detail=_TEXT),
    "cdpr8.Pose": _object(
        x_m=_NUMBER,
        y_m=_NUMBER,
        z_m=_NUMBER,
        roll_deg=_NUMBER,
        pitch_deg=_NUMBER,
        yaw_deg=_NUMBER,
    ),
    "foxglove.CompressedImage": _object(
        timestamp=_object(sec=_WHOLE, nsec=_WHOLE),
        frame_id=_TEXT,
        format=_TEXT,
        data={"type": "string", "contentEncoding": "base64"},
    ),
}


def _not_installed(what: str, package: str) -> UsageError:
    return UsageError(
        f"{what} needs the package {package}, which is not installed",
        remedy="pip install 'cdpr8[export]'",
    )
