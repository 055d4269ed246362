"""Whether the planned motion would bring a cable near slack: a static estimate from the rig file.

The platform turns about its centre of mass and every cable keeps its unstretched length; nothing
dynamic is in it (design, section 4: a cable cannot push).
"""

import math

import numpy as np

from cdpr8.rigfile import Excitation, Rig

NEAR_SLACK = 0.1
"""Part of the pretension below which a cable counts as near slack."""

_AXES = {"roll": (1.0, 0.0, 0.0), "pitch": (0.0, 1.0, 0.0), "yaw": (0.0, 0.0, 1.0)}


def least_tension_n(rig: Rig, motion: Excitation) -> dict[int, float]:
    """The lowest tension of each cable during the motion; below zero it would be slack."""
    axis = np.array(_AXES[motion.axis])
    centre = np.array(rig.platform.centre_of_mass_m.value)
    angle = math.radians(motion.amplitude_deg)
    found = {}
    for number, cable in enumerate(rig.cable, start=1):
        arm = np.array(cable.anchor_m.value) - centre
        span = np.array(cable.base_m.value) - arm
        towards = span / np.linalg.norm(span)
        lever_m = abs(float(np.cross(arm, towards) @ axis))
        change_n = float(cable.stiffness_n_per_m.value) * lever_m * angle
        found[number] = float(cable.pretension_n.value) - change_n
    return found


def slack_warning(rig: Rig, motion: Excitation) -> str | None:
    """What a user must know before the motion; None where every cable stays taut."""
    near = {
        number: least
        for number, least in least_tension_n(rig, motion).items()
        if least < NEAR_SLACK * float(rig.cable[number - 1].pretension_n.value)
    }
    if not near:
        return None
    cables = ", ".join(f"cable {number} to {least:.1f} N" for number, least in near.items())
    return (
        f"{motion.amplitude_deg:g} deg of {motion.axis} would bring {cables}: near slack "
        "(static estimate). Raise the pretension or lower --amplitude"
    )
