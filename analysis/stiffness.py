"""The paper's own step (its Section 5): cable stiffnesses from a low-frequency run.

Tension over elongation, cable by cable: the measured pose gives the lengths (Eqs. 1 and 9), and
T_i = T_0i + k_i Delta L_i is regressed at the tension's own sample times. What follows the
elongation is stiffness; what follows its rate is not, and is told apart: damping, timing or
friction (`analysis.stiffness_bias`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.nuisances import (
    CAMERA_AXIS_DEG,
    CAMERA_SHARE,
    CELL_SHARE,
    LATENCY_S,
    POSE_ZERO_M,
    POSE_ZERO_RAD,
    SAMPLE_S,
)
from analysis.diagnosis.recording import Recording
from analysis.steady import Steady, steady
from analysis.stiffness_bias import Bias, biases
from cdpr8.errors import DataError
from model import Machine

Array = NDArray[np.float64]

TELLING = 0.1
"""A stiffness known no better than to this share is not written: the cable hardly moves."""

STRANGE = 4.0
"""Runs that differ by more than this, in sigmas, are told of."""

FEW_FRAMES = 4.0
"""Frames a period below which a camera hardly supports the elongation."""


@dataclass(frozen=True)
class CableStiffness:
    """One cable.

    Attributes
    ----------
    cable
        1 to 8.
    value, sigma
        k_w and its standard uncertainty, N/m.
    parts
        What `sigma` is made of, N/m: "noise" (cells and poses, as correlated as their residuals
        are), "geometry" (anchor and base points, the plate's zero, the camera's axes; the pose is
        that of the rig file's centre of mass, wherever the true one is), "calibration" (of cell and
        camera), "timing" (the clocks).
    rig_value, rig_sigma
        Of the rig file.
    moved_m
        Amplitude of the elongation in the run where it is largest, m.
    told
        Whether the cable moved enough.
    bias
        What follows the rate of elongation, and by how much that could bias the value.
    spread
        Between runs, in sigmas of the noise: root of chi2 over its degrees; 0 for one run.
    """

    cable: int
    value: float
    sigma: float
    parts: dict[str, float]
    rig_value: float
    rig_sigma: float
    moved_m: float
    told: bool
    bias: Bias
    spread: float

    @property
    def off_sigmas(self) -> float:
        """Distance from the rig file's value, in sigmas of both."""
        return (self.value - self.rig_value) / float(np.hypot(self.sigma, self.rig_sigma) or 1.0)


@dataclass(frozen=True)
class Stiffnesses:
    """What the runs say of all cables.

    Attributes
    ----------
    recordings
        The runs.
    cables
        One each.
    lag_s, lag_sigma_s
        By how much tensions lead the elongation in all cables alike, s.
    warnings
        What a reader must know.
    """

    recordings: tuple[Recording, ...]
    cables: tuple[CableStiffness, ...]
    lag_s: float
    lag_sigma_s: float
    warnings: tuple[str, ...]


def stiffnesses(recordings: Sequence[Recording]) -> Stiffnesses:
    """Stiffness of each cable, from runs of one machine.

    Parameters
    ----------
    recordings
        The runs.

    Raises
    ------
    DataError
        A run has no poses, or no steady motion.
    """
    parts = [steady(one) for one in recordings]
    slopes = [_slopes(one, recording) for one, recording in zip(parts, recordings, strict=True)]
    numbers = sorted(set.intersection(*(set(one.cables) for one in recordings)))
    if not numbers:
        raise DataError(
            "no cable has usable tensions in all of these runs",
            where=", ".join(one.run.name for one in recordings),
        )
    rig = recordings[0].rig
    found, biased = [], biases(parts, [one.value for one in slopes])
    for i in (c - 1 for c in numbers):
        noise = np.array([one.noise[i] for one in slopes])
        value = np.array([one.value[i] for one in slopes])
        weight = noise**-2 / (noise**-2).sum()
        mean = float(weight @ value)
        each = list(zip(weight, slopes, strict=True))
        systematic = {
            name: float(np.linalg.norm(sum(w * one.systematic[name][:, i] for w, one in each)))
            for name in ("geometry", "timing")
        }
        budget = {
            "noise": float(np.sqrt((weight**2 * noise**2).sum())),
            "geometry": systematic["geometry"],
            "calibration": abs(mean) * float(np.hypot(CELL_SHARE, CAMERA_SHARE)),
            "timing": systematic["timing"],
        }
        sigma = float(np.linalg.norm(list(budget.values())))
        chi2 = float((((value - mean) / noise) ** 2).sum())
        row = rig.cable[i].stiffness_n_per_m
        found.append(
            CableStiffness(
                cable=i + 1,
                value=mean,
                sigma=sigma,
                parts=budget,
                rig_value=row.value,
                rig_sigma=row.sigma,
                moved_m=max(float(one.moved_m[i]) for one in parts),
                told=bool(np.isfinite(sigma)) and 0.0 < sigma < TELLING * abs(mean) and mean > 0.0,
                bias=biased.cables[i],
                spread=float(np.sqrt(chi2 / (len(value) - 1))) if len(value) > 1 else 0.0,
            )
        )
    warnings = [*_warnings(recordings, found), *biased.sentences(tuple(found_numbers(found)))]
    return Stiffnesses(
        tuple(recordings), tuple(found), biased.lag_s, biased.lag_sigma_s, tuple(warnings)
    )


def found_numbers(cables: Sequence[CableStiffness]) -> list[int]:
    """Numbers of the cables that moved enough."""
    return [one.cable for one in cables if one.told]


@dataclass(frozen=True)
class _Slopes:
    """Of one run: value and noise, shape (8,), and what one sigma of each parameter does."""

    value: Array
    noise: Array
    systematic: dict[str, Array]


def _slopes(part: Steady, recording: Recording) -> _Slopes:
    machine = Machine.from_rig(recording.rig)
    value = part.slopes(machine.base, machine.anchor)
    # The fitted elongation is the true one and its noise, which flattens the slope.
    square = part.moved_m**2
    value = value * square / np.maximum(square - 2.0 * part.pose_noise_m**2, 0.25 * square)
    noise = np.hypot(part.tension_noise_n, value * part.pose_noise_m) / part.moved_m
    changes = [
        part.slopes(machine.base + base, machine.anchor + anchor, zero, turn) - value
        for base, anchor, zero, turn in _geometry(recording)
    ]
    # Differences against the slope itself, not the one freed of attenuation.
    plain = part.slopes(machine.base, machine.anchor)
    changes = [one + value - plain for one in changes]
    late = float(np.hypot(LATENCY_S, np.hypot(SAMPLE_S, max(recording.offset_s))))
    sides = [part.slopes(machine.base, machine.anchor, late_s=sign * late) for sign in (1.0, -1.0)]
    timing = np.array([(sides[0] - sides[1]) / 2.0, (sides[0] + sides[1]) / 2.0 - plain])
    return _Slopes(value, noise, {"geometry": np.array(changes), "timing": timing})


def _geometry(recording: Recording) -> list[tuple[Array, Array, Array, Array]]:
    """Changes of base (8, 3), anchor (8, 3), the pose's zero (6,) and the camera's axes (3,)."""
    rig = recording.rig
    nothing = np.zeros((8, 3)), np.zeros((8, 3)), np.zeros(6), np.zeros(3)
    found = []
    for axis in range(3):
        unit = np.eye(3)[axis]
        base = np.array([cable.base_m.sigma for cable in rig.cable])[:, None] * unit
        anchor = np.array([cable.anchor_m.sigma for cable in rig.cable])[:, None] * unit
        found += [
            (base, *nothing[1:]),
            (nothing[0], anchor, *nothing[2:]),
            (*nothing[:3], np.deg2rad(CAMERA_AXIS_DEG) * unit),
        ]
    for axis in range(6):
        zero = np.eye(6)[axis] * (POSE_ZERO_M if axis < 3 else POSE_ZERO_RAD)
        found.append((*nothing[:2], zero, nothing[3]))
    return found


def _warnings(recordings: Sequence[Recording], cables: Sequence[CableStiffness]) -> list[str]:
    found = [f"{one.run.name}: {note}" for one in recordings for note in one.notes]
    for one in recordings:
        camera, hertz = one.rig.camera, one.excitation.frequency_hz
        if camera is not None and camera.fps < FEW_FRAMES * hertz:
            found.append(
                f"{one.run.name} was driven at {hertz:g} Hz, {camera.fps / hertz:.1f} frames a "
                "period: stiffness is for a slower run"
            )
        if not one.run.start.motion_start_known:
            found.append(
                f"{one.run.name} does not say when its motion started; none is needed here"
            )
    still = [str(one.cable) for one in cables if not one.told]
    if still:
        found.append(
            f"cable {', '.join(still)}: moves too little to tell its stiffness to "
            f"{100.0 * TELLING:g} %; the rig file's value stays. Move another axis, or farther"
        )
    apart = [str(one.cable) for one in cables if one.told and one.spread > STRANGE]
    if apart:
        found.append(
            f"cable {', '.join(apart)}: the runs differ by more than their noise; stiffness "
            "depends on amplitude, rate or tension here, or something else follows the elongation"
        )
    missing = sorted(set(range(1, 9)) - {one.cable for one in cables})
    if missing:
        listed = ", ".join(map(str, missing))
        found.append(f"cable {listed}: no usable tension; the rig file's value stays")
    return found
