"""Frames that are missing without a mark, by what the poses after them show.

From a lost frame on every pose belongs to a later moment than its stamp says, by whole frames. In a
motion of some hertz that is tens of degrees of its phase, far more than parameters, drive or cables
move it, so a simulation of the rig file as it is tells before which frames it happened.
"""

from dataclasses import replace

import numpy as np

from analysis.diagnosis.moving import active
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sight import Sight, seen_by
from analysis.engine.array import Array
from analysis.engine.whiten import sigmas_of
from model import ActiveEffect, Simulation
from model.effects.frames_dropped import PLACES

MOST = 1 + PLACES
"""Frames that are looked for: as many as the effect has places for."""

FAR = 25.0
"""A pose counts as so far off at most, in units of what poses are usually off by, squared."""

CLEAR = 60.0
"""A frame is lost where poses after it are so much less far off, in the same units, summed."""


def lost_frames(
    recording: Recording, simulation: Simulation, sight: Sight, frame_hz: float
) -> tuple[float, ...]:
    """When single frames were lost, in s since the simulation began; twice where two were.

    Parameters
    ----------
    recording
        The run.
    simulation
        Of its rig file.
    sight
        How that is looked at.
    frame_hz
        Of the camera.
    """
    if not recording.has_pose:
        return ()
    bundle = recording.bundles[-1]
    stamps = bundle.t_s - sight.start_s
    off = np.array(
        [
            _off(recording, simulation, replace(sight, effects=_all_late(n, frame_hz)))
            for n in range(MOST + 1)
        ]
    )
    usual = float(np.median(off.min(axis=0)))
    lost = _staircase(np.minimum(off / max(usual, 1.0), FAR))
    steps = np.diff(lost)
    between = 0.5 * (stamps[1:] + stamps[:-1])
    return tuple(float(at) for at, step in zip(between, steps, strict=True) for _ in range(step))


def _all_late(count: int, frame_hz: float) -> tuple[ActiveEffect, ...]:
    values = {"frames": float(count), "at_s": 0.0, "frame_hz": frame_hz}
    return tuple(active({"frames_dropped": values}))


def _off(recording: Recording, simulation: Simulation, sight: Sight) -> Array:
    """How far each pose is off, squared, in units of noise, shape (frames,)."""
    bundle = recording.bundles[-1]
    seen = seen_by(recording, simulation, sight)[-1]
    return np.asarray(np.sum(((bundle.value - seen) / sigmas_of(bundle)) ** 2, axis=1))


def _staircase(off: Array) -> np.ndarray:
    """How many frames were lost before each, shape (frames,), from what each number of them costs.

    None before the first, never fewer than before; each costs `CLEAR`. The best of all such courses
    (Viterbi).
    """
    count, frames = off.shape
    costs = np.full(count, np.inf)
    costs[0] = off[0, 0]
    came = np.zeros((frames, count), dtype=np.int64)
    for k in range(1, frames):
        best = np.full(count, np.inf)
        for n in range(count):
            steps = costs[: n + 1] + CLEAR * (n - np.arange(n + 1))
            came[k, n] = int(np.argmin(steps))
            best[n] = steps[came[k, n]] + off[n, k]
        costs = best
    course = np.zeros(frames, dtype=np.int64)
    course[-1] = int(np.argmin(costs))
    for k in range(frames - 1, 0, -1):
        course[k - 1] = came[k, course[k]]
    return course
