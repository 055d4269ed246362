"""Records the stand-in rig over a real pseudo-terminal, for tests that interrupt or kill it.

Usage: recording_process.py FOLDER DURATION_S PACE

With a pace above 1 it records in slow motion, which leaves a slow computer time.

What has arrived is noted beside the run in memory that outlives the process: what a kill takes is
what arrived and is not on the disk, however busy the computer is.
"""

import mmap
import struct
import subprocess
import sys
import time
from pathlib import Path

from rig_stand_ins import NoisyExposer, WavePlatform, at_origin, motion, rig_text
from slow_motion import PACE, SlowMotion, slowed

from cdpr8.clock import RealClock
from cdpr8.rigfile import load_rig, packaged_rig_path
from rig import recorder
from rig.camera import Image
from rig.lines import Sample
from rig.recorder import record
from rig.scribe import ThreadedScribe
from rig.simulated.rig import assemble
from rig.stop import StopRequest

ARRIVED = "arrived.bin"
BEGAN = "began.bin"

ENDED_S = 60.0
"""How long the process may take to begin, or to end after a signal: a computer may be slow."""


def start(folder: Path, duration_s: float, pace: float = PACE) -> "subprocess.Popen[bytes]":
    """A recording in a process of its own, once its samples are coming."""
    complaints = folder.parent / "stderr.txt"
    with complaints.open("w") as file:
        process = subprocess.Popen(
            [sys.executable, __file__, str(folder), str(duration_s), str(pace)], stderr=file
        )
    deadline = time.monotonic() + ENDED_S
    tension = folder / "tension.csv"
    while not tension.exists() or tension.stat().st_size < 20_000:
        assert process.poll() is None, complaints.read_text()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


def run_s(folder: Path, real_s: float) -> float:
    """The time of the run at a real one of CLOCK_MONOTONIC, in s."""
    began_s, lead_s, pace = struct.unpack("ddd", (folder.parent / BEGAN).read_bytes())
    return lead_s + (real_s - began_s) / pace


def arrived_s(folder: Path) -> tuple[float, float]:
    """When the newest tension and the newest frame arrived, in s of the run."""
    tension_s, frame_s = struct.unpack("dd", (folder.parent / ARRIVED).read_bytes())
    return tension_s, frame_s


class Noting:
    """Notes a time in a file that is mapped into memory, before what came is handed on."""

    def __init__(self, file: Path) -> None:
        file.write_bytes(bytes(16))
        with file.open("r+b") as opened:
            self._map = mmap.mmap(opened.fileno(), 16)

    def noted(self, scribe: ThreadedScribe) -> ThreadedScribe:
        take_sample, take_frame = scribe.sample, scribe.frame

        def sample(sample: Sample) -> None:
            struct.pack_into("d", self._map, 0, sample.received_s)
            take_sample(sample)

        def frame(image: Image, t_s: float, flags: int) -> None:
            struct.pack_into("d", self._map, 8, t_s)
            take_frame(image, t_s, flags)

        scribe.sample, scribe.frame = sample, frame
        return scribe


if __name__ == "__main__":
    rig = load_rig(packaged_rig_path())
    clock = SlowMotion(float(sys.argv[3]))
    machine = assemble(rig, WavePlatform(3.0), NoisyExposer(), clock, seed=1)
    folder = Path(sys.argv[1])
    noting = Noting(folder.parent / ARRIVED)
    recorder.ThreadedScribe = lambda *those, **named: noting.noted(ThreadedScribe(*those, **named))

    def note_beginning(origin_s: float) -> None:
        # The lead before the origin passes in slow motion already.
        times = (RealClock().monotonic_s(), clock.monotonic_s() - origin_s, clock.pace)
        (folder.parent / BEGAN).write_bytes(struct.pack("ddd", *times))

    at_origin(machine, note_beginning)
    slowed(machine, clock)
    stop = StopRequest()
    with stop.listening():
        record(
            rig,
            rig_text(),
            folder,
            excitation=motion(float(sys.argv[2])),
            clock=clock,
            machine=machine,
            stop=stop,
        )
