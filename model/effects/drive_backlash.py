"""Play in the drive: it loses its way for a while after each reversal."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(motion: "Motion", backlash_deg: float) -> "Motion":
    """X* - z, |z| <= d on every angle."""
    from math import radians

    from model.altered import Loose

    return Loose(motion, radians(backlash_deg))


EFFECT = Effect(
    name="drive_backlash",
    title="backlash of the drive",
    acts=Acts.DRIVE,
    equation="X* - z, z' = X*' (1 - (z/d)^4) towards the stop, X*' away from it; angles only",
    source="play operator, stops met as (z/d)^4; Nordin & Gutman, Automatica 38 (2002) 1633",
    signature="amplitude lost, a plateau after each reversal, odd harmonics; the same in every "
    "cable through the Jacobian",
    parameters=(Parameter("backlash_deg", "deg", 0.03, 0.0, 0.5, "d, half the play", False, True),),
    command=command,
    longest_step_s=1e-3,
    cost="X*'' changes within a small part of the motion after reversal; more steps",
)
