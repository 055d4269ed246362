"""The camera and its clock: what it makes of the motion, and its faults, none of them noise."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.shutter import attitude, attitude_angles, rolled

Array = NDArray[np.float64]
Motion = Callable[[Array], Array]

EXPOSURE_S = 0.005
"""Of a sound camera, s: too short to see."""

GAUSS_POINTS = 7
"""Of the mean over an exposure."""


@dataclass(frozen=True)
class CameraFault:
    """Faults of the camera and of its clock.

    Parameters
    ----------
    latency_s
        Stamps are late by it.
    exposure_s
        Over which a pose is averaged.
    axis_rad
        Rotation vector of a camera that stands askew.
    gain_share
        Relative, of places and angles alike.
    row_s
        From one row of a rolling shutter to the next.
    drift_share
        By which its clock is fast.
    lost_before
        Frames before which one more went missing without a gap in the stamps.
    """

    latency_s: float = 0.0
    exposure_s: float = EXPOSURE_S
    axis_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gain_share: float = 0.0
    row_s: float = 0.0
    drift_share: float = 0.0
    lost_before: tuple[int, ...] = ()


SOUND_CAMERA = CameraFault()


def see(
    time_s: Array, pose: Array, stamp_s: Array, jitter_s: Array, period_s: float, fault: CameraFault
) -> Array:
    """Poses that the camera would report at its stamps, without noise.

    Parameters
    ----------
    time_s, pose
        What happened, shapes (n,) and (n, 6); m and rad.
    stamp_s
        As written, shape (m,), s.
    jitter_s
        What each exposure really is later than its stamp says, shape (m,), s.
    period_s
        Of the frames, s.
    fault
        Of camera and clock.

    Returns
    -------
    Array
        Shape (m, 6); m and rad.
    """
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(time_s, pose)

    def motion(at_s: Array) -> Array:
        return np.asarray(spline(np.clip(at_s, 0.0, time_s[-1])))

    at_s = exposed_at(stamp_s, period_s, fault) + jitter_s
    if fault.row_s > 0.0:
        seen = rolled(motion, at_s, fault.row_s)
    else:
        seen = _averaged(motion, at_s, fault.exposure_s)
    return _askew(seen * (1.0 + fault.gain_share), fault.axis_rad)


def exposed_at(stamp_s: Array, period_s: float, fault: CameraFault) -> Array:
    """When frames with these stamps were exposed, by the tension clock; shape (m,), s."""
    missing = np.zeros(len(stamp_s))
    for frame in fault.lost_before:
        missing[frame:] += 1.0
    return (stamp_s - fault.latency_s) / (1.0 + fault.drift_share) + missing * period_s


def _averaged(motion: Motion, at_s: Array, exposure_s: float) -> Array:
    """The mean pose over an exposure, by Gauss and Legendre."""
    points, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    seen = np.zeros((len(at_s), 6))
    for point, weight in zip(points, weights, strict=True):
        seen += weight / 2.0 * motion(at_s + point * exposure_s / 2.0)
    return seen


def _askew(pose: Array, axis_rad: tuple[float, float, float]) -> Array:
    """A frame turned by A sees A x and A R A^T."""
    if not any(axis_rad):
        return pose
    from scipy.spatial.transform import Rotation

    frame = Rotation.from_rotvec(axis_rad).as_matrix()
    turned = frame @ attitude(pose[:, 3:]) @ frame.T
    return np.hstack([pose[:, :3] @ frame.T, attitude_angles(turned)])
