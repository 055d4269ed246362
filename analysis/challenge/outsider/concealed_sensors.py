"""Effects of the force cells, of the camera and of the clocks."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.camera import CameraFault
from analysis.challenge.outsider.cells import CellFault
from analysis.challenge.outsider.concealed import (
    Details,
    Effect,
    Law,
    Parts,
    Scene,
    between,
    direction,
    unsaid,
)
from analysis.challenge.outsider.record import Faults
from analysis.challenge.outsider.shutter import ROWS

Array = NDArray[np.float64]

ONE, ONE_OR_PAIR = {"one": 1.0}, {"one": 0.5, "pair": 0.5}

FEWEST, MOST_FRAMES = 1, 4
FIRST_FRAME, LAST_FRAME = 30, 150
"""Frames go missing between these: later is still enough to see it."""


def _cell(make: Callable[[Array, Details], CellFault]) -> Law:
    def law(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
        return Parts(faults=Faults(cell=make(size * mask, details)))

    return law


def _camera(make: Callable[[float, Details], CameraFault]) -> Law:
    def law(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
        return Parts(faults=Faults(camera=make(size, details)))

    return law


def _limit_n(size: float, details: Details) -> float:
    """Size: which share of the way from rest to the highest tension is cut off."""
    return details["rest_n"] + (1.0 - size) * (details["top_n"] - details["rest_n"])


def _saturated(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(faults=Faults(cell=CellFault(limit_n=_limit_n(size, details) * mask)))


def _limit_told(size: float, mask: Array, details: Details) -> dict[str, float]:
    return {"limit_n": _limit_n(size, details)}


def _swapped(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    seen = np.arange(8)
    chosen = np.flatnonzero(mask)
    if size > 0.5:
        seen[chosen] = chosen[::-1]
    return Parts(faults=Faults(cell=CellFault(seen_by=tuple(int(i) for i in seen))))


def _turned(size: float, details: Details) -> Array:
    """A rotation vector, rad."""
    return np.asarray(np.radians(size) * direction(details))


def _askew(size: float, details: Details) -> CameraFault:
    x, y, z = _turned(size, details).tolist()
    return CameraFault(axis_rad=(x, y, z))


def _askew_told(size: float, mask: Array, details: Details) -> dict[str, float]:
    names = ("axis_roll_deg", "axis_pitch_deg", "axis_yaw_deg")
    return dict(zip(names, np.degrees(_turned(size, details)).tolist(), strict=True))


def _mostly_across(generator: np.random.Generator) -> dict[str, float]:
    """A turn about the axis of the pitch itself is hard to see: less of it."""
    x, y, z = generator.standard_normal(3).tolist()
    return {"x": x, "y": 0.3 * y, "z": z}


def _lost(size: float, details: Details) -> CameraFault:
    count = round(size)
    return CameraFault(lost_before=tuple(int(details[f"before_{j}"]) for j in range(count)))


def _when(generator: np.random.Generator) -> dict[str, float]:
    """Before which frames one is lost, for as many as may be."""
    drawn = generator.choice(np.arange(FIRST_FRAME, LAST_FRAME), MOST_FRAMES, replace=False)
    return {f"before_{j}": float(frame) for j, frame in enumerate(drawn)}


def _lost_told(size: float, mask: Array, details: Details) -> dict[str, float]:
    return {"frames": float(round(size))}


SENSOR_EFFECTS = (
    Effect(
        "cell_gain", "cell", "gain_share", "1", 0.05, 0.2,
        _cell(lambda values, _: CellFault(gain_share=values)), ONE_OR_PAIR, signed=True,
    ),
    Effect(
        "cell_zero", "cell", "zero_n", "N", 0.75, 4.0,
        _cell(lambda values, _: CellFault(zero_n=values)), ONE, signed=True, least=0.4,
    ),
    Effect(
        "cell_drift", "cell", "drift_n", "N", 0.7, 4.0,
        _cell(lambda values, more: CellFault(drift_n=values, drift_s=more["drift_s"])),
        ONE_OR_PAIR, between(drift_s=(6.0, 20.0)), signed=True, told=unsaid,
    ),
    Effect(
        "cell_lag", "cell", "lag_s", "s", 0.011, 0.06,
        _cell(lambda values, _: CellFault(lag_s=values)), {"one": 0.5, "all": 0.5},
    ),
    Effect(
        "cell_saturation", "cell", "cut_share", "1", 0.45, 0.9, _saturated, ONE, told=_limit_told
    ),
    Effect(
        "cell_swapped", "cell", "swapped", "1", 1.0, 1.0, _swapped, {"swap": 1.0}, told=unsaid,
        least=1.0,
    ),
    Effect(
        "camera_latency", "camera", "latency_s", "s", 0.017, 0.08,
        _camera(lambda size, _: CameraFault(latency_s=size)),
    ),
    Effect(
        "camera_exposure", "camera", "exposure_s", "s", 0.05, 0.0615,
        _camera(lambda size, _: CameraFault(exposure_s=size)), least=0.01,
    ),
    Effect(
        "camera_axis", "camera", "axis_deg", "deg", 3.2, 10.0, _camera(_askew),
        draw=_mostly_across, told=_askew_told,
    ),
    Effect(
        "camera_gain", "camera", "gain_share", "1", 0.043, 0.2,
        _camera(lambda size, _: CameraFault(gain_share=size)), signed=True,
    ),
    Effect(
        "camera_rolling_shutter", "camera", "readout_s", "s", 0.036, 0.06,
        _camera(lambda size, _: CameraFault(row_s=size / ROWS)),
    ),
    Effect(
        "clock_drift", "clock", "drift_ppm", "ppm", 1100.0, 5000.0,
        _camera(lambda size, _: CameraFault(drift_share=1e-6 * size)), signed=True, sound=30.0,
    ),
    Effect(
        "frames_dropped", "clock", "frames", "1", 1.0, MOST_FRAMES, _camera(_lost), draw=_when,
        told=_lost_told, least=FEWEST,
    ),
)  # fmt: skip
