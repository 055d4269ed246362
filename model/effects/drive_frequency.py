"""The drive runs faster or slower than commanded."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", frequency_share: float, ramps_kept_share: float) -> "Motion":
    """X*(t_0 + p (t - t_0)), its sine of f (1 + e)/p; it rests as soon as it is through."""
    from model.altered import Altered, retuned

    pace = 1.0 + frequency_share * (1.0 - ramps_kept_share)
    if ramps_kept_share:
        motion = retuned(motion, (1.0 + frequency_share) / pace)
    return Altered(motion, pace=pace)


EFFECT = Effect(
    name="drive_frequency",
    title="frequency of the drive",
    acts=Acts.DRIVE,
    equation="X*(t_0 + p (t - t_0)), p = 1 + (1 - s) e, with a sine of f (1 + e)/p",
    source="design, section 4",
    signature="phase that runs away in pose and tensions together",
    parameters=(
        Parameter("frequency_share", "1", 2e-3, -0.05, 0.05, "e", False, True),
        Parameter(
            "ramps_kept_share",
            "1",
            0.0,
            0.0,
            1.0,
            "s: 0 for a clock that is off, 1 where ramps last as commanded",
            False,
        ),
    ),
    command=command,
)
