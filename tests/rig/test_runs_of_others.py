"""What the commands beside `record` and `scan` print, and what they say when they refuse."""

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from rig_stand_ins import WavePlatform, record_virtually, rig_text
from scipy.spatial.transform import Rotation

from cdpr8.errors import CheckError, DataError, UsageError
from cdpr8.rigfile import Rig, packaged_rig_path
from cdpr8.runfolder import POSE_AXES, EventKind, VideoWriter, load_run
from cdpr8.terminal import run_app
from rig.command import app
from rig.foreign import ClockMap, ColumnMap, read_foreign_table
from rig.slack import least_tension_n, slack_warning
from rig.until import seconds_until
from rig.verify import Verdict, verify
from rig.zeros import Zeros, check_zeros, read_zeros, take_zero, write_zeros

NOW = datetime(2024, 1, 1, tzinfo=UTC)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def verdicts(rig: Rig, folder: Path, **keys: object) -> dict[str, tuple[Verdict, str]]:
    record_virtually(rig, folder, 2.0, **keys)
    return {each.what: (each.verdict, each.words) for each in verify(load_run(folder))}


def test_a_good_run_is_found_good(rig: Rig, here: Path) -> None:
    found = verdicts(rig, here / "run")
    assert {verdict for verdict, _ in found.values()} == {Verdict.OK}
    assert found["lost"][1] == "nothing"
    assert found["video"][1].startswith("32 frames, 16.00/s")


def test_an_overloaded_run_fails_its_check(
    rig: Rig, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = verdicts(rig, here / "run", platform=WavePlatform(45.0, 0.5), camera=False)
    assert found["overload"][0] is Verdict.FAIL
    assert run_app(app, ["verify", "run"]) == 1
    told = capsys.readouterr()
    assert "FAIL  overload   cables" in told.out
    assert "checks fail: overload" in told.err
    assert run_app(app, ["verify", "run", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)[0]["verdict"] == "ok"


def test_an_interrupted_run_is_said_to_be_one(rig: Rig, here: Path) -> None:
    record_virtually(rig, here / "run", 1.0, camera=False)
    (here / "run" / "stop.json").unlink()
    assert run_app(app, ["verify", "run"]) == 0
    found = verify(load_run(here / "run"))
    assert found[0].verdict is Verdict.WARN
    assert "interrupted" in found[0].words


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


CATMAN = """HBM_CATMAN_DATAFILE
File: pull test

Zeit  1\tKraft 1\tKraft 2
s\tN\tN
0,000\t5,0000\t6,0000
0,010\t5,5000\t6,1000
0,020\t-1,25e1\t6,2000
"""


def test_a_table_of_catman_and_an_avi_become_a_run(
    rig: Rig, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "test.asc").write_text(CATMAN, encoding="cp1252")
    writer = VideoWriter(here / "test.avi.mkv", 32, 24, 16.0)
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 255, (24, 32), dtype=np.uint8)
    for number in range(8):
        if number != 5:  # one picture comes twice
            picture = rng.integers(0, 255, (24, 32), dtype=np.uint8)
        writer.write(picture, number / 16)
    writer.close()
    arguments = ["import", "--video", "test.avi.mkv", "--tension", "test.asc", "--map"]
    arguments += ["time=Zeit,1=Kraft 1,2=3", "--sync", "0.5=0.25", "--sync", "0.75=0.50"]
    assert run_app(app, [*arguments, "--name", "other"]) == 0
    assert "6 values, 8 frames" in capsys.readouterr().out
    run = load_run(here / "runs" / "other")
    assert run.cable_tension(1)["tension_n"].tolist() == [5.0, 5.5, -12.5]
    assert run.cable_tension(2)["tension_n"].tolist() == [6.0, 6.1, 6.2]
    assert run.tension["digits"].isna().all()
    assert not run.start.motion_start_known
    assert "Kraft 1 -> cable 1" in run.start.import_map
    # The video starts a quarter of a second after the table.
    assert run.frames["t_s"].to_numpy() == pytest.approx(0.25 + np.arange(8) / 16, abs=1e-3)
    assert run.frames["flags"].tolist() == [0, 0, 0, 0, 0, 2, 0, 0]
    taps = run.events[run.events["kind"] == EventKind.SYNC_TAP.value]
    assert taps["t_s"].tolist() == [0.5, 0.75]


@pytest.mark.parametrize(
    ("text", "names", "row"),
    [
        ("t;F\n0,5;1,5\n1;2\n", ("t", "F"), [0.5, 1.5]),
        ("t,F\n0.5,1.5\n1,2\n", ("t", "F"), [0.5, 1.5]),
        ("0.5\t1.5\n1\t2\n", ("1", "2"), [0.5, 1.5]),
    ],
)
def test_tables_are_read_whatever_stands_between(
    here: Path, text: str, names: tuple[str, ...], row: list[float]
) -> None:
    (here / "t.txt").write_text(text)
    table = read_foreign_table(here / "t.txt")
    assert table.names == names
    assert table.values[0].tolist() == row


@pytest.mark.parametrize(
    ("text", "message"),
    [("no numbers here\n", "no table of numbers"), ("t\tF\n0\t1\n1\tx\n", "t.txt:3")],
)
def test_what_is_no_table_is_refused(here: Path, text: str, message: str) -> None:
    (here / "t.txt").write_text(text)
    with pytest.raises(DataError, match=message):
        read_foreign_table(here / "t.txt")


@pytest.mark.parametrize("text", ["1=a", "time=t", "time=t,9=a", "time", "time=t,x=a"])
def test_maps_that_map_nothing_are_refused(text: str) -> None:
    with pytest.raises(UsageError, match="allowed: time=COLUMN"):
        ColumnMap.parse(text)


def test_two_clocks_are_matched_by_two_events() -> None:
    clock = ClockMap.of([(2.31, 1.04), (58.77, 57.49)])
    assert clock.to_table_s(1.04) == pytest.approx(2.31)
    assert clock.to_table_s(57.49) == pytest.approx(58.77)
    with pytest.raises(UsageError, match="off the table's"):
        ClockMap.of([(2.0, 1.0), (58.0, 50.0)])


def test_a_zero_is_taken_at_rest_and_without_load() -> None:
    rng = np.random.default_rng(1)
    zero = take_zero(0.004 + 1e-4 * rng.standard_normal(200), NOW, "1234567", 3)
    assert zero.zero_mv_per_v == pytest.approx(0.004, abs=3e-5)
    assert zero.spread_mv_per_v == pytest.approx(1e-4, rel=0.2)
    with pytest.raises(CheckError, match="cable 3 is not at rest"):
        take_zero(np.linspace(0.0, 0.01, 100), NOW, "1234567", 3)
    with pytest.raises(CheckError, match="cable 3 carries a load"):
        take_zero(np.full(10, 0.2), NOW, "1234567", 3)


def test_zeros_reach_the_tensions_and_the_start_record(rig: Rig, here: Path) -> None:
    from rig_stand_ins import motion, virtual_clock

    from rig.recorder import record
    from rig.simulated.rig import assemble

    zero = take_zero(np.full(10, 0.02), NOW, "SIM0001", 1)
    write_zeros(here / "zeros.json", Zeros(cables={1: zero}))
    zeros = read_zeros(here / "zeros.json")
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    record(
        rig,
        rig_text(),
        here / "run",
        excitation=motion(0.5),
        clock=clock,
        machine=machine,
        zeros=zeros,
    )
    run = load_run(here / "run")
    # 0.02 of 1 mV/V of 50 N is 1 N.
    assert run.cable_tension(1)["tension_n"].mean() == pytest.approx(7.0 - 1.0, abs=0.01)
    assert run.start.nodes[0].zero_mv_per_v == 0.02
    assert run.start.nodes[0].zero_taken == NOW.isoformat()
    assert run.start.nodes[1].zero_taken == "never"
    with pytest.raises(DataError, match="'SIM0001', and '7654321' is on it now"):
        check_zeros(zeros, {1: "7654321"})


def test_the_simulated_rig_hangs_in_its_cables_so_its_zeros_are_refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rig.simulated import plant

    monkeypatch.setattr(plant, "simulate_platform", lambda *_: WavePlatform())
    assert run_app(app, ["zero", "--for", "0.3"]) == 1
    assert "carries a load" in capsys.readouterr().err
    assert not Path("zeros.json").exists()


def test_pretension_tells_what_to_turn(
    rig: Rig, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rig.simulated import plant

    monkeypatch.setattr(plant, "simulate_platform", lambda *_: WavePlatform())
    assert run_app(app, ["pretension", "--for", "1"]) == 1
    told = capsys.readouterr()
    target = float(rig.cable[0].pretension_n.value)
    assert f"cable 1:    7.00 N of {target:g} N (-" in told.out
    assert told.out.splitlines()[0].endswith("N): pull")
    assert "not at their targets" in told.err


def test_the_doctor_says_one_verdict_a_line(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {line.split()[1] for line in lines} >= {"versions", "port", "camera", "disk", "writing"}
    text = packaged_rig_path().read_text(encoding="utf-8")
    (here / "rig.toml").write_text(text.replace('port = "simulated"', 'port = "/dev/ttyUSB7"'))
    assert run_app(app, ["doctor"]) == 1
    told = capsys.readouterr()
    assert "FAIL  port       /dev/ttyUSB7 is not there" in told.out
    assert "plug the adapter in" in told.out


def test_a_motion_that_would_let_a_cable_go_slack_is_warned_of(rig: Rig) -> None:
    small = rig.excitation.model_copy(update={"amplitude_deg": 0.1})
    large = rig.excitation.model_copy(update={"amplitude_deg": 30.0})
    assert slack_warning(rig, small) is None
    assert "near slack" in slack_warning(rig, large)
    assert min(least_tension_n(rig, large).values()) < 0


@pytest.mark.parametrize(
    ("text", "seconds"), [("12:30", 1800.0), ("12:00:05", 5.0), ("11:00", 23 * 3600.0)]
)
def test_until_is_the_next_time_the_clock_shows_it(text: str, seconds: float) -> None:
    assert seconds_until(text, datetime(2024, 1, 1, 12, 0, tzinfo=UTC)) == seconds
    with pytest.raises(UsageError, match="no time of day"):
        seconds_until("noon", NOW)


def pull_with_log(here: Path, log: str) -> list[str]:
    (here / "pull.asc").write_text(CATMAN, encoding="cp1252")
    (here / "winch.log").write_text(log)
    return [
        *("import", "--tension", "pull.asc", "--name", "pull"),
        *("--map", "time=Zeit,1=Kraft 1,2=Kraft 2", "--command", "winch.log"),
    ]


def test_a_winch_log_is_imported_beside_the_tensions(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = "t;L1;E2\n100.0;2.0;10\n100.01;2.1;\n100.02;2.2;12\n"
    arguments = pull_with_log(here, log)
    columns = ["--command-map", "time=t,1=L1,2.measured_deg=E2", "--command-sync", "0.01=100.02"]
    assert run_app(app, [*arguments, *columns]) == 0
    run = load_run(here / "runs" / "pull")
    rows = run.command
    assert rows is not None
    first = rows[rows["cable"] == 1]
    assert list(first["t_s"]) == pytest.approx([-0.01, 0.0, 0.01])
    assert list(first["commanded_m"]) == [2.0, 2.1, 2.2]
    assert list(rows[rows["cable"] == 2]["measured_deg"]) == [10, 12]
    assert list(first["log_s"]) == [100.0, 100.01, 100.02]
    assert rows["arrived_s"].isna().all()
    assert "winch.log: time=t" in run.start.model_dump()["command_log"]
    assert not (run.folder / "command.txt").exists()
    found = {each.what: each.words for each in verify(run)}
    assert found["command"].startswith("5 rows of 2 cables, 100.0/s")


@pytest.mark.parametrize(
    ("log", "more", "code", "message"),
    [
        ("t;L1\n1;2\nbroken\n", ["--command-map", "time=t,1=L1"], 3, "winch.log:3: the line"),
        ("t;L1\n1;2\n", ["--command-map", "1=L1"], 3, "holds no rows with a time"),
        ("t;L1\n1;2\n", ["--command-map", "time=t,1=L7"], 2, "--command-map names the column"),
        ("t;L1\n1;2\n", [], 2, "the command log's columns are t, L1"),
        ("nothing\n", ["--command-map", "time=t,1=L1"], 3, "holds no row"),
        ("t;L1\n1;2\n", ["--command-sync", "1"], 2, "--command-sync '1' is no pair of times"),
    ],
)
def test_a_winch_log_that_does_not_fit_is_refused(
    here: Path,
    log: str,
    more: list[str],
    code: int,
    message: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_app(app, [*pull_with_log(here, log), *more]) == code
    assert message in capsys.readouterr().err
    assert not (here / "runs").exists()
