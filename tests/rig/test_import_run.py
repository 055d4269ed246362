"""`rig import`: tables, videos and winch logs of other programs become a run, or are refused."""

from pathlib import Path

import av
import numpy as np
import pytest

from cdpr8.errors import DataError, UsageError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import EventKind, load_run
from cdpr8.terminal import run_app
from rig.command import app
from rig.foreign import ClockMap, ColumnMap
from rig.foreign_table import read_foreign_table
from rig.verify import verify

pytestmark = pytest.mark.usefixtures("here")


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
    rng = np.random.default_rng(1)
    with av.open(str(here / "test.avi"), "w") as avi:
        stream = avi.add_stream("ffv1", rate=16)
        stream.width, stream.height, stream.pix_fmt = 32, 24, "gray"
        picture = rng.integers(0, 255, (24, 32), dtype=np.uint8)
        for number in range(8):
            if number != 5:  # one picture comes twice
                picture = rng.integers(0, 255, (24, 32), dtype=np.uint8)
            avi.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="gray")))
        avi.mux(stream.encode())
    arguments = ["import", "--video", "test.avi", "--tension", "test.asc", "--map"]
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
        ("t F\n0.5 1.5\n1  2\n", ("t", "F"), [0.5, 1.5]),
        ("t\tF\n0,5\t1,5\t\n1\t2\t\n", ("t", "F"), [0.5, 1.5]),  # a separator ends the lines
        ("t\tF\t\n0,5\t1,5\t\n1\t\t\n", ("t", "F"), [0.5, 1.5]),
        ("t;F\n05.03.2024 10:00:00,5;1,5\n05.03.2024 10:00:01;2\n", ("t", "F"), [0.0, 1.5]),
        ("t,F\n10:00:00,1.5\n10:00:01.25,2\n", ("t", "F"), [0.0, 1.5]),
    ],
)
def test_tables_are_read_whatever_stands_between(
    here: Path, text: str, names: tuple[str, ...], row: list[float]
) -> None:
    (here / "t.txt").write_text(text)
    table = read_foreign_table(here / "t.txt")
    assert table.names == names
    assert table.values[0].tolist() == row


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "cp1252"])
def test_a_table_is_read_in_whatever_encoding(here: Path, encoding: str) -> None:
    (here / "t.txt").write_text("Zeit\tKraft größer\n0,5\t1,5\n1\tNaN\n", encoding=encoding)
    table = read_foreign_table(here / "t.txt")
    assert table.names == ("Zeit", "Kraft größer")
    assert table.values[0].tolist() == [0.5, 1.5]
    assert np.isnan(table.values[1, 1])


def imported(here: Path, text: str, columns: str = "time=t,1=F") -> int:
    (here / "t.txt").write_text(text)
    return run_app(app, ["import", "--tension", "t.txt", "--map", columns, "--name", "run"])


@pytest.mark.parametrize(
    "text",
    [
        "t;F\nms;kN\n500;0,0125\n750;0,5\n",
        "t [ms];F (kN)\n500;0,0125\n750;0,5\n",
    ],
)
def test_units_that_the_table_names_are_converted_and_said(
    here: Path, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert imported(here, text) == 0
    assert "the column 'F' is in kN, and is taken to N" in capsys.readouterr().err
    run = load_run(here / "runs" / "run")
    assert run.tension["t_s"].tolist() == [0.0, 0.25]
    assert run.tension["tension_n"].tolist() == [12.5, 500.0]
    assert "'t' is in ms, and is taken to s" in run.start.import_map


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("t;F\ns;mV/V\n0;1\n1;2\n", 3, "t.txt: the column 'F' is in mV/V"),
        ("t;F\nN;N\n0;1\n1;2\n", 3, "t.txt: the column 't' is in N"),
        ("t;F\n0;1\n1;2\n\n0,5;3\n", 3, "t.txt:5: the time runs backwards: 0.5 s after 1 s"),
        ("t;F\n;1\n;2\n", 3, "the column 't' holds no time"),
        ("t;F\n0;NaN\n1;\n", 3, "the column 'F' holds no number"),
        ("t,F\n0,00,1,25\n0,01,1,30\n", 3, "commas between its columns and in its numbers"),
        ("0,00,1,25\n0,01,1,30\n", 3, "commas between its columns and in its numbers"),
        ("t;F 1;F 2\n0;1;2\n1;2;3\n", 2, "names the column 'F', 2 columns begin so"),
    ],
)
def test_a_table_that_reads_otherwise_than_it_is_meant_is_refused(
    here: Path, text: str, code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert imported(here, text) == code
    assert message in capsys.readouterr().err
    assert not (here / "runs" / "run").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [("no numbers here\n", "no table of numbers"), ("t\tF\n0\t1\n1\tx\n", "t.txt:3")],
)
def test_what_is_no_table_is_refused(here: Path, text: str, message: str) -> None:
    (here / "t.txt").write_text(text)
    with pytest.raises(DataError, match=message):
        read_foreign_table(here / "t.txt")


@pytest.mark.parametrize(
    "text",
    [
        *("1=a", "time=t", "time=t,9=a", "time", "time=t,x=a"),
        *("time=t,time=u,1=a", "time=t,1=a,1=b", "time=t,1=a,2=a", "time=t,1=t"),
    ],
)
def test_maps_that_map_nothing_are_refused(text: str) -> None:
    with pytest.raises(UsageError, match="allowed: time=COLUMN"):
        ColumnMap.parse(text)


def test_two_clocks_are_matched_by_two_events() -> None:
    clock = ClockMap.of([(2.31, 1.04), (58.77, 57.49)])
    assert clock.to_table_s(1.04) == pytest.approx(2.31)
    assert clock.to_table_s(57.49) == pytest.approx(58.77)
    with pytest.raises(UsageError, match="names no time"):
        ClockMap.of([(float("nan"), 1.0)])
    with pytest.raises(UsageError, match="off the table's"):
        ClockMap.of([(2.0, 1.0), (58.0, 50.0)])


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
