"""Killed, cut and full: what was written before stays, and nothing is made up."""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from recording_process import ENDED_S, arrived_s, run_s, start
from rig_stand_ins import NoisyExposer, WavePlatform, at_origin, motion, record_virtually, rig_text
from slow_motion import PACE, SlowMotion, slowed

from cdpr8.clock import Clock, RealClock
from cdpr8.errors import DataError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, TableWriter, load_run, read_video
from cdpr8.runfolder.video import VideoWriter
from rig.amplifier.profile import FIT
from rig.recorder import record
from rig.scribe import FLUSH_S
from rig.simulated.rig import assemble

STATED_LOSS_S = FLUSH_S + 0.05
"""docs/recording.md: what kill -9 can take of the tensions."""

STATED_VIDEO_LOSS_S = 0.5
STATED_POWER_LOSS_S = 0.35
STATED_POWER_VIDEO_LOSS_S = 0.8
"""The same of the video, and what a power cut can take."""

BUSY_S = 0.5
"""How long other programs may keep a recording from its turn."""

needs_terminals = pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")


def true(run: Run) -> bool:
    """Whether every good value is its own cable's, of the time between question and answer.

    A value is up to two output periods older than the question; in the time in question the tension
    moves no faster than its wave, and the noise is within 8 sigma.
    """
    platform = WavePlatform(3.0)
    steepest_n_per_s = 2 * np.pi * platform.frequency_hz * platform.amplitude_n
    for cable in range(1, 9):
        rows = run.cable_tension(cable)
        first_s = rows["request_s"].to_numpy(dtype=float) - 2 * FIT.period_s(0)
        last_s = rows["received_s"].to_numpy(dtype=float)
        t_s = rows["t_s"].to_numpy(dtype=float)
        middle_s = np.maximum((first_s + last_s) / 2, 0.0)
        error = np.abs(rows["tension_n"].to_numpy() - platform.tension_at(cable, middle_s))
        if (error > 0.04 + steepest_n_per_s * (last_s - first_s) / 2).any():
            return False
        if ((t_s < first_s) | (t_s > last_s)).any():
            return False
    return True


def newest_s(folder: Path) -> float:
    """Time of the newest whole row on disk."""
    return float((folder / "tension.csv").read_text().rsplit("\n", 2)[1].split(",")[0])


def now_s() -> float:
    return time.monotonic_ns() * 1e-9


def kill_after(folder: Path, seconds: float, pace: float) -> tuple[float, float]:
    """Kill a recording; returns how much of tensions and of video it took, in s of the run.

    What it took is what had arrived and is not on the disk. That things went on arriving until
    then is checked with room for a busy computer.
    """
    process = start(folder, 60.0, pace)
    time.sleep(seconds)
    expected_s = newest_s(folder)
    killed_s = now_s()
    process.send_signal(signal.SIGKILL)
    process.wait()
    run = load_run(folder)
    assert run.stop is None
    assert any("interrupted" in each for each in run.notes)
    assert true(run)
    assert run.tension["t_s"].max() >= expected_s
    frames = len(list(read_video(run.video)))
    assert 0 < frames <= len(run.frames)
    killed_s = run_s(folder, killed_s)
    tension_s, frame_s = arrived_s(folder)
    assert killed_s - tension_s < BUSY_S
    assert killed_s - frame_s < BUSY_S
    lost_s = tension_s - float(run.tension["received_s"].max())
    return lost_s, frame_s - float(run.frames["t_s"].iloc[frames - 1])


@needs_terminals
def test_a_kill_loses_less_than_is_stated(tmp_path: Path) -> None:
    (tmp_path / "1").mkdir()
    tensions_s, video_s = kill_after(tmp_path / "1" / "run", 3.0, PACE)
    assert tensions_s < STATED_LOSS_S
    assert video_s < STATED_VIDEO_LOSS_S


@needs_terminals
@pytest.mark.slow
def test_a_hundred_kills_lose_less_than_is_stated(
    tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    draws = random.Random(2)
    tensions_s, video_s = [], []
    for number in range(100):
        folder = tmp_path / str(number) / "run"
        folder.parent.mkdir()
        lost = kill_after(folder, draws.uniform(0.0, 2.0), 1.0)
        tensions_s.append(lost[0])
        video_s.append(lost[1])
        shutil.rmtree(folder)
    record_property("tensions_lost_s", sorted(tensions_s))
    record_property("video_lost_s", sorted(video_s))
    assert max(tensions_s) < STATED_LOSS_S
    assert max(video_s) < STATED_VIDEO_LOSS_S


class Disk:
    """What of a folder's files is certain to be on the disk, at each moment.

    In place of `os.fsync`: after the real one it notes the bytes that the file then holds. A power
    cut takes, at worst, everything that came later.
    """

    def __init__(self, folder: Path, clock: Clock) -> None:
        self._folder = folder
        self._clock = clock
        self._sync = os.fsync
        self.notes: list[tuple[float, str, bytes]] = []

    def fsync(self, descriptor: int) -> None:
        path = Path(os.readlink(f"/proc/self/fd/{descriptor}"))
        data = path.read_bytes() if path.is_file() else b""
        self._sync(descriptor)
        if path.parent == self._folder and data:
            self.notes.append((self._clock.monotonic_s(), path.name.removesuffix(".part"), data))

    def after_cut(self, cut_s: float, into: Path) -> Path:
        """The folder as it may be found after a cut."""
        shutil.rmtree(into, ignore_errors=True)
        into.mkdir()
        for at_s, name, data in self.notes:
            if at_s <= cut_s:
                (into / name).write_bytes(data)
        return into


def cut_power(
    rig: Rig, folder: Path, seconds: float, cuts: int, pace: float
) -> tuple[list[float], list[float]]:
    """Losses of tensions and of video in s, over power cuts all along a recording."""
    clock = SlowMotion(pace)
    disk = Disk(folder / "run", clock)
    machine = slowed(assemble(rig, WavePlatform(3.0), NoisyExposer(), clock, seed=1), clock)
    origin: list[float] = []
    at_origin(machine, origin.append)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", disk.fsync)
        record(
            rig,
            rig_text(),
            folder / "run",
            excitation=motion(seconds),
            clock=clock,
            machine=machine,
        )
    # What had arrived by each moment, from the whole run.
    whole = load_run(folder / "run")
    arrived_s = np.sort(whole.tension["received_s"].to_numpy())
    exposed_s = whole.frames["t_s"].to_numpy()
    tensions_s, video_s = [], []
    for cut_s in np.linspace(0.05, seconds, cuts):
        left = disk.after_cut(origin[0] + cut_s, folder / "cut")
        if not (left / "start.json").exists():
            # It is on the disk before the first value, however slow that disk is.
            assert not (arrived_s <= cut_s).any()
            continue
        run = load_run(left)
        assert true(run)
        rows = run.tension["received_s"]
        kept_s = float(rows.max()) if len(rows) else 0.0
        tensions_s.append(float(arrived_s[arrived_s <= cut_s].max(initial=0.0)) - kept_s)
        try:
            frames = 0 if run.video is None else len(list(read_video(run.video)))
        except DataError:
            frames = 0  # not one whole cluster yet
        kept_s = float(exposed_s[frames - 1]) if frames else 0.0
        video_s.append(float(exposed_s[exposed_s <= cut_s].max(initial=0.0)) - kept_s)
    return tensions_s, video_s


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="needs /proc")
@pytest.mark.parametrize(
    ("seconds", "cuts", "pace"),
    [(1.2, 25, PACE), pytest.param(10.0, 200, 1.0, marks=pytest.mark.slow)],
)
def test_a_power_cut_loses_less_than_is_stated(
    rig: Rig,
    tmp_path: Path,
    seconds: float,
    cuts: int,
    pace: float,
    record_property: Callable[[str, object], None],
) -> None:
    room_s = 0.1  # other programs on the computer, and on its disk
    tensions_s, video_s = cut_power(rig, tmp_path, seconds, cuts, pace)
    record_property("tensions_lost_s", sorted(tensions_s))
    record_property("video_lost_s", sorted(video_s))
    assert max(tensions_s) < STATED_POWER_LOSS_S + room_s
    assert max(video_s) < STATED_POWER_VIDEO_LOSS_S + room_s


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


def test_a_video_that_meets_the_full_disk_first_ends_the_run_in_order_too(
    rig: Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The video's library remembers the error: it can no more be closed, whatever room there is.
    write, close = VideoWriter.write, VideoWriter.close
    written: list[float] = []

    def full_after_ten(self: VideoWriter, image: np.ndarray, t_s: float) -> None:
        if len(written) == 10:
            raise OSError(28, "No space left on device")
        write(self, image, t_s)
        written.append(t_s)

    def close_in_vain(self: VideoWriter) -> None:
        close(self)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(VideoWriter, "write", full_after_ten)
    monkeypatch.setattr(VideoWriter, "close", close_in_vain)
    clock = RealClock()
    machine = assemble(rig, WavePlatform(3.0), NoisyExposer(), clock, seed=1)
    recording = record(
        rig, rig_text(), tmp_path / "run", excitation=motion(20.0), clock=clock, machine=machine
    )
    assert isinstance(recording.fault, DataError)
    assert "the disk is full" in recording.fault.sentence()
    run = load_run(tmp_path / "run")
    assert run.notes == ()
    assert run.stop.reason == "disk_full"
    assert run.stop.t_s < 5.0
    assert run.stop.samples == run.tension["cable"].value_counts().sort_index().to_dict()
    assert run.stop.frames == len(run.frames) == len(list(read_video(run.video))) == 10
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
    assert process.wait(ENDED_S) is not None
    assert true(load_run(tmp_path / "run"))


NOBODY = 65534

SMALL_DISK_KB = 16 * 1024 + 400
"""The reserve, and some seconds of a recording."""


def mounts_are_allowed() -> bool:
    """Whether this user may mount a file system of its own, in a name space of its own."""
    if shutil.which("unshare") is None:
        return False
    done = subprocess.run(
        ["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", "/mnt"],
        check=False,
        capture_output=True,
    )
    return done.returncode == 0


@pytest.mark.slow
def test_a_disk_that_is_really_full_ends_the_run_in_order(tmp_path: Path) -> None:
    if not mounts_are_allowed():
        pytest.skip("this user may not mount a small file system")
    script = Path(__file__).parent / "recording_process.py"
    disk = tmp_path / "disk"
    disk.mkdir()
    steps = (
        f"mount -t tmpfs -o size={SMALL_DISK_KB}k tmpfs {disk} && "
        f"{sys.executable} {script} {disk}/run 60 1; code=$?; "
        f"cp -r {disk}/run {tmp_path}/found; exit $code"
    )
    done = subprocess.run(["unshare", "-rm", "sh", "-c", steps], check=False, timeout=90)
    assert done.returncode == 0
    run = load_run(tmp_path / "found")
    assert run.notes == ()
    assert run.stop.reason == "disk_full"
    assert 1.0 < run.stop.t_s < 30.0
    assert true(run)
    assert run.stop.samples == run.tension["cable"].value_counts().sort_index().to_dict()
    assert run.stop.frames == len(run.frames)
    assert "disk_full" in set(run.events["kind"])
    # Frames that waited may be lost; tensions that came before the end are not, as counted above.
    assert len(run.frames) - len(list(read_video(run.video))) <= 8


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no users here")
def test_a_folder_that_may_not_be_written_is_told_with_a_remedy(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "runs"
        folder.mkdir()
        folder.chmod(0o555)
        Path(place).chmod(0o755)
        record_virtually(rig, Path(place) / "before", 0.3, camera=False)  # all is imported now
        root = os.geteuid() == 0
        if root:
            os.seteuid(NOBODY)  # no mode stops the superuser
        try:
            with pytest.raises(DataError, match="cannot be written: Permission denied") as told:
                record_virtually(rig, folder / "first", 0.3, camera=False)
        finally:
            if root:
                os.seteuid(0)
        assert told.value.where == str(folder / "first")
        assert "choose a folder you may write to" in told.value.remedy
        assert list(folder.iterdir()) == []
