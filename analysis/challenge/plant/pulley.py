"""A cable's path from its pulley to the platform: from a point, or from a swivelling wheel."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.compiled import law

Array = NDArray[np.float64]


@law
def straight(start: Array, end: Array) -> tuple[float, float, float, float]:
    """Length from anchor `start` to base `end`, m, and the unit vector."""
    x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = np.sqrt(x * x + y * y + z * z)
    return length, x / length, y / length, z / length


@law
def wrapped(start: Array, end: Array, radius: float) -> tuple[float, float, float, float]:
    """Wheel that swivels about the vertical through `end`, where the cable comes up from below.

    The cable goes over the top of the wheel, whose centre stands one radius towards the platform,
    and leaves it on the tangent (Pott, Cable-Driven Parallel Robots, 2018, Section 7.1, solved
    exactly).

    Returns
    -------
    tuple of float
        Length of arc and tangent, m, and the unit vector along the tangent from the anchor.
    """
    x, y = start[0] - end[0], start[1] - end[1]
    across = np.sqrt(x * x + y * y)
    out, up = across - radius, start[2] - end[2]
    centre = np.sqrt(out * out + up * up)
    free = np.sqrt(centre * centre - radius * radius)
    angle = np.arctan2(up, out) + np.arccos(radius / centre)
    arc = radius * (np.pi - angle)
    # From the anchor to the point where the tangent touches.
    level = (radius * np.cos(angle) - out) / free
    rise = (radius * np.sin(angle) - up) / free
    return arc + free, level * x / across, level * y / across, rise
