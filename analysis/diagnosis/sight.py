"""What cells and camera would have reported of a simulation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.recording import Recording
from analysis.engine.system import Prediction
from model import ActiveEffect, Simulation, observe

Array = NDArray[np.float64]

FAR = 1e6
"""Where a simulation blew up, everything is this far off."""


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
    """What cells and camera would report at the samples of a run."""
    tensions = recording.bundles[: len(recording.cables)]
    longest = max(len(one.t_s) for one in tensions)
    times = np.full((longest, 8), simulation.t_s[0])
    for cable, one in zip(recording.cables, tensions, strict=True):
        times[: len(one.t_s), cable - 1] = one.t_s - sight.start_s - sight.late_s[cable - 1]
    stamps = recording.bundles[-1].t_s - sight.start_s if recording.has_pose else simulation.t_s[:1]
    seen = observe(simulation, sight.effects, tension_t_s=times, pose_t_s=stamps)
    found = [
        _finite(seen.tension_n[: len(one.t_s), cable - 1 : cable])
        for cable, one in zip(recording.cables, tensions, strict=True)
    ]
    if recording.has_pose:
        found.append(_finite(seen.pose + sight.pose_zero))
    return found


def _finite(values: Array) -> Array:
    return np.clip(np.nan_to_num(values, nan=FAR, posinf=FAR, neginf=-FAR), -FAR, FAR)
