"""A cable as a string whose end moves: compiled into every kernel."""

from typing import Any

import numpy as np

PI = float(np.pi)
FIRST_MODE = 2.0 / PI
"""Share of a straight line from base to anchor in sin(pi y / L)."""


def level(direction_z: Any) -> Any:
    """Cosine of the slope of a cable against the ground; never zero."""
    return np.sqrt(1.0 - direction_z * direction_z + 1e-12)


def swept(
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    anchor_velocity_x: Any,
    anchor_velocity_y: Any,
    anchor_velocity_z: Any,
) -> Any:
    """Give w', m/s, of an anchor across its cable: in the vertical plane, and beside it."""
    along = (
        direction_x * anchor_velocity_x
        + direction_y * anchor_velocity_y
        + direction_z * anchor_velocity_z
    )
    flat = level(direction_z)
    vertical = (anchor_velocity_z - along * direction_z) / flat
    return vertical, (direction_y * anchor_velocity_x - direction_x * anchor_velocity_y) / flat


def tone_squared(tension: Any, axial_velocity: Any, length: Any, line_density: Any) -> Any:
    """Give (pi/L)^2 (T/rho - v^2), 1/s2: of the first mode of Eq. 17."""
    wave = tension / line_density - axial_velocity * axial_velocity
    return PI * PI / (length * length) * wave
