"""The moving anchor shakes its cable: Eq. 17 is homogeneous, a real cable is not."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

FIRST_MODE = 2.0 / float(np.pi)
"""Share of a straight line from base to anchor in sin(pi y / L)."""


def transverse(
    forcing_share: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    anchor_velocity_x: Any,
    anchor_velocity_y: Any,
    anchor_velocity_z: Any,
) -> Any:
    """-2/pi w', w the anchor's movement across the cable in the vertical plane."""
    along = (
        direction_x * anchor_velocity_x
        + direction_y * anchor_velocity_y
        + direction_z * anchor_velocity_z
    )
    level = np.sqrt(1.0 - direction_z * direction_z + 1e-12)
    return -forcing_share * FIRST_MODE * (anchor_velocity_z - along * direction_z) / level


EFFECT = Effect(
    name="cable_end_forcing",
    title="the moving anchor shakes the cable",
    acts=Acts.CABLE,
    equation="X_w'' + ... = -a (2/pi) w'', w: movement of the anchor across the cable, vertical "
    "plane; the state X_w' then holds X_w' + a (2/pi) w'",
    source="Irvine, Cable Structures (1981), Section 3; modal projection of a moving end",
    signature="cable vibration at the drive's own frequency, large near the cable's tone; tension "
    "at twice the frequency",
    parameters=(
        Parameter("forcing_share", "1", 1.0, 0.0, 2.0, "a: 1 for a taut string", magnitude=True),
    ),
    transverse=transverse,
)
