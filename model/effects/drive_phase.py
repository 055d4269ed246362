"""The drive starts late against the command."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", late_s: float, disturbed_late_share: float) -> "Motion":
    """X*(t - tau)."""
    from model.altered import Altered

    return Altered(motion, late_s=late_s, disturbed_late_share=disturbed_late_share)


EFFECT = Effect(
    name="drive_phase",
    title="phase of the drive",
    acts=Acts.DRIVE,
    equation="X*(t - tau)",
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
    ),
    command=command,
)
