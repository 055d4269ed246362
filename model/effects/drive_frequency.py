"""The drive runs faster or slower than commanded."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", frequency_share: float) -> "Motion":
    """X*(t_0 + (1 + e)(t - t_0)); it rests as soon as it is through."""
    from model.altered import Altered

    return Altered(motion, pace=1.0 + frequency_share)


EFFECT = Effect(
    name="drive_frequency",
    title="frequency of the drive",
    acts=Acts.DRIVE,
    equation="X*(t_0 + (1 + e)(t - t_0))",
    source="design, section 4",
    signature="phase that runs away in pose and tensions together",
    parameters=(Parameter("frequency_share", "1", 2e-3, -0.05, 0.05, "e", False, True),),
    command=command,
)
