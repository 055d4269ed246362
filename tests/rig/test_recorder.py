"""A whole recording on a virtual clock: repeatable to the byte, and true."""

import json
import time
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import (
    NoisyExposer,
    WavePlatform,
    at_origin,
    motion,
    record_virtually,
    rig_text,
    virtual_clock,
    with_bus,
)

from cdpr8.errors import DataError, DeviceError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import FrameFlag, load_run, read_video
from rig.machine import open_machine
from rig.recorder import LEAD_S, record
from rig.simulated import open_rig
from rig.simulated.rig import assemble
from rig.stop import StopRequest

FILES = {
    "start.json",
    "stop.json",
    "rig.toml",
    "tension.csv",
    "frames.csv",
    "events.csv",
    "video.mkv",
}


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_seed_repeats_ten_seconds_to_the_byte_in_a_few_seconds(rig: Rig, tmp_path: Path) -> None:
    began = time.process_time()
    for name, seed in (("a", 7), ("b", 7), ("c", 8)):
        record_virtually(rig, tmp_path / name, 10.0, platform=WavePlatform(3.0), seed=seed)
    assert time.process_time() - began < 20.0
    a, b, c = (contents(tmp_path / name) for name in "abc")
    assert set(a) == FILES
    assert a == b
    assert a["tension.csv"] != c["tension.csv"]
    assert json.loads(a["start.json"])["id"] != json.loads(c["start.json"])["id"]


def test_the_whole_simulated_rig_repeats_to_the_byte(rig: Rig, tmp_path: Path) -> None:
    for name in "ab":
        clock = virtual_clock()
        machine = open_rig(rig, motion(1.0), clock, seed=3)
        record(
            rig, rig_text(), tmp_path / name, excitation=motion(1.0), clock=clock, machine=machine
        )
    assert contents(tmp_path / "a") == contents(tmp_path / "b")
    images = [image for image, _ in read_video(tmp_path / "a" / "video.mkv")]
    region = rig.camera.region_of_interest
    assert len(images) == 16
    assert images[0].shape == (region.height_px, region.width_px)
    assert images[0].std() > 30  # there is a plate in it


def test_recorded_tensions_are_the_truth_at_the_recorded_times(rig: Rig, tmp_path: Path) -> None:
    platform = WavePlatform(5.0, 2.06)
    record_virtually(rig, tmp_path / "run", 10.0, platform=platform, camera=False)
    run = load_run(tmp_path / "run")
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        times = rows["t_s"].to_numpy()
        error = rows["tension_n"].to_numpy() - platform.tension_at(cable, times)
        # Noise of 5 mN, and the unknown age of a value: uniform over one output period.
        slope = 5.0 * 2 * np.pi * 2.06 / np.sqrt(2)
        expected = np.hypot(0.005, slope / 1200 / np.sqrt(12))
        assert error.std() == pytest.approx(expected, rel=0.15)
        assert abs(error.mean()) < 0.002
        lag = np.polyfit(2 * np.pi * 2.06 * 5.0 * np.cos(2 * np.pi * 2.06 * times), error, 1)[0]
        assert abs(lag) < 1e-4  # no systematic error of time


@pytest.mark.parametrize(
    ("filter_", "output_rate", "delay_s"),
    [(0, 0, 0.0), (3, 0, 0.00398), (4, 2, 0.00884 + 0.00125), (0, 3, 0.00292)],
)
def test_the_filters_delay_is_taken_off_at_reading_and_never_written(
    rig: Rig, tmp_path: Path, filter_: int, output_rate: int, delay_s: float
) -> None:
    # A cut-off at 40 or 18 Hz, a mean over 4 or 8 values of 1200 a second.
    platform = WavePlatform(5.0, 2.06)
    filtered = with_bus(rig, filter=filter_, output_rate=output_rate)
    record_virtually(filtered, tmp_path / "run", 4.0, platform=platform, camera=False)
    run = load_run(tmp_path / "run")
    assert run.start.nodes[0].filter_delay_s == pytest.approx(delay_s, rel=0.01)
    read = run.cable_tension(1)
    written = run.tension[run.tension["cable"] == 1].sort_values("t_s")
    assert (written["t_s"].to_numpy() - read["t_s"]).to_numpy() == pytest.approx(delay_s, rel=0.01)
    late = read[read["t_s"] > 0.5]
    times, phase = late["t_s"].to_numpy(), 2 * np.pi * 2.06
    error = late["tension_n"].to_numpy() - platform.tension_at(1, times)
    lag_s = -np.polyfit(phase * 5.0 * np.cos(phase * times), error, 1)[0]
    assert abs(lag_s) < 6e-4


def test_the_run_says_what_it_is(rig: Rig, tmp_path: Path) -> None:
    recording = record_virtually(rig, tmp_path / "run", 4.0, seed=11)
    run = load_run(tmp_path / "run")
    start, stop = run.start, run.stop
    assert run.notes == ()
    assert (start.simulated, start.seed, start.motion_start_known) == (True, 11, True)
    assert start.clock_anchor.t_s == -LEAD_S
    assert [node.cable for node in start.nodes] == list(range(1, 9))
    assert start.nodes[2].identity == 'HBM,"FIT/5          ","SIM0003",P20'
    assert start.nodes[2].settings["COF"] == "024"
    assert stop.reason == "duration"
    assert stop == recording.stop
    assert stop.t_s == pytest.approx(4.0, abs=0.002)
    assert stop.samples == run.tension["cable"].value_counts().sort_index().to_dict()
    assert stop.frames == len(run.frames) == 64
    assert stop.lost == {}
    assert np.allclose(run.frames["t_s"], 0.0025 + np.arange(64) / 16)
    marks = run.events.set_index("kind")["t_s"]
    assert marks["motion_start"] == run.start.excitation.start_s
    assert marks["motion_end"] == run.start.excitation.end_s
    assert (run.tension["request_s"] < run.tension["received_s"]).all()
    assert run.tension["t_s"].between(-0.001, 4.001).all()


def test_the_start_record_is_on_disk_before_the_run_begins(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), NoisyExposer(), clock)
    seen = []
    at_origin(machine, lambda _: seen.append((tmp_path / "run" / "start.json").read_bytes()))
    record(rig, rig_text(), tmp_path / "run", excitation=motion(0.5), clock=clock, machine=machine)
    assert seen == [(tmp_path / "run" / "start.json").read_bytes()]


def test_a_wish_to_stop_ends_in_order(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    stop = StopRequest()

    class Impatient(WavePlatform):
        def tension_at(self, cable: int, t_s: np.ndarray) -> np.ndarray:
            if t_s.max() > 2.0:
                stop.request()
            return super().tension_at(cable, t_s)

    machine = assemble(rig, Impatient(), NoisyExposer(), clock)
    recording = record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(10.0),
        clock=clock,
        machine=machine,
        stop=stop,
    )
    run = load_run(tmp_path / "run")
    assert recording.stop.reason in ("interrupted", "stopped_at_once")
    assert run.stop == recording.stop
    assert 1.5 < run.stop.t_s < 2.1
    assert "interrupted" in set(run.events["kind"])
    assert "motion_end" not in set(run.events["kind"])


def test_a_stop_before_anything_was_recorded_leaves_no_run(rig: Rig, tmp_path: Path) -> None:
    clock, stop = virtual_clock(), StopRequest()
    stop.request()
    with pytest.raises(KeyboardInterrupt):
        record(
            rig,
            rig_text(),
            tmp_path / "run",
            clock=clock,
            machine=assemble(rig, WavePlatform(), None, clock),
            stop=stop,
        )
    assert not (tmp_path / "run").exists()


def test_nothing_recorded_is_overwritten_and_no_device_is_opened(rig: Rig, tmp_path: Path) -> None:
    record_virtually(rig, tmp_path / "run", 0.5, camera=False)
    before = contents(tmp_path / "run")
    with pytest.raises(DataError, match="not empty"):
        record(with_bus(rig, port="/dev/no-such-port"), rig_text(), tmp_path / "run")
    assert contents(tmp_path / "run") == before


def test_hardware_keeps_no_virtual_time(rig: Rig) -> None:
    with pytest.raises(DeviceError, match="keeps no virtual time"):
        open_machine(with_bus(rig, port="/dev/ttyUSB0"), rig.excitation, virtual_clock())


def test_a_line_that_goes_away_ends_the_run_with_a_stop_record(rig: Rig, tmp_path: Path) -> None:
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), NoisyExposer(), clock)
    write = machine.transport.write

    def unplugged(data: bytes) -> None:
        if clock.now_s > 3.0:
            raise DeviceError("the port is gone: Input/output error")
        write(data)

    machine.transport.write = unplugged
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(10.0), clock=clock, machine=machine
    )
    assert isinstance(recording.fault, DeviceError)
    run = load_run(tmp_path / "run")
    assert run.stop.reason == "device"
    assert run.tension["t_s"].max() > 0.9


def test_a_run_stopped_before_its_first_frame_loads(rig: Rig, tmp_path: Path) -> None:
    clock, stop = virtual_clock(), StopRequest()
    machine = assemble(rig, WavePlatform(), NoisyExposer(), clock)
    at_origin(machine, lambda _: stop.request())
    record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(1.0),
        clock=clock,
        machine=machine,
        stop=stop,
    )
    run = load_run(tmp_path / "run")
    assert (run.stop.reason, run.stop.frames, len(run.tension)) == ("interrupted", 0, 0)


def test_a_picture_that_comes_twice_is_flagged(rig: Rig, tmp_path: Path) -> None:
    class Frozen(NoisyExposer):
        def expose(self, t_mid_s: float) -> np.ndarray:
            if 0.5 < t_mid_s < 0.7:
                return np.full((self.height_px, self.width_px), 7, np.uint8)
            return super().expose(t_mid_s)

    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), Frozen(), clock)
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(1.0), clock=clock, machine=machine
    )
    flags = load_run(tmp_path / "run").frames["flags"].to_numpy()
    assert (flags & FrameFlag.REPEATED > 0).sum() == recording.stop.lost["frame_repeated"] == 3
