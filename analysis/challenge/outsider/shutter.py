"""A rolling shutter: corners are seen when their row is read, a rigid pose is fitted to them.

A pinhole camera looks along -Y at a plate on the platform's side; the time of a row goes with its
place in the picture (Ait-Aider et al., ECCV 2006).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Motion = Callable[[Array], Array]

ROWS = 1024
FOCAL_PX = 1500.0
MIDDLE_PX = np.array([639.5, 511.5])
FIRST_ROW = 392.0
"""First row of the region that is read: a frame's stamp is its exposure's middle."""
MIDDLE_ROWS = 120.0
"""Rows from there to the plate's middle: where the refit starts from."""

STANDS_AT = np.array([0.5, 0.966, 0.0])
LOOKS_AT = np.array([0.0, 0.1, 0.0])
PLATE_Y_M = 0.1
CORNERS_M = (-0.045, -0.005, 0.005, 0.045)
"""Of the plate's four markers, along X and along Z."""

ROW_ROUNDS, FIT_ROUNDS = 3, 4
STEPS = np.array([1e-6, 1e-6, 1e-6, *np.radians(np.full(3, 1e-4))])
"""Of the differences by which a pose is fitted, m and rad."""


def attitude(angles: Array) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll) of angles of shape (..., 3), rad; shape (..., 3, 3)."""
    sine, cosine = np.sin(angles), np.cos(angles)
    (sa, sb, sc), (ca, cb, cc) = np.moveaxis(sine, -1, 0), np.moveaxis(cosine, -1, 0)
    rows = [
        [cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
        [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
        [-sb, cb * sa, cb * ca],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def attitude_angles(matrix: Array) -> Array:
    """Roll, pitch and yaw of rotation matrices of shape (..., 3, 3), rad."""
    roll = np.arctan2(matrix[..., 2, 1], matrix[..., 2, 2])
    pitch = np.arcsin(-matrix[..., 2, 0])
    yaw = np.arctan2(matrix[..., 1, 0], matrix[..., 0, 0])
    return np.stack([roll, pitch, yaw], axis=-1)


def _camera() -> Array:
    """Rows: right, down and forward of the camera in O-XYZ."""
    forward = (LOOKS_AT - STANDS_AT) / np.linalg.norm(LOOKS_AT - STANDS_AT)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(forward, right), forward])


def _corners() -> Array:
    """Of the markers, platform frame, shape (16, 3), m."""
    return np.array([[x, PLATE_Y_M, z] for x in CORNERS_M for z in CORNERS_M])


def picture(pose: Array) -> Array:
    """Where the corners are seen; poses of shape (..., 16, 6) or (..., 1, 6), (..., 16, 2) px."""
    corner = np.einsum("...ij,...j->...i", attitude(pose[..., 3:]), _corners())
    seen = (pose[..., :3] + corner - STANDS_AT) @ _camera().T
    return np.asarray(FOCAL_PX * seen[..., :2] / seen[..., 2:] + MIDDLE_PX)


def rolled(motion: Motion, at_s: Array, row_s: float) -> Array:
    """Poses fitted to corners that were each seen in their own row.

    Parameters
    ----------
    motion
        Poses of shape (..., 6) at instants of shape (...).
    at_s
        Of the first row, shape (m,), s.
    row_s
        From one row to the next, s.
    """
    seen_s = np.repeat(at_s[:, None], len(_corners()), axis=1)
    for _ in range(ROW_ROUNDS):
        seen = picture(motion(seen_s))
        seen_s = at_s[:, None] + row_s * (seen[..., 1] - FIRST_ROW)
    return _fitted(motion(at_s + row_s * MIDDLE_ROWS), seen)


def _fitted(pose: Array, seen: Array) -> Array:
    """Rigid poses, shape (m, 6), whose picture comes closest to what was seen (Gauss-Newton)."""
    pose = pose.copy()
    wanted = seen.reshape(len(pose), -1)
    for _ in range(FIT_ROUNDS):
        now = picture(pose[:, None]).reshape(wanted.shape)
        slopes = np.empty((*wanted.shape, 6))
        for j, step in enumerate(STEPS):
            beside = pose.copy()
            beside[:, j] += step
            slopes[..., j] = (picture(beside[:, None]).reshape(wanted.shape) - now) / step
        pose += np.einsum("mij,mj->mi", np.linalg.pinv(slopes), wanted - now)
    return pose
