"""Killed, cut and full: what was written before stays, and nothing is made up."""

import os
import random
import shutil
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import WavePlatform, motion, record_virtually, rig_text
from test_real_time import start

from cdpr8.clock import RealClock
from cdpr8.errors import DataError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, TableWriter, load_run, read_video
from rig.recorder import record
from rig.scribe import FLUSH_S
from rig.simulated.rig import assemble

STATED_LOSS_S = FLUSH_S + 0.05
"""docs/recording.md: what kill -9 can take of the tensions."""

needs_terminals = pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")


def true(run: Run) -> bool:
    """Whether every good value is that of its own cable at its own time."""
    platform = WavePlatform(3.0)
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        times = np.maximum(rows["t_s"].to_numpy(dtype=float), 0.0)
        error = np.abs(rows["tension_n"].to_numpy() - platform.tension_at(cable, times))
        if len(error) and (error.max() > 1.0 or np.median(error) > 0.05):
            return False
    return True


def kill_after(folder: Path, seconds: float) -> float:
    """Kill a recording; returns how much of the tensions it took, in s of the run."""
    process = start(folder, 60.0)
    time.sleep(seconds)
    killed_s = time.monotonic_ns() * 1e-9
    process.send_signal(signal.SIGKILL)
    process.wait()
    run = load_run(folder)
    assert run.stop is None
    assert true(run)
    frames = len(list(read_video(run.video)))
    assert 0 <= len(run.frames) - frames <= 8
    origin_s = float((folder.parent / "origin.txt").read_text())
    return killed_s - origin_s - float(run.tension["received_s"].max())


@needs_terminals
def test_kills_lose_less_than_is_stated(tmp_path: Path) -> None:
    draws = random.Random(1)
    for number in range(2):
        folder = tmp_path / str(number) / "run"
        folder.parent.mkdir()
        assert kill_after(folder, draws.uniform(0.0, 1.0)) < STATED_LOSS_S + 0.2  # a busy computer


@needs_terminals
@pytest.mark.slow
def test_a_hundred_kills_lose_less_than_is_stated(
    tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    draws, lost = random.Random(2), []
    for number in range(100):
        folder = tmp_path / str(number) / "run"
        folder.parent.mkdir()
        lost.append(kill_after(folder, draws.uniform(0.0, 2.0)))
        shutil.rmtree(folder)
    record_property("lost_s", sorted(lost))
    assert max(lost) < STATED_LOSS_S
    assert np.median(lost) < STATED_LOSS_S


@pytest.mark.parametrize("every", [97, pytest.param(1, marks=pytest.mark.slow)])
def test_a_run_cut_anywhere_loads(rig: Rig, tmp_path: Path, every: int) -> None:
    record_virtually(rig, tmp_path / "whole", 0.12)
    whole = load_run(tmp_path / "whole")
    for name in ("tension.csv", "frames.csv", "events.csv"):
        data = (tmp_path / "whole" / name).read_bytes()
        cut = tmp_path / "cut"
        shutil.copytree(tmp_path / "whole", cut, dirs_exist_ok=True)
        for at in range(0, len(data), every):
            (cut / name).write_bytes(data[:at])
            run = load_run(cut)
            table = getattr(run, name.removesuffix(".csv"))
            assert len(table) == max(0, data[:at].count(b"\n") - 1)
        (cut / name).write_bytes(data)
    assert len(whole.tension) > 50


def test_a_video_cut_anywhere_gives_its_whole_frames(rig: Rig, tmp_path: Path) -> None:
    record_virtually(rig, tmp_path / "run", 3.0)
    path = tmp_path / "run" / "video.mkv"
    data = path.read_bytes()
    images = [image.copy() for image, _ in read_video(path)]
    draws = random.Random(3)
    clusters = [at for at in range(len(data) - 4) if data[at : at + 4] == b"\x1f\x43\xb6\x75"]
    assert len(clusters) > 5
    offsets = [edge + step for edge in clusters for step in (-1, 0, 1)]
    offsets += [draws.randrange(len(data)) for _ in range(500)]
    for at in offsets:
        path.write_bytes(data[:at])
        try:
            found = [image.copy() for image, _ in read_video(path)]
        except DataError:
            # Nothing but a heading, or not one whole frame.
            assert at <= clusters[1]
            continue
        assert all(np.array_equal(one, other) for one, other in zip(found, images, strict=False))
        # Whole clusters before the cut are there.
        assert len(found) >= 3 * (sum(edge < at for edge in clusters) - 2)


def test_a_full_disk_ends_the_run_in_order_with_its_stop_record(
    rig: Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reserve = tmp_path / "run" / ".reserve"
    sync = TableWriter.sync
    syncs: list[bool] = []

    def full_after_three(self: TableWriter) -> None:
        syncs.append(reserve.exists())
        if len(syncs) > 6 and reserve.exists():
            raise OSError(28, "No space left on device")
        sync(self)

    monkeypatch.setattr(TableWriter, "sync", full_after_three)
    clock = RealClock()
    machine = assemble(rig, WavePlatform(3.0), None, clock, seed=1)
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(20.0), clock=clock, machine=machine
    )
    assert isinstance(recording.fault, DataError)
    assert "the disk is full" in recording.fault.sentence()
    run = load_run(tmp_path / "run")
    assert run.stop.reason == "disk_full"
    assert run.stop.t_s < 5.0
    assert not reserve.exists()
    counts = run.tension["cable"].value_counts().sort_index().to_dict()
    assert run.stop.samples == counts
    assert "disk_full" in set(run.events["kind"])


def test_a_run_leaves_no_reserve_behind(rig: Rig, tmp_path: Path) -> None:
    record_virtually(rig, tmp_path / "run", 0.3, camera=False)
    assert not (tmp_path / "run" / ".reserve").exists()


@needs_terminals
def test_three_signals_exit_at_once_and_the_run_loads(tmp_path: Path) -> None:
    process = start(tmp_path / "run", 60.0)
    for _ in range(3):
        process.send_signal(signal.SIGINT)
        time.sleep(0.002)
    assert process.wait(10.0) is not None
    assert true(load_run(tmp_path / "run"))
