"""The drive starts late against the command."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


PAPER_HZ = 2.06
"""An angle is told as the time that it is at this frequency."""


def command(
    motion: "Motion", late_s: float, disturbed_late_share: float, phase_share: float
) -> "Motion":
    """X*(t - tau), or the sine turned back by 2 pi f_0 tau."""
    from math import pi

    from model.altered import Altered, turned

    if round(phase_share):
        return turned(motion, 2.0 * pi * PAPER_HZ * late_s)
    return Altered(motion, late_s=late_s, disturbed_late_share=disturbed_late_share)


EFFECT = Effect(
    name="drive_phase",
    title="phase of the drive",
    acts=Acts.DRIVE,
    equation="X*(t - tau), or sin(2 pi (f t - f_0 tau)) within ramps as commanded, f_0 = 2.06 Hz",
    source="design, section 4",
    signature="one lag in pose and tensions together",
    parameters=(
        Parameter("late_s", "s", 0.01, -0.002, 0.2, "tau", False, True),
        Parameter(
            "disturbed_late_share",
            "1",
            1.0,
            0.0,
            1.0,
            "X_p0 and X_w0 act as the drive starts; 0: as it was to start",
            False,
        ),
        Parameter(
            "phase_share",
            "1",
            0.0,
            0.0,
            1.0,
            "0: later by a time; 1: by an angle, the same at each frequency",
            False,
        ),
    ),
    command=command,
)
