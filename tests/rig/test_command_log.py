"""The winch controller's log beside the tensions: every line kept, the clocks tied by arrival."""

import json
import socket
import threading
from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rig_stand_ins import WavePlatform, at_origin, motion, record_virtually, rig_text, virtual_clock
from slow_motion import SlowMotion, slowed

from cdpr8.errors import DataError, DeviceError, UsageError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import (
    ClockAnchor,
    EventKind,
    Run,
    RunWriter,
    StartRecord,
    document,
    load_run,
)
from cdpr8.runfolder.tables import COMMAND
from cdpr8.terminal import run_app
from rig.arrival_clock import ArrivalClock
from rig.command import app
from rig.command_columns import QUANTITIES, CommandColumns, LineReader
from rig.command_log import CommandLog, open_command_log
from rig.command_stream import CommandStream
from rig.ending import Recording
from rig.finding import Verdict
from rig.lines import CommandLine
from rig.recorder import record
from rig.scribe import DirectScribe
from rig.simulated.rig import assemble
from rig.streams import Span
from rig.tally import Tally
from rig.verify import verify

MAP = "time=t,1=L1,2=L2,2.measured_deg=E2"


Act = Callable[[Callable[[float], None]], None]
"""Writes a log; given what waits until a time of the run."""


def recorded(
    rig: Rig, folder: Path, log: CommandLog, seconds: float, act: Act
) -> tuple[Recording, Run]:
    """A recording of `seconds`, while `act` writes a log on a thread of its own."""
    clock = SlowMotion()
    machine = slowed(assemble(rig, WavePlatform(), None, clock, seed=1), clock)

    def act_beside(origin_s: float) -> None:
        def until(t_s: float) -> None:
            clock.sleep_until(origin_s + t_s)

        threading.Thread(target=act, args=(until,), daemon=True).start()

    at_origin(machine, act_beside)
    recording = record(
        rig,
        rig_text(),
        folder,
        excitation=motion(seconds),
        clock=clock,
        machine=machine,
        command_log=log,
    )
    return recording, load_run(folder)


def line(number: int, ahead_s: float) -> str:
    """A row each 10 ms on a clock that is ahead of the run's."""
    return f"{ahead_s + number / 100:.3f};{2.0 + number / 1000:.4f};2.5;{number}\n"


def writing(write: Callable[[str], None], count: int) -> Act:
    def act(until: Callable[[float], None]) -> None:
        for number in range(count):
            until(number / 100)
            write(line(number, 5000.0))

    return act


def assert_tied(run: Run, count: int) -> None:
    table = run.command
    assert table is not None
    first = table[table["cable"] == 1]
    assert len(first) == count
    assert np.allclose(first["commanded_m"], 2.0 + np.arange(count) / 1000)
    second = table[table["cable"] == 2]
    assert np.allclose(second["measured_deg"], np.arange(count))
    assert second["measured_m"].isna().all()
    # Row n was written at n / 100 s of the run; looked at every 20 ms, on a busy computer.
    late_s = first["t_s"] - np.arange(count) / 100
    assert (late_s >= 0.0).all()
    assert late_s.iloc[-20:].max() < 0.03
    assert (first["arrived_s"] >= first["t_s"] - 1e-6).all()
    assert np.allclose(first["log_s"], 5000.0 + np.arange(count) / 100)


def test_a_growing_file_is_recorded_and_kept_as_it_came(rig: Rig, tmp_path: Path) -> None:
    path = tmp_path / "winch.csv"
    path.write_text("Winch log of today\nt;L1;L2;E2\n4999.98;1.0;2.5;-1\n4999.99;1.0")
    log = open_command_log(str(path), MAP)
    path.write_text(path.read_text()[:-11])  # the controller begins at a whole line
    file = path.open("a")

    def write(text: str) -> None:
        file.write(text)
        file.flush()

    def act(until: Callable[[float], None]) -> None:
        writing(write, 60)(until)
        write("trip of the safety relay\n")

    recording, run = recorded(rig, tmp_path / "run", log, 1.0, act)
    file.close()
    assert recording.commands == 120
    assert_tied(run, 60)
    assert recording.stop.lost["command_line"] == 1
    said = run.events[run.events["kind"] == "command_log"]["detail"]
    assert said.str.contains("safety relay").sum() == 1
    kept = (tmp_path / "run" / "command.txt").read_bytes().splitlines()
    assert [each.split(b"\t", 1)[1].decode() for each in kept] == [
        *(line(number, 5000.0).rstrip() for number in range(60)),
        "trip of the safety relay",
    ]
    assert json.loads((tmp_path / "run" / "start.json").read_text())["command_log"].endswith(MAP)


def test_lines_over_tcp_are_recorded_and_a_lost_connection_is_told(
    rig: Rig, tmp_path: Path
) -> None:
    server = socket.create_server(("127.0.0.1", 0))
    log = open_command_log(f"tcp://127.0.0.1:{server.getsockname()[1]}", MAP.replace("t,", "1,", 1))

    def act(until: Callable[[float], None]) -> None:
        connection, _ = server.accept()
        connection.sendall(b"t;L1;L2;E2\r\n")
        writing(lambda text: connection.sendall(text.encode()), 40)(until)
        connection.close()

    recording, run = recorded(rig, tmp_path / "run", log, 0.8, act)
    server.close()
    assert_tied(run, 40)
    assert recording.fault is None
    assert recording.stop.lost["command_log_lost"] == 1
    said = run.events[run.events["kind"] == "command_log"]["detail"]
    assert said.str.contains("is lost: the other side closed the connection").any()


def test_a_run_without_a_log_has_no_file_and_no_key_of_it(rig: Rig, tmp_path: Path) -> None:
    record_virtually(rig, tmp_path / "run", 0.3, camera=False)
    assert load_run(tmp_path / "run").command is None
    assert not list((tmp_path / "run").glob("command*"))
    assert "command_log" not in json.loads((tmp_path / "run" / "start.json").read_text())


def test_rows_obey_their_schema_and_a_torn_last_line_is_dropped(rig: Rig, tmp_path: Path) -> None:
    path = tmp_path / "winch.csv"
    path.write_text("")
    log, clock = open_command_log(str(path), MAP), virtual_clock()
    start = StartRecord(
        id="test",
        simulated=True,
        rig_file="rig.toml",
        rig_sha256="0" * 64,
        excitation=rig.excitation,
        motion_start_known=False,
        clock_anchor=ClockAnchor(t_s=0.0, wall=clock.wall()),
        command_log=log.description,
    )
    writer, tally = RunWriter(tmp_path / "run", start, rig_text()), Tally()
    stream = CommandStream(log, DirectScribe(writer, tally), tally, Span(0.0, 0.1), clock)
    path.write_text("t;L1;L2;E2\n" + "".join(line(number, 0.0) for number in range(5)))
    while stream.step():
        pass
    writer.close()
    command = tmp_path / "run" / "command.csv"
    schema = document.schemas()["command.row.schema.json"]
    run = load_run(tmp_path / "run")
    table = json.loads(run.command.to_json(orient="records"))
    assert len(table) == tally.commands == 10
    for row in table:
        jsonschema.validate(row, schema)
    command.write_bytes(command.read_bytes()[:-3])
    cut = load_run(tmp_path / "run")
    assert len(cut.command) == 9
    assert any("command.csv: torn last line" in each for each in cut.notes)


@pytest.mark.parametrize(
    ("lines", "map_", "expected"),
    [
        ("0,5\t1,25\n", "time=1,3=2", (3, {"commanded_m": 1.25}, 0.5)),
        ("t;L\n1500;2\n", "time_ms=t,3=L", (3, {"commanded_m": 2.0}, 1.5)),
        ("zeit;w\n1;1250\n", "time=zeit,3.measured_mm=w", (3, {"measured_m": 1.25}, 1.0)),
        ("1.5 3.141592653589793\n", "1.commanded_rad=2", (1, {"commanded_deg": 180.0}, None)),
        (
            "log_s,cable,measured_deg,note\n7.5,4,90,\n",
            None,
            (4, {"measured_deg": 90.0}, 7.5),
        ),
        (
            "2024-05-01T10:00:00+00:00;2.5\n",
            "time=1,8=2",
            (8, {"commanded_m": 2.5}, 1714557600.0),
        ),
    ],
)
def test_logs_of_many_kinds_are_read(
    lines: str, map_: str | None, expected: tuple[int, dict[str, float], float | None]
) -> None:
    reader = LineReader(CommandColumns.parse(map_))
    found = [each for row in lines.splitlines() for each in reader.read(row.encode())]
    (command,) = found
    assert command.cable == expected[0]
    assert command.values == pytest.approx(expected[1])
    assert command.log_s == expected[2]


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=400))
def test_arbitrary_lines_end_nothing_and_are_all_kept(data: bytes) -> None:
    class Source:
        name = "noise"

        def heading(self) -> tuple[bytes, ...]:
            return ()

        def read(self, now_s: float) -> bytes:
            return data

        def close(self) -> None: ...

    class Taker:
        def __init__(self) -> None:
            self.lines: list[CommandLine] = []

        def command(self, line: CommandLine) -> None:
            self.lines.append(line)

        def event(self, t_s: float, kind: EventKind, detail: str) -> None: ...

    clock, taker = virtual_clock(), Taker()
    log = CommandLog(Source(), CommandColumns.parse(MAP))
    CommandStream(log, taker, Tally(), Span(0.0, 0.0), clock).step()
    kept = b"\n".join(each.raw for each in taker.lines)
    assert kept.replace(b"\r", b"") == data.removesuffix(b"\n").replace(b"\r", b"")
    for each in taker.lines:
        assert all(set(row.values) <= set(QUANTITIES) for row in each.rows)


def test_a_line_written_while_the_log_is_read_is_not_early() -> None:
    clock, lines = virtual_clock(), list[CommandLine]()

    class Slow:
        """A busy computer: time passes between the look and the reading."""

        name = "slow"

        def heading(self) -> tuple[bytes, ...]:
            return (b"t;L1;L2;E2",)

        def read(self, now_s: float) -> bytes:
            clock.advance(0.005)
            written = line(0, clock.now_s)
            clock.advance(0.001)
            return written.encode()

        def close(self) -> None: ...

    class Taker:
        def command(self, line: CommandLine) -> None:
            lines.append(line)

        def event(self, t_s: float, kind: EventKind, detail: str) -> None: ...

    span = Span(clock.now_s, clock.now_s + 0.1)
    stream = CommandStream(
        CommandLog(Slow(), CommandColumns.parse(MAP)), Taker(), Tally(), span, clock
    )
    while stream.step():
        pass
    assert len(lines) > 3
    for each in lines:
        assert each.arrived_s >= each.rows[0].log_s
        assert each.rows[0].log_s <= each.rows[0].t_s <= each.arrived_s + 1e-9


def test_the_quickest_of_late_lines_tells_the_time() -> None:
    rng = np.random.default_rng(1)
    clock, errors = ArrivalClock(), []
    for number in range(6000):
        true_s = number / 100
        log_s = 5000.0 + true_s * (1 + 50e-6)
        clock.add(log_s, true_s + rng.exponential(0.02))
        errors.append(clock.run_s(log_s) - true_s)
    assert np.abs(errors[500:]).max() < 2e-3
    clock.add(0.0, 60.5)  # the controller was started anew
    assert clock.run_s(0.0) == 60.5


@pytest.mark.parametrize(
    ("where", "map_", "error", "message"),
    [
        ("log.csv", "time=t,9=L1", UsageError, "'9' is neither `time` nor a cable"),
        ("log.csv", "1.length=L1", UsageError, "'length' is no quantity"),
        ("log.csv", "time=t", UsageError, "it names no cable"),
        ("log.csv", "time", UsageError, "'time' is no key=column"),
        ("log.csv", "time=t,1=Lx", UsageError, "--command-map names the column 'Lx'"),
        ("log.csv", None, UsageError, "the command log's columns are t, L1"),
        ("no/such/log.csv", MAP, DataError, "its folder is not there"),
        ("tcp://host", MAP, UsageError, "is no address"),
        ("tcp://127.0.0.1:1", MAP, DeviceError, "nobody sends a command log"),
    ],
)
def test_a_log_that_cannot_be_is_told_before_the_run(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    where: str,
    map_: str | None,
    error: type[Exception],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text("t;L1\n0;1\n")
    with pytest.raises(error, match=message):
        open_command_log(where, map_)


def test_virtual_time_and_a_log_do_not_go_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text("t;L1\n0;1\n")
    record_it = ["record", "--simulated", "--virtual", "--duration", "3"]
    assert run_app(app, [*record_it, "--command-log", "log.csv", "--command-map", "1=L1"]) == 2
    assert "a command log comes in real time" in capsys.readouterr().err
    assert run_app(app, [*record_it, "--command-map", "1=L1"]) == 2
    assert "--command-map without --command-log" in capsys.readouterr().err


def test_a_log_whose_time_is_not_in_seconds_fails_its_check(rig: Rig, tmp_path: Path) -> None:
    record_virtually(rig, tmp_path / "run", 3.0, camera=False)
    rows = [f"{n / 10},1,2.0,,,,{100 * n},{n / 10}" for n in range(30)]
    heading = ",".join(column.name for column in COMMAND.columns)
    (tmp_path / "run" / "command.csv").write_text("\n".join([heading, *rows, ""]))
    (found,) = (each for each in verify(load_run(tmp_path / "run")) if each.what == "command")
    assert found.verdict is Verdict.FAIL
    assert "its clock runs 1000 times as fast as the run's: is it in s?" in found.words


def test_what_the_log_held_before_the_run_began_makes_its_clock_not_run_fast(
    rig: Rig, tmp_path: Path
) -> None:
    record_virtually(rig, tmp_path / "run", 3.0, camera=False)
    # Three seconds of it were written while the amplifiers were being set up.
    rows = [f"{n / 10},1,2.0,,,,{100 + n / 10},{max(0.0, n / 10)}" for n in range(-30, 30)]
    heading = ",".join(column.name for column in COMMAND.columns)
    (tmp_path / "run" / "command.csv").write_text("\n".join([heading, *rows, ""]))
    (found,) = (each for each in verify(load_run(tmp_path / "run")) if each.what == "command")
    assert found.verdict is Verdict.OK
    assert "60 rows of 1 cables, 10.0/s" in found.words
    assert "noticed up to 0 ms late" in found.words
