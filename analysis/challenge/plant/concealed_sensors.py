"""Effects of the force cells, of the camera and of the clocks."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.concealed import Details, Effect, Law, Parts, along, unsaid
from analysis.challenge.plant.machine import Machine
from analysis.challenge.plant.sensors import CameraFault, CellFault, Faults

Array = NDArray[np.float64]


def _cell(make: Callable[[Array], CellFault]) -> Law:
    def law(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
        return Parts(faults=Faults(cell=make(size * mask)))

    return law


def _camera(make: Callable[[float, Details], CameraFault]) -> Law:
    def law(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
        return Parts(faults=Faults(camera=make(size, details)))

    return law


def _saturated(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    """Size: which share of the way from rest to the highest tension is cut off."""
    limit = details["rest_n"] + (details["top_n"] - details["rest_n"]) * (1.0 - size)
    return Parts(faults=Faults(cell=CellFault(limit_n=limit * mask)))


def _limit(size: float, details: Details, machine: Machine) -> dict[str, float]:
    return {"limit_n": details["rest_n"] + (details["top_n"] - details["rest_n"]) * (1.0 - size)}


def _swapped(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    seen = np.arange(8)
    chosen = np.flatnonzero(mask)
    if size > 0.5:
        seen[chosen] = np.roll(chosen, -1)
    return Parts(faults=Faults(cell=CellFault(seen_by=tuple(int(i) for i in seen))))


def _axis(size: float, details: Details) -> CameraFault:
    vector = np.array([details["x"], details["y"], details["z"]])
    turn = np.deg2rad(size) * vector / np.linalg.norm(vector)
    return CameraFault(axis_rad=(float(turn[0]), float(turn[1]), float(turn[2])))


def _anywhere(generator: np.random.Generator) -> dict[str, float]:
    return dict(zip("xyz", generator.standard_normal(3).tolist(), strict=True))


def _frames(size: float, details: Details, machine: Machine) -> dict[str, float]:
    return {"frames": float(round(size))}


def _when(generator: np.random.Generator) -> dict[str, float]:
    return {"at_s": float(generator.uniform(3.0, 7.0))}


SENSOR_EFFECTS = (
    Effect(
        "cell_gain",
        "cell",
        "gain_share",
        "1",
        0.03,
        0.2,
        _cell(lambda values: CellFault(gain_share=values)),
        "one",
        signed=True,
    ),
    Effect(
        "cell_zero",
        "cell",
        "zero_n",
        "N",
        0.8,
        5.0,
        _cell(lambda values: CellFault(zero_n=values)),
        "one",
        signed=True,
        least=0.4,
    ),
    Effect(
        "cell_drift",
        "cell",
        "drift_n_per_s",
        "N/s",
        0.01,
        0.3,
        _cell(lambda values: CellFault(drift_n_per_s=values)),
        "one",
        signed=True,
    ),
    Effect(
        "cell_lag",
        "cell",
        "lag_s",
        "s",
        6e-3,
        0.08,
        _cell(lambda values: CellFault(lag_s=values)),
        "one",
    ),
    Effect("cell_saturation", "cell", "cut_share", "1", 0.3, 0.9, _saturated, "one", told=_limit),
    Effect(
        "cell_swapped", "cell", "swapped", "1", 1.0, 1.0, _swapped, "pair", least=1.0, told=unsaid
    ),
    Effect(
        "camera_latency",
        "camera",
        "latency_s",
        "s",
        0.012,
        0.08,
        _camera(lambda size, _: CameraFault(latency_s=size, latency_jitter_share=0.03)),
    ),
    Effect(
        "camera_exposure",
        "camera",
        "exposure_s",
        "s",
        0.03,
        0.06,
        _camera(lambda size, _: CameraFault(exposure_s=size)),
    ),
    Effect(
        "camera_axis",
        "camera",
        "axis_deg",
        "deg",
        1.5,
        8.0,
        _camera(_axis),
        "none",
        _anywhere,
        told=along("axis_roll_deg", "axis_pitch_deg", "axis_yaw_deg"),
    ),
    Effect(
        "camera_gain",
        "camera",
        "gain_share",
        "1",
        0.03,
        0.2,
        _camera(lambda size, _: CameraFault(gain_share=size)),
        signed=True,
    ),
    Effect(
        "camera_rolling_shutter",
        "camera",
        "readout_s",
        "s",
        0.02,
        0.06,
        _camera(lambda size, _: CameraFault(readout_s=size)),
    ),
    Effect(
        "clock_drift",
        "clock",
        "drift_ppm",
        "ppm",
        400.0,
        4000.0,
        _camera(lambda size, _: CameraFault(drift_ppm=size)),
        signed=True,
        sound=30.0,
    ),
    Effect(
        "frames_dropped",
        "clock",
        "frames",
        "1",
        1.0,
        4.0,
        _camera(lambda size, more: CameraFault(frames=round(size), at_s=more["at_s"])),
        "none",
        _when,
        least=1.0,
        told=_frames,
    ),
)
