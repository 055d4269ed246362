"""`rig record` and `rig scan` as a user meets them: what is printed, and the exit code."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from rig_stand_ins import WavePlatform

from cdpr8.rigfile import Rig, packaged_rig_path
from cdpr8.runfolder import load_run
from cdpr8.terminal import run_app
from rig import scan, until
from rig.command import app
from rig.simulated import rig as simulated_rig
from rig.stop import StopRequest


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """The simulated rig with a platform that takes no time to simulate."""
    from rig.simulated import ahead

    monkeypatch.setattr(ahead, "simulate_ahead", lambda *_: WavePlatform(1.0))


def with_port(port: str) -> str:
    text = packaged_rig_path().read_text(encoding="utf-8")
    return text.replace('port = "simulated"', f'port = "{port}"')


@pytest.mark.usefixtures("quick")
def test_a_recording_names_itself_and_the_next_commands(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app(app, ["record", "--duration", "3", "--virtual", "--name", "first"]) == 0
    told = capsys.readouterr()
    assert told.err.splitlines()[0].startswith("recording the simulated rig, no hardware")
    assert "runs/first: 3.0 s, ended by the end of its duration" in told.out
    assert "frames: 48 at 16/s" in told.out
    assert "lost:   nothing" in told.out
    assert "vision track runs/first" in told.out
    assert "analysis compare runs/first" in told.out
    run = load_run(here / "runs" / "first")
    assert run.start.simulated
    assert run.start.excitation.motion_s == 1.0


@pytest.mark.usefixtures("quick")
def test_json_carries_the_result_alone_and_a_seed_repeats_it(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["record", "--virtual", "--seed", "5", "--duration", "3.5", "--amplitude", "1"]
    for name in ("a", "b"):
        assert run_app(app, [*arguments, "--frequency", "0.5", "--out", name, "--json"]) == 0
        result = json.loads(capsys.readouterr().out)
        assert result["run"] == name
        assert (result["seed"], result["frames"], result["fault"]) == (5, 56, None)
        assert result["rate_per_s"]["1"] > 0.9 * 131
    assert (here / "a/tension.csv").read_bytes() == (here / "b/tension.csv").read_bytes()
    motion = load_run(here / "a").start.excitation
    assert (motion.amplitude_deg, motion.frequency_hz, motion.motion_s) == (1.0, 0.5, 1.5)


@pytest.mark.usefixtures("quick")
def test_simulated_overrides_the_port_of_a_rig_file(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "rig.toml").write_text(with_port("/dev/ttyUSB7"))
    assert run_app(app, ["record", "--simulated", "--virtual", "--duration", "3"]) == 0
    (run,) = (here / "runs").iterdir()
    assert load_run(run).start.simulated
    assert load_run(run).rig.bus.port == "/dev/ttyUSB7"  # the file is kept as it was


def test_a_missing_port_is_one_message_and_a_device_error(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "lab.toml").write_text(with_port("/dev/ttyUSB7"))
    assert run_app(app, ["record", "--rig", "lab.toml"]) == 4
    told = capsys.readouterr()
    assert "error: no serial port '/dev/ttyUSB7'" in told.err
    assert 'port = "simulated" needs no hardware' in told.err
    assert not told.out
    assert not (here / "runs").exists()


@pytest.mark.usefixtures("quick")
def test_a_folder_that_holds_something_is_left_alone(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "full").mkdir()
    (here / "full" / "notes.txt").write_text("mine")
    assert run_app(app, ["record", "--virtual", "--out", "full"]) == 3
    assert "full: the run folder is not empty" in capsys.readouterr().err
    assert [path.name for path in (here / "full").iterdir()] == ["notes.txt"]


@pytest.mark.usefixtures("quick")
def test_a_folder_that_cannot_be_written_is_one_message(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "file").write_text("no folder")
    assert run_app(app, ["record", "--virtual", "--out", "file/run"]) == 3
    told = capsys.readouterr().err
    assert "the run folder cannot be written: Not a directory" in told
    assert "Traceback" not in told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--duration", "2"], "--duration 2 leaves 0 s for the motion"),
        (["--duration", "2.5"], "allowed: at least 3 s"),
        (["--out", "a", "--name", "b"], "both name the run folder"),
        (["--name", "../a"], "--name '../a' is no name of a folder"),
        (["--name", ".."], "one name, without /"),
        (["--duration", "-1"], "--duration"),
        (["--amplitude", "90"], "--amplitude"),
    ],
)
def test_what_does_not_fit_is_refused(
    here: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app(app, ["record", *arguments]) == 2
    assert message in capsys.readouterr().err
    assert list(here.iterdir()) == []


def test_hardware_refuses_virtual_time(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "rig.toml").write_text(with_port("/dev/ttyUSB7"))
    assert run_app(app, ["record", "--virtual"]) == 4
    assert "keeps no virtual time" in capsys.readouterr().err


@pytest.mark.usefixtures("quick")
def test_scan_lists_every_amplifier(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["scan", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [node["address"] for node in found] == list(range(1, 9))
    assert [node["cable"] for node in found] == list(range(1, 9))
    assert found[0]["settings"]["BDR"] == "115200,1"
    assert all(node["trouble"] is None for node in found)
    for node in found:  # 50 N are 1 mV/V
        expected = (5.0 + 2.0 * node["address"]) / 50.0
        assert node["signal_mv_per_v"] == pytest.approx(expected, abs=1e-3)


@pytest.mark.usefixtures("quick")
def test_scan_lists_the_amplifier_of_each_port_and_tells_where_there_is_none(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = packaged_rig_path().read_text(encoding="utf-8")
    (here / "rig.toml").write_text(text.replace("output_rate =", "streaming = true\noutput_rate ="))
    assemble = simulated_rig.simulated_nodes

    def some_astray(*those: object) -> object:
        nodes = assemble(*those)
        nodes[1].settings["ADR"] = 4  # found all the same
        nodes[2].powered = False
        return nodes

    monkeypatch.setattr(simulated_rig, "simulated_nodes", some_astray)
    monkeypatch.setattr(scan.scan, "__defaults__", (range(5),))
    assert run_app(app, ["scan", "--json"]) == 0
    told = capsys.readouterr()
    found = {node["cable"]: node for node in json.loads(told.out)}
    assert sorted(found) == [1, 2, 4, 5, 6, 7, 8]
    assert (found[2]["address"], found[7]["address"]) == (4, 7)
    assert len({node["port"] for node in found.values()}) == 7
    assert told.err.count("no amplifier answers on /dev/pts/") == 1


HEAVY = {"av", "cv2", "llvmlite", "matplotlib", "numba", "pandas", "pyarrow", "scipy"}
"""What takes long to import."""


@pytest.mark.parametrize("arguments", [[], ["record"], ["scan"]])
def test_help_has_an_example_and_imports_nothing_that_takes_long(arguments: list[str]) -> None:
    code = "\n".join(
        (
            "import atexit, sys",
            "atexit.register(lambda: print(*sys.modules, file=sys.stderr))",
            "from rig.command import main",
            "main()",
        )
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments, "--help"],
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0
    assert "Example" in done.stdout
    imported = set(done.stderr.split())
    assert "typer" in imported
    assert not HEAVY & imported


def test_the_simulated_rig_is_found_by_its_entry_point(rig: Rig) -> None:
    from importlib import metadata

    (entry,) = (each for each in metadata.entry_points(group="cdpr8.rigs"))
    assert entry.name == rig.bus.port == "simulated"
    assert entry.load() is simulated_rig.open_rig


@pytest.mark.usefixtures("quick")
def test_what_keeps_a_run_from_beginning_is_told_before_it_is_said_to_record(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (here / "notes.txt").write_text("not a folder")
    assert run_app(app, ["record", "--duration", "3", "--out", "notes.txt"]) == 3
    told = capsys.readouterr().err
    assert "notes.txt: is a file, and a run is a folder" in told
    assert "recording 3 s" not in told
    monkeypatch.setattr(until, "seconds_until", lambda *_: 0.5)
    assert run_app(app, ["record", "--until", "12:00"]) == 2
    assert "--until 12:00, in 0.5 s, leaves 0 s for the motion" in capsys.readouterr().err
    monkeypatch.setattr(StopRequest, "requested", True)
    assert run_app(app, ["record", "--duration", "3", "--name", "early"]) == 130
    told = capsys.readouterr().err
    assert f"stopped before anything was recorded; there is no {Path('runs/early')}" in told
