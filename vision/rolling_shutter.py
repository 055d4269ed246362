"""A shutter that opens row after row: when the plate was seen, and how that skewed its picture.

With a row delay d the row r is exposed d (r - middle) after the middle row, of which the stamp is.
So the plate is seen at the time of its own rows, and its upper and lower markers at different ones:
to first order each corner is displaced by its velocity times its delay, and the pose that fits the
displaced corners is off by what a linear fit makes of these displacements. Both are put right here,
after tracking, with the velocities that the poses themselves show.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.plate import Plate
from vision.pose import CameraPose

Array = NDArray[np.float64]

LEAST_POSES = 4
"""A cubic through fewer poses has no velocity worth the name."""


def row_of(plate: Plate, pose: CameraPose, camera: CameraModel) -> float:
    """Mean row of the plate's corners in the picture, px."""
    return float(_pixels(plate, pose, camera)[:, 1].mean())


def delay_of(plate: Plate, pose: CameraPose, camera: CameraModel, row_delay_s: float) -> float:
    """How much later than the stamp, which is the middle row's, the plate is seen, s."""
    return row_delay_s * (row_of(plate, pose, camera) - (camera.height_px - 1) / 2.0)


def without_skew(
    times: Sequence[float],
    poses: Sequence[CameraPose],
    plate: Plate,
    camera: CameraModel,
    row_delay_s: float,
) -> list[CameraPose]:
    """Poses at the times of the plate's middle row.

    Parameters
    ----------
    times
        When each was seen, s, ascending.
    poses
        As tracked.
    plate, camera
        Plate and camera.
    row_delay_s
        From one row to the next; 0 for a global shutter.

    Returns
    -------
    list
        As many; the same where there are too few for a velocity.
    """
    from scipy.interpolate import CubicSpline

    instants = np.asarray(times, dtype=float)
    if row_delay_s == 0.0 or len(poses) < LEAST_POSES or not (np.diff(instants) > 0.0).all():
        return list(poses)
    reference = poses[0].rotation
    turns = np.array([_vector_of(pose.rotation @ reference.T) for pose in poses])
    places = np.array([pose.translation for pose in poses])
    speeds = CubicSpline(instants, np.column_stack([turns, places]))(instants, 1)
    return [
        _corrected(pose, speed, plate, camera, row_delay_s)
        for pose, speed in zip(poses, speeds, strict=True)
    ]


def _corrected(
    pose: CameraPose, speed: Array, plate: Plate, camera: CameraModel, row_delay_s: float
) -> CameraPose:
    flat = plate.corners.reshape(-1, 3)
    turned = flat @ pose.rotation.T
    x, y, z = (turned + pose.translation).T
    fx, fy = camera.focal_px
    zero = np.zeros(len(flat))
    by_place = np.stack(
        [
            np.column_stack([fx / z, zero, -fx * x / z**2]),
            np.column_stack([zero, fy / z, -fy * y / z**2]),
        ],
        axis=1,
    )
    by_turn = np.cross(turned[:, None], by_place)  # (r x g) . w = g . (w x r)
    jacobian = np.concatenate([by_turn, by_place], axis=2)
    rows = _pixels(plate, pose, camera)[:, 1]
    delays = row_delay_s * (rows - rows.mean())
    displaced = (jacobian @ speed) * delays[:, None]
    off = np.linalg.lstsq(jacobian.reshape(-1, 6), displaced.ravel(), rcond=None)[0]
    back = _rotation_of(-off[:3])
    return replace(pose, rotation=back @ pose.rotation, translation=pose.translation - off[3:])


def _pixels(plate: Plate, pose: CameraPose, camera: CameraModel) -> Array:
    seen = plate.corners.reshape(-1, 3) @ pose.rotation.T + pose.translation
    return camera.distort(camera.project(seen))


def _vector_of(rotation: Array) -> Array:
    import cv2

    vector: Array = np.asarray(cv2.Rodrigues(rotation)[0], dtype=float).ravel()
    return vector


def _rotation_of(vector: Array) -> Array:
    import cv2

    rotation: Array = np.asarray(cv2.Rodrigues(vector.reshape(3, 1))[0], dtype=float)
    return rotation
