"""Play in the drive: it loses its way for a while after each reversal."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", backlash_deg: float, servo_s: float, servo_late_s: float) -> "Motion":
    """X* - z, |z| <= d on every angle, z smoothed."""
    from math import radians

    from model.altered import Loose

    return Loose(motion, radians(backlash_deg), servo_s, servo_late_s)


EFFECT = Effect(
    name="drive_backlash",
    title="backlash of the drive",
    acts=Acts.DRIVE,
    equation="X* - G z, z' = X*' between the stops |z| = d, 0 at them; G: a Gaussian of standard "
    "deviation tau, late by t_G; angles only",
    source="play operator; Nordin & Gutman, Automatica 38 (2002) 1633; a servo does not jump: of "
    "second order, it is late by 2 zeta/omega and smooths over sqrt(4 zeta^2 - 2)/omega",
    signature="amplitude lost, a plateau after each reversal, odd harmonics; the same in every "
    "cable through the Jacobian",
    parameters=(
        Parameter("backlash_deg", "deg", 0.03, 0.0, 0.5, "d, half the play", False, True),
        Parameter("servo_s", "s", 6e-3, 2e-3, 5e-2, "tau", False),
        Parameter("servo_late_s", "s", 0.0, 0.0, 3e-2, "t_G: 0, as if it foresaw the play", False),
    ),
    command=command,
    longest_step_s=1e-3,
    cost="X*'' changes within a small part of the motion after reversal; more steps",
)
