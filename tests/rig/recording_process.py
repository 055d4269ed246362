"""Records the stand-in rig over a real pseudo-terminal, for tests that interrupt or kill it.

Usage: recording_process.py FOLDER DURATION_S
"""

import subprocess
import sys
import time
from pathlib import Path

from rig_stand_ins import NoisyExposer, WavePlatform, at_origin, motion, rig_text

from cdpr8.clock import RealClock
from cdpr8.rigfile import load_rig, packaged_rig_path
from rig.recorder import record
from rig.simulated.rig import assemble
from rig.stop import StopRequest


def start(folder: Path, duration_s: float) -> "subprocess.Popen[bytes]":
    """A recording in a process of its own, once its samples are coming."""
    complaints = folder.parent / "stderr.txt"
    with complaints.open("w") as file:
        process = subprocess.Popen(
            [sys.executable, __file__, str(folder), str(duration_s)], stderr=file
        )
    deadline = time.monotonic() + 20.0
    tension = folder / "tension.csv"
    while not tension.exists() or tension.stat().st_size < 20_000:
        assert process.poll() is None, complaints.read_text()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return process


if __name__ == "__main__":
    rig = load_rig(packaged_rig_path())
    clock = RealClock()
    machine = assemble(rig, WavePlatform(3.0), NoisyExposer(), clock, seed=1)
    folder = Path(sys.argv[1])
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
