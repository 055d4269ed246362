"""A pose as six numbers: X, Y, Z in m and roll, pitch, yaw in rad, in this order."""

import numpy as np

from cdpr8.errors import UsageError

Pose = tuple[float, float, float, float, float, float]

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")


def along(coordinate: str, amplitude: float) -> Pose:
    """A pose that is zero but for one coordinate.

    Parameters
    ----------
    coordinate
        x, y, z, roll, pitch or yaw.
    amplitude
        m, or degrees.

    Raises
    ------
    UsageError
        No such coordinate.
    """
    if coordinate not in COORDINATES:
        raise UsageError(f"no coordinate {coordinate!r}", allowed=", ".join(COORDINATES))
    at = COORDINATES.index(coordinate)
    value = amplitude if at < 3 else float(np.deg2rad(amplitude))
    x, y, z, roll, pitch, yaw = (value if k == at else 0.0 for k in range(6))
    return x, y, z, roll, pitch, yaw
