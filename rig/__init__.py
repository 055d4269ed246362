"""The machine: amplifiers on their bus, the camera, the recorder, and a simulated rig of both.

Doors
-----
`rig.recorder.record`
    Record one run into a run folder.
`rig.machine.open_machine`
    Open the amplifiers' line and the camera that a rig file names.
`rig.transport`
    The seam under the bus: serial port, pseudo-terminal, memory.
`rig.simulated.open_rig`
    The simulated rig, found by its entry point (group ``cdpr8.rigs``).

Times are seconds of a monotonic clock; those of a run are seconds from the run's origin.
"""
