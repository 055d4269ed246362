"""The rows of a frame are read one after the other."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

STEP_S = 5e-4
"""Half the base of the difference that gives the speed."""


def measure(
    look: Any,
    readout_s: Any,
    field_m: Any,
    plate_y_m: Any,
    plate_half_m: Any,
    distance_m: Any,
    bearing_rad: Any,
    depth_share: Any,
    before_share: Any,
    reads_up: Any,
) -> Any:
    """Rows below the centre are late: a moving plate is sheared, and read as a turned one.

    The plate stands beside the centre of mass, and moves with its turning.
    """
    taken = taken_for(plate_y_m, plate_half_m, distance_m, bearing_rad, depth_share)

    def seen(stamp_s: Any) -> Any:
        if readout_s == 0.0:
            return look(stamp_s)
        middle_s = stamp_s + readout_s * before_share
        late = (2.0 * round(reads_up) - 1.0) * readout_s / field_m
        before = look(middle_s)
        when_s = middle_s + late * (before[:, 2] + before[:, 3] * plate_y_m)
        rate = (look(when_s + STEP_S) - look(when_s - STEP_S)) / (2.0 * STEP_S)
        return look(when_s) + late * rate @ taken.T

    return seen


def taken_for(
    plate_y_m: float,
    plate_half_m: float,
    distance_m: float,
    bearing_rad: float,
    depth_share: float,
) -> Any:
    """What a rigid plate is taken to have done whose corners were displaced as they are high.

    Parameters
    ----------
    plate_y_m
        The plate's middle beside the centre of mass, m; its normal is along Y, away from there.
    plate_half_m
        Half the side of its square of corners, m.
    distance_m
        From there to the camera.
    bearing_rad
        By which the camera stands beside the normal, towards X, in the plane of X and Y.
    depth_share
        Weight of a corner's depth in the fit: none in a picture, 1 of corners known in space.

    Returns
    -------
    ndarray
        Displacement of the centre of mass, m, and rotation, rad, by those of the platform over the
        height at which each corner has done as much of them, shape (6, 6): a least-squares fit.
    """
    beside = np.array([0.0, plate_y_m, 0.0])
    outward = 1.0 if plate_y_m >= 0.0 else -1.0
    ahead = -np.array([np.sin(bearing_rad), outward * np.cos(bearing_rad), 0.0])
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    views, wanted = [], []
    for across in (-plate_half_m, plate_half_m):
        for high in (-plate_half_m, plate_half_m):
            corner = np.array([across, 0.0, high])
            near = distance_m / (distance_m + corner @ ahead)
            picture = np.array(
                [right - near / distance_m * (corner @ right) * ahead,
                 [0.0, 0.0, 1.0] - near / distance_m * high * ahead,
                 depth_share * ahead]
            )  # fmt: skip
            view = picture @ np.hstack([np.eye(3), np.cross(np.eye(3), corner + beside).T])
            views.append(near * view)
            wanted.append(near * high * near * view)
    return np.linalg.lstsq(np.vstack(views), np.vstack(wanted), rcond=None)[0]


EFFECT = Effect(
    name="camera_rolling_shutter",
    title="rolling shutter of the camera",
    acts=Acts.CAMERA,
    equation="each corner seen at t + t_r (b - z/h), and a rigid plate fitted to their picture",
    source="notes/left-out-physics.md, Section 2; rows along Z, the plate's normal along Y; "
    "to first order of the delay across the plate (Ait-Aider et al. 2006)",
    signature="pitch and roll in proportion to the speed of the plate, pose only",
    parameters=(
        Parameter("readout_s", "s", 0.01, 0.0, 0.0625, "t_r, first row to last", False, True),
        Parameter("field_m", "m", 0.68, 0.05, 50.0, "h, height of the field of view", False),
        Parameter("plate_y_m", "m", 0.1, -2.0, 2.0, "the plate from the centre of mass", False),
        Parameter("plate_half_m", "m", 0.03, 0.001, 1.0, "half the height of its corners", False),
        Parameter("distance_m", "m", 1.0, 0.05, 50.0, "from the camera to the plate", False),
        Parameter(
            "bearing_rad", "rad", 0.52, -1.4, 1.4, "of the camera from the plate's normal, to X",
            False,
        ),
        Parameter("depth_share", "1", 0.0, 0.0, 1.0, "of depth where a pose is fitted", False),
        Parameter(
            "before_share", "1", 0.0, -0.6, 0.6, "b, of the readout, from stamp to plate",
            False,
        ),
        Parameter("reads_up", "1", 0.0, 0.0, 1.0, "whether the lowest row comes first", False),
    ),
    measure=measure,
    order=2,
)  # fmt: skip
