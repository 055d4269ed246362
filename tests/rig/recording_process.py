"""Records the stand-in rig over a real pseudo-terminal, for tests that interrupt or kill it.

Usage: recording_process.py FOLDER DURATION_S
"""

import sys
from pathlib import Path

from rig_stand_ins import NoisyExposer, WavePlatform, motion, rig_text

from cdpr8.clock import RealClock
from cdpr8.rigfile import load_rig, packaged_rig_path
from rig.recorder import record
from rig.simulated.rig import assemble
from rig.stop import StopRequest

if __name__ == "__main__":
    rig = load_rig(packaged_rig_path())
    clock = RealClock()
    machine = assemble(rig, WavePlatform(3.0), NoisyExposer(), clock, seed=1)
    folder = Path(sys.argv[1])
    begin = machine.begin

    def tell_origin(origin_s: float) -> None:
        (folder.parent / "origin.txt").write_text(repr(origin_s))
        begin(origin_s)

    machine.begin = tell_origin
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
