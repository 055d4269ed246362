"""Records the stand-in rig over a real pseudo-terminal, for tests that interrupt or kill it.

Usage: recording_process.py FOLDER DURATION_S

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


def start(folder: Path, duration_s: float) -> "subprocess.Popen[bytes]":
    """A recording in a process of its own, once its samples are coming."""
    complaints = folder.parent / "stderr.txt"
    with complaints.open("w") as file:
        process = subprocess.Popen(
            [sys.executable, __file__, str(folder), str(duration_s)], stderr=file
        )
    deadline = time.monotonic() + 60.0
    tension = folder / "tension.csv"
    while not tension.exists() or tension.stat().st_size < 20_000:
        assert process.poll() is None, complaints.read_text()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


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
    clock = RealClock()
    machine = assemble(rig, WavePlatform(3.0), NoisyExposer(), clock, seed=1)
    folder = Path(sys.argv[1])
    noting = Noting(folder.parent / ARRIVED)
    recorder.ThreadedScribe = lambda *those, **named: noting.noted(ThreadedScribe(*those, **named))
    origin = folder.parent / "origin.txt"
    at_origin(machine, lambda origin_s: origin.write_text(repr(origin_s)))
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
