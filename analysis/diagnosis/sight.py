"""What cells and camera would have reported of a simulation."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.recording import Recording
from analysis.engine.system import Prediction
from model import ActiveEffect, Simulation, observe

Array = NDArray[np.float64]

FAR = 1e6
"""Where a simulation blew up, everything is this far off."""

LEAST_ROWS = 3
"""Of a simulation, to see anything by: one that blew up at once has fewer."""


@dataclass(frozen=True)
class Sight:
    """How a simulation is looked at.

    Attributes
    ----------
    effects
        Of cells, camera and clocks.
    start_s
        When the simulation begins, on the clock of the tensions.
    pose_zero
        What the pose is off by, shape (6,), in m and rad.
    late_s
        How late each cell is read, shape (8,).
    """

    effects: tuple[ActiveEffect, ...]
    start_s: float
    pose_zero: Array
    late_s: Array

    @property
    def key(self) -> tuple[object, ...]:
        """Equal where simulations are looked at alike."""
        looked = tuple((one.name, *sorted(one.values.items())) for one in self.effects)
        return looked, self.start_s, self.pose_zero.tobytes(), self.late_s.tobytes()


def seen_by(recording: Recording, simulation: Simulation, sight: Sight) -> Prediction:
    """What cells and camera would report at the samples of a run.

    Of a simulation that blew up at once there is nothing to be seen: everything is far off.
    """
    if len(simulation.t_s) < LEAST_ROWS:
        return [np.full(one.value.shape, FAR) for one in recording.bundles]
    tensions = recording.bundles[: len(recording.cables)]
    longest = max(len(one.t_s) for one in tensions)
    times = np.full((longest, 8), simulation.t_s[0])
    for cable, one in zip(recording.cables, tensions, strict=True):
        times[: len(one.t_s), cable - 1] = one.t_s - sight.start_s - sight.late_s[cable - 1]
    simulation = _averaged(simulation, recording)
    stamps = recording.bundles[-1].t_s - sight.start_s if recording.has_pose else simulation.t_s[:1]
    seen = observe(simulation, sight.effects, tension_t_s=times, pose_t_s=stamps)
    found = [
        _finite(seen.tension_n[: len(one.t_s), cable - 1 : cable])
        for cable, one in zip(recording.cables, tensions, strict=True)
    ]
    if recording.has_pose:
        found.append(_finite(seen.pose + sight.pose_zero))
    return found


def _averaged(simulation: Simulation, recording: Recording) -> Simulation:
    """With tensions as means over the instants of a sample, which take from what is fast.

    To second order: a mean over instants of variance s^2 adds half of s^2 times the curvature.
    """
    if not any(recording.averaged_s2):
        return simulation
    variance_s2 = np.zeros(simulation.tension_n.shape[1])
    variance_s2[[cable - 1 for cable in recording.cables]] = recording.averaged_s2
    step_s = float(simulation.t_s[1] - simulation.t_s[0])
    curvature = np.zeros_like(simulation.tension_n)
    curvature[1:-1] = np.diff(simulation.tension_n, n=2, axis=0) / step_s**2
    return replace(simulation, tension_n=simulation.tension_n + 0.5 * variance_s2 * curvature)


def _finite(values: Array) -> Array:
    if np.abs(values).max(initial=0.0) < FAR:
        return values
    return np.clip(np.nan_to_num(values, nan=FAR, posinf=FAR, neginf=-FAR), -FAR, FAR)
