"""The drive makes more or less of the motion than commanded."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", amplitude_share: float) -> "Motion":
    """(1 + e) X*."""
    from model.altered import Altered

    return Altered(motion, factor=1.0 + amplitude_share)


EFFECT = Effect(
    name="drive_amplitude",
    title="amplitude of the drive",
    acts=Acts.DRIVE,
    equation="(1 + e) X*",
    source="design, section 4",
    signature="the same factor in pose and in every cable through the Jacobian",
    parameters=(Parameter("amplitude_share", "1", 0.03, -0.3, 0.3, "e", False, True),),
    command=command,
)
