"""`rig export`: Parquet and MCAP hold what the run holds, in types that others know."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from rig_stand_ins import record_virtually
from scipy.spatial.transform import Rotation

from cdpr8.rigfile import Rig
from cdpr8.runfolder import POSE_AXES, Run, load_run
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
"""Fields of the message types that Foxglove publishes, all of them required (its SDK's
schemas/jsonschema, compared in 2026; what came later, message_id and lineage, is optional)."""

KNOWN_LEVELS = range(6)


def shape(value: object) -> object:
    if isinstance(value, dict):
        return {name: shape(each) for name, each in value.items()}
    return type(value)


def schema_shape(schema: dict[str, Any]) -> object:
    """Of a schema, as Foxglove's own reader takes it: what that refuses is refused here."""
    if "oneOf" in schema:
        assert [each["const"] for each in schema["oneOf"]] == list(KNOWN_LEVELS)
        return int
    if schema["type"] == "object":
        return {name: schema_shape(each) for name, each in schema["properties"].items()}
    assert schema.get("contentEncoding", "base64") == "base64"
    return {"string": str, "integer": int, "number": float}[schema["type"]]


def all_required(schema: dict[str, Any]) -> bool:
    inner = [each for each in schema["properties"].values() if each.get("type") == "object"]
    return schema["required"] == list(schema["properties"]) and all(map(all_required, inner))


@dataclass
class Read:
    """An MCAP file as the reader of its own makers finds it."""

    schemas: dict[str, dict[str, Any]]
    topics: dict[str, list[tuple[int, Any]]]
    names: dict[str, str]


def read_mcap(path: str) -> Read:
    """All messages, each held against its channel's schema."""
    mcap = pytest.importorskip("mcap.reader")
    found = Read({}, {}, {})
    with open(path, "rb") as file:
        reader = mcap.make_reader(file, validate_crcs=True)
        for each in reader.get_summary().schemas.values():
            found.schemas[each.name] = json.loads(each.data)
            jsonschema.Draft7Validator.check_schema(found.schemas[each.name])
            schema_shape(found.schemas[each.name])
        times = []
        for schema, channel, message in reader.iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            value = json.loads(message.data, parse_constant=not_json)
            jsonschema.validate(value, found.schemas[schema.name])
            found.topics.setdefault(channel.topic, []).append((message.log_time, value))
            found.names[channel.topic] = schema.name
            times.append(message.log_time)
    assert times == sorted(times)
    return found


def not_json(word: str) -> None:
    raise AssertionError(f"{word} is no JSON")


@pytest.fixture
def exported(rig: Rig, here: Path) -> tuple[Run, Read]:
    """A run with poses for its frames, and what its export holds."""
    record_virtually(rig, here / "run", 0.6)
    times = load_run(here / "run").frames["t_s"]
    names = ["frame", "t_s", *POSE_AXES, "markers", "flags"]
    poses = [f"{frame},{t_s},0.1,0.2,0.3,10,20,30,8,0" for frame, t_s in enumerate(times)]
    poses[1] = f"1,{times[1]},,,,,,,0,8"  # one where the plate was not found
    (here / "run" / "pose.csv").write_text("\n".join([",".join(names), *poses]) + "\n")
    assert run_app(app, ["export", "run", "--mcap", "--out", "out.mcap"]) == 0
    return load_run(here / "run"), read_mcap("out.mcap")


def test_an_mcap_holds_what_foxglove_knows_by_name(exported: tuple[Run, Read]) -> None:
    _, found = exported
    for name, fields in PUBLISHED.items():
        schema = found.schemas[name]
        assert (schema["title"], schema_shape(schema)) == (name, fields)
        assert schema["properties"]["timestamp"]["title"] == "time"
        assert all_required(schema)
        (topic,) = (topic for topic, its in found.names.items() if its == name)
        for time_ns, value in found.topics[topic]:
            assert shape(value) == fields
            stamp = value["timestamp"]
            assert stamp["sec"] * 1_000_000_000 + stamp["nsec"] == time_ns
    assert len(found.topics["/camera"]) == 10
    pose = found.topics["/pose"][0][1]["pose"]
    expected = Rotation.from_euler("ZYX", [30, 20, 10], degrees=True).as_quat()
    assert [pose["orientation"][axis] for axis in "xyzw"] == pytest.approx(expected)
    assert pose["position"] == {"x": 0.1, "y": 0.2, "z": 0.3}


def test_tensions_poses_and_pictures_of_an_mcap_share_one_time_line(
    exported: tuple[Run, Read],
) -> None:
    run, found = exported
    anchor = run.start.clock_anchor
    origin_ns = round((anchor.wall.timestamp() - anchor.t_s) * 1e6) * 1000
    expected_s = {f"/tension/{cable}": run.cable_tension(cable)["t_s"] for cable in range(1, 9)}
    expected_s["/events"] = run.events["t_s"].sort_values()
    expected_s["/camera"] = run.frames["t_s"]
    expected_s["/pose"] = expected_s["/pose/axes"] = run.frames["t_s"].drop(1)
    for topic, times_s in expected_s.items():
        at_s = [(time_ns - origin_ns) * 1e-9 for time_ns, _ in found.topics[topic]]
        assert at_s == pytest.approx(list(times_s), abs=1e-6), topic
    # A picture and the pose seen in it are one instant.
    pictures = [time_ns for time_ns, _ in found.topics["/camera"]]
    assert [time_ns for time_ns, _ in found.topics["/pose"]] == [pictures[0], *pictures[2:]]


def test_an_export_is_one_or_the_other(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["export", "run"]) == 2
    assert "either --parquet or --mcap" in capsys.readouterr().err


@pytest.mark.parametrize("what", ["--parquet", "--mcap"])
def test_a_place_that_cannot_be_written_is_told_in_one_message(
    here: Path, what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pyarrow")
    (here / "file").write_text("no folder")
    assert run_app(app, ["export", "run01", what, "--out", "file/out"]) == 3
    told = capsys.readouterr().err
    assert "file" in told.splitlines()[0]
    assert "cannot be used: " in told
    assert "remedy:  name a place" in told
