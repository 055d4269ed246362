"""How the camera stands to the plate, as the rig file has it: numbers of the measurement's laws."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, copysign, sqrt

import numpy as np

from cdpr8.rigfile.schema import Intrinsics, Rig

FRAME_HZ = 16.0
"""Of a rig file without a camera."""


@dataclass(frozen=True)
class Sighting:
    """What a rig file says of the camera.

    Parameters
    ----------
    frame_hz
        Frames per second.
    shutter
        Numbers of `camera_rolling_shutter` that follow from where camera and plate stand; those
        it does not tell are left out.
    """

    frame_hz: float
    shutter: Mapping[str, float]


def sighting_of(rig: Rig) -> Sighting:
    """Of one machine.

    Parameters
    ----------
    rig
        Its rig file; camera, plate and their poses may be missing.
    """
    camera = rig.camera
    frame_hz = camera.fps if camera is not None else FRAME_HZ
    if camera is None or camera.pose is None or rig.plate is None:
        return Sighting(frame_hz, {})
    away = np.array(camera.pose.position_m) - np.array(rig.plate.pose.position_m)
    beside_m = rig.plate.pose.position_m[1]
    distance_m = float(np.linalg.norm(away))
    shutter = {
        "plate_y_m": beside_m,
        "plate_half_m": _half_m(rig),
        "distance_m": distance_m,
        "bearing_rad": atan2(away[0], copysign(1.0, beside_m) * away[1]),
        "reads_up": float(camera.pose.up[2] < 0.0),
    }
    if isinstance(camera.intrinsics, Intrinsics):
        lens = camera.intrinsics
        shutter["field_m"] = lens.height_px / lens.fy_px * distance_m
    return Sighting(frame_hz, shutter)


def _half_m(rig: Rig) -> float:
    """Half the side of the square of four corners that spreads as the markers' corners do."""
    assert rig.plate is not None
    offsets = [
        along + side * marker.size_m / 2.0
        for marker in rig.plate.markers()
        for along in marker.centre_m
        for side in (-1.0, 1.0)
    ]
    return sqrt(float(np.mean(np.square(offsets))))
