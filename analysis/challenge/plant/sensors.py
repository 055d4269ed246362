"""What force cells and camera make of what happens: their faults, none of them noise."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Look = Callable[[Array], Array]
Fault = TypeVar("Fault", "CellFault", "CameraFault")

NONE = np.zeros(8)

KNEE_N = 0.15
"""Over this a cell that saturates bends into its limit, N."""

LAG_RATIO = 3.0
"""A slow cell has two time constants, one this much the longer; their sum is its lag."""

DRIFT_BEND = 0.15
"""By this share a drift is faster at first, slower at last."""

EXPOSURE_POINTS = 9
MARKERS = np.array([[x, 0.1, z] for x in (-0.03, 0.03) for z in (-0.03, 0.03)])
"""Corners of a plate on the platform's left side, platform frame, m: rows of the image run along
X, from one row to the next is along Z."""

FIELD_M = 0.68
"""Height of what all rows of the camera see, m."""


@dataclass(frozen=True)
class CellFault:
    """Faults of the force cells, each of shape (8,).

    Parameters
    ----------
    gain_share
        Relative.
    zero_n, drift_n_per_s
        N and N/s.
    lag_s
        Delay of slow changes, s.
    limit_n
        Where it saturates, N; 0: nowhere.
    seen_by
        Index of the cable that each channel shows.
    """

    gain_share: Array = field(default_factory=NONE.copy)
    zero_n: Array = field(default_factory=NONE.copy)
    drift_n_per_s: Array = field(default_factory=NONE.copy)
    lag_s: Array = field(default_factory=NONE.copy)
    limit_n: Array = field(default_factory=NONE.copy)
    seen_by: tuple[int, ...] = tuple(range(8))


@dataclass(frozen=True)
class CameraFault:
    """Faults of the camera and of its clock.

    Parameters
    ----------
    latency_s
        Stamps are late by it.
    latency_jitter_share
        Its scatter from frame to frame, relative.
    exposure_s
        Over which a pose is averaged.
    axis_rad
        Rotation vector of a camera that stands askew, shape (3,).
    gain_share
        Relative.
    readout_s
        From the first row to the last of a rolling shutter.
    drift_ppm
        By which its clock is fast.
    frames, at_s
        How many frames go missing without a gap in the stamps, and when.
    """

    latency_s: float = 0.0
    latency_jitter_share: float = 0.0
    exposure_s: float = 0.0
    axis_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gain_share: float = 0.0
    readout_s: float = 0.0
    drift_ppm: float = 0.0
    frames: int = 0
    at_s: float = 0.0


@dataclass(frozen=True)
class Faults:
    """All of them."""

    cell: CellFault = CellFault()
    camera: CameraFault = CameraFault()

    def joined(self, other: "Faults") -> "Faults":
        """Both together; where both set the same number, the other's."""
        return Faults(_joined(self.cell, other.cell), _joined(self.camera, other.camera))


def _joined(one: Fault, other: Fault) -> Fault:
    sound = type(one)()
    parts = {
        name: value
        for name, value in vars(other).items()
        if not np.array_equal(value, getattr(sound, name))
    }
    return replace(one, **parts)


def read_cells(time_s: Array, tension_n: Array, fault: CellFault) -> Array:
    """What the cells would report at every step, without noise.

    Parameters
    ----------
    time_s
        Evenly spaced, shape (n,), s.
    tension_n
        Shape (n, 8), N.
    fault
        Of the cells.
    """
    seen = tension_n[:, list(fault.seen_by)].copy()
    length = max(float(time_s[-1]), 1e-9)
    for i in range(seen.shape[1]):
        if fault.lag_s[i] > 0.0:
            seen[:, i] = _slow(seen[:, i], fault.lag_s[i], time_s[1] - time_s[0])
        seen[:, i] *= 1.0 + fault.gain_share[i]
        share = time_s / length
        bent = time_s * (1.0 + DRIFT_BEND * (1.0 - share))
        seen[:, i] += fault.zero_n[i] + fault.drift_n_per_s[i] * bent
        if fault.limit_n[i] > 0.0:
            # Log-sum-exp of value and limit: a soft knee.
            over = (seen[:, i] - fault.limit_n[i]) / KNEE_N
            seen[:, i] = fault.limit_n[i] - KNEE_N * np.logaddexp(0.0, -over)
    return seen


def _slow(values: Array, lag_s: float, step_s: float) -> Array:
    """Two low-passes in a row, each of what runs straight from sample to sample."""
    from scipy.signal import lfilter

    for share in (LAG_RATIO / (1.0 + LAG_RATIO), 1.0 / (1.0 + LAG_RATIO)):
        steps = step_s / (share * lag_s)
        keep = np.exp(-steps)
        mean = (1.0 - keep) / steps
        settled = [mean * values[0]]
        values = lfilter([1.0 - mean, mean - keep], [1.0, -keep], values, zi=settled)[0]
    return values


def see(
    time_s: Array, pose: Array, stamp_s: Array, fault: CameraFault, wander: Array | float = 0.0
) -> Array:
    """Poses that the camera would report at its stamps, without noise.

    Parameters
    ----------
    time_s, pose
        What happened, shapes (n,) and (n, 6); m and rad.
    stamp_s
        Shape (m,).
    fault
        Of the camera.
    wander
        Scatter of the latency, in units of its share; shape (m,).

    Returns
    -------
    Array
        Shape (m, 6); m and rad.
    """
    from scipy.interpolate import make_interp_spline

    curve = make_interp_spline(time_s, pose, k=3)

    def look(at_s: Array) -> Array:
        return np.asarray(curve(np.clip(at_s, time_s[0], time_s[-1])))

    at_s = stamp_s / (1.0 + 1e-6 * fault.drift_ppm)
    if fault.frames:
        interval_s = float(np.median(np.diff(stamp_s)))
        at_s = at_s + fault.frames * interval_s * (stamp_s >= fault.at_s)
    at_s = at_s - fault.latency_s * (1.0 + fault.latency_jitter_share * np.asarray(wander))
    if fault.exposure_s > 0.0:
        shares = (np.arange(EXPOSURE_POINTS) + 0.5) / EXPOSURE_POINTS - 0.5
        seen = np.mean([_rows(look, at_s + s * fault.exposure_s, fault) for s in shares], axis=0)
    else:
        seen = _rows(look, at_s, fault)
    return (1.0 + fault.gain_share) * _askew(seen, fault.axis_rad)


def _rows(look: Look, at_s: Array, fault: CameraFault) -> Array:
    """Rolling shutter: each marker is seen when its row is read; a rigid body fitted to them."""
    pose = look(at_s)
    if fault.readout_s == 0.0:
        return pose
    from scipy.spatial.transform import Rotation

    seen = np.empty((len(at_s), len(MARKERS), 3))
    for j, marker in enumerate(MARKERS):
        late_s = fault.readout_s * (pose[:, 2] + marker[2]) / FIELD_M
        then = look(at_s + late_s)
        seen[:, j] = then[:, :3] + Rotation.from_euler("xyz", then[:, 3:]).apply(marker)
    middle = MARKERS.mean(axis=0)
    out = np.empty_like(pose)
    for n, points in enumerate(seen):
        centre = points.mean(axis=0)
        turned, _ = Rotation.align_vectors(points - centre, MARKERS - middle)
        out[n, 3:] = turned.as_euler("xyz")
        out[n, :3] = centre - turned.apply(middle)
    return out


def _askew(pose: Array, axis_rad: tuple[float, float, float]) -> Array:
    """R_m = C R C^T and x_m = C x, C the rotation between the camera's frame and O-XYZ."""
    if not np.any(axis_rad):
        return pose
    from scipy.spatial.transform import Rotation

    frame = Rotation.from_rotvec(axis_rad)
    turned = frame * Rotation.from_euler("xyz", pose[:, 3:]) * frame.inv()
    return np.hstack([frame.apply(pose[:, :3]), turned.as_euler("xyz")])
