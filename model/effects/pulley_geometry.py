"""The cable leaves a pulley of finite radius, not a point."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def pull(radius_m: Any, stiffness: Any, direction_z: Any, rest_direction_z: Any) -> Any:
    """Add k r [(beta - beta_0) - (cos beta - cos beta_0)], beta the elevation of the cable."""
    up, up_0 = direction_z, rest_direction_z
    level, level_0 = np.sqrt(1.0 - up * up), np.sqrt(1.0 - up_0 * up_0)
    sine = up * level_0 - level * up_0
    square = sine * sine
    turned = sine * (1.0 + square / 6.0 * (1.0 + 0.45 * square))
    return stiffness * radius_m * (turned - (level - level_0))


EFFECT = Effect(
    name="pulley_geometry",
    title="geometry of the pulley",
    acts=Acts.CABLE,
    equation="T += k r [(beta - beta_0) - (cos beta - cos beta_0)], beta: elevation of u_i",
    source="Pott, Cable-Driven Parallel Robots (2018), Section 7.1, to first order in r/L; the "
    "cable comes from below the pulley, which swivels about Z",
    signature="gain and an even error, smooth in pose, rate-free, without a loop",
    parameters=(Parameter("radius_m", "m", 0.03, 0.0, 0.15, "r", magnitude=True),),
    pull=pull,
)
