"""The drive starts late against the command."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", late_s: float) -> "Motion":
    """X*(t - tau)."""
    from model.altered import Altered

    return Altered(motion, late_s=late_s)


EFFECT = Effect(
    name="drive_phase",
    title="phase of the drive",
    acts=Acts.DRIVE,
    equation="X*(t - tau)",
    source="design, section 4",
    signature="one lag in pose and tensions together",
    parameters=(Parameter("late_s", "s", 0.01, -0.002, 0.2, "tau", False, True),),
    command=command,
)
