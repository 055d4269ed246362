"""`rig export`: Parquet and MCAP hold what the run holds, in types that others know."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from rig_stand_ins import record_virtually
from scipy.spatial.transform import Rotation

from cdpr8.rigfile import Rig
from cdpr8.runfolder import POSE_AXES, load_run
from cdpr8.terminal import run_app
from rig.command import app

pytestmark = pytest.mark.usefixtures("here")


def test_exports_hold_what_the_run_holds(rig: Rig, here: Path) -> None:
    pytest.importorskip("pyarrow")
    reader = pytest.importorskip("mcap.reader")
    import pandas as pd

    record_virtually(rig, here / "run", 1.0)
    run = load_run(here / "run")
    assert run_app(app, ["export", "run", "--parquet"]) == 0
    assert pd.read_parquet("run-parquet/tension.parquet").equals(run.tension)
    assert run_app(app, ["export", "run", "--mcap", "--out", "out.mcap"]) == 0
    topics: dict[str, list[tuple[int, dict[str, object]]]] = {}
    with open("out.mcap", "rb") as file:
        for _, channel, message in reader.make_reader(file).iter_messages():
            entry = (message.log_time, json.loads(message.data))
            topics.setdefault(channel.topic, []).append(entry)
    rows = run.cable_tension(3)
    assert [value["tension_n"] for _, value in topics["/tension/3"]] == list(rows["tension_n"])
    assert len(topics["/camera"]) == len(run.frames) == 16
    # One time line: a picture and a tension of the same moment have the same time.
    first_ns = topics["/camera"][0][0] - topics["/tension/3"][0][0]
    expected_s = run.frames["t_s"].iloc[0] - rows["t_s"].iloc[0]
    assert first_ns * 1e-9 == pytest.approx(expected_s, abs=1e-6)


TIME = {"sec": int, "nsec": int}


PUBLISHED = {
    "foxglove.CompressedImage": {"timestamp": TIME, "frame_id": str, "data": str, "format": str},
    "foxglove.PoseInFrame": {
        "timestamp": TIME,
        "frame_id": str,
        "pose": {
            "position": dict.fromkeys("xyz", float),
            "orientation": dict.fromkeys("xyzw", float),
        },
    },
    "foxglove.Log": {
        "timestamp": TIME,
        "level": int,
        "message": str,
        "name": str,
        "file": str,
        "line": int,
    },
}
"""Fields of the message types that Foxglove publishes (its schemas/jsonschema, 2024)."""


def shape(value: object) -> object:
    if isinstance(value, dict):
        return {name: shape(each) for name, each in value.items()}
    return type(value)


def schema_shape(schema: dict[str, Any]) -> object:
    if schema["type"] == "object":
        return {name: schema_shape(each) for name, each in schema["properties"].items()}
    return {"string": str, "integer": int, "number": float}[schema["type"]]


def test_an_mcap_holds_what_foxglove_knows_by_name(rig: Rig, here: Path) -> None:
    mcap = pytest.importorskip("mcap.reader")
    record_virtually(rig, here / "run", 0.6)
    names = ["frame", "t_s", *POSE_AXES, "markers", "flags"]
    (here / "run" / "pose.csv").write_text(
        ",".join(names) + "\n0,0.03125,0.1,0.2,0.3,10,20,30,8,0\n1,0.09375,,,,,,,0,8\n"
    )
    assert run_app(app, ["export", "run", "--mcap", "--out", "out.mcap"]) == 0
    seen: dict[str, list[tuple[int, Any]]] = {}
    with open("out.mcap", "rb") as file:
        reader = mcap.make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        schemas = {each.name: json.loads(each.data) for each in summary.schemas.values()}
        times = []
        for schema, channel, message in reader.iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            value = json.loads(message.data)
            jsonschema.validate(value, schemas[schema.name])
            seen.setdefault(schema.name, []).append((message.log_time, value))
            times.append(message.log_time)
    assert times == sorted(times)
    for name, fields in PUBLISHED.items():
        assert schema_shape(schemas[name]) == fields
        for time_ns, value in seen[name]:
            assert shape(value) == fields
            stamp = value["timestamp"]
            assert stamp["sec"] * 1_000_000_000 + stamp["nsec"] == time_ns
    assert len(seen["foxglove.CompressedImage"]) == 10
    ((_, pose),) = seen["foxglove.PoseInFrame"]
    turn = pose["pose"]["orientation"]
    expected = Rotation.from_euler("ZYX", [30, 20, 10], degrees=True).as_quat()
    assert [turn[axis] for axis in "xyzw"] == pytest.approx(expected)
    assert pose["pose"]["position"] == {"x": 0.1, "y": 0.2, "z": 0.3}


def test_an_export_is_one_or_the_other(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["export", "run"]) == 2
    assert "either --parquet or --mcap" in capsys.readouterr().err
