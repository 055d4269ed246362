"""How fine the steps of a fit have to be: what they miss of a ring stays far below the noise.

Steps that keep a ring to a thousandth of its amplitude do where it is some times the noise. A
platform that is let go rings with a thousand times that, and what is missed of it, less than the
noise in each sample, is seen in thousands: a law that does nothing but ask for shorter steps then
explains it.
"""

import numpy as np

from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sight import Sight, seen_by
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.recorded import looked_at
from analysis.engine.whiten import sigmas_of
from model import Task
from model.method import find_method
from model.simulator import run
from model.task import THRIFTY

FINER = (1.0, 1.25, 1.5, 2.0, 2.5)
"""Times as many steps, the last of them as many as a simulation takes that is not for a fit."""

MISSES = 0.025
"""Rms of what steps may miss, in units of noise: of ten thousand samples a misfit of 6."""


def finer_steps(recording: Recording, task: Task, sight: Sight) -> dict[str, float]:
    """How many times as many steps a fit should take for each tone of the machine.

    Parameters
    ----------
    recording
        Says what noise is.
    task, sight
        How the machine moves, and how that is seen.

    Returns
    -------
    dict
        Method -> factor.
    """
    rate_hz = recording.output_hz(task)
    exact = seen_by(recording, run(task, output_rate_hz=rate_hz), sight)

    def missed(name: str, finer: float) -> float:
        step_s = task.step_s(find_method(name), thrifty=True, finer=finer)
        seen = seen_by(recording, run(task, name, step_s, rate_hz), sight)
        return max(
            _rms(bundle, one - other)
            for bundle, one, other in zip(recording.bundles, seen, exact, strict=True)
        )

    def least(name: str) -> float:
        return next((one for one in FINER[:-1] if missed(name, one) < MISSES), FINER[-1])

    return {name: least(name) for name in THRIFTY}


def _rms(bundle: Bundle, missed: Array) -> float:
    """Of the samples that count, in units of their noise."""
    inside = looked_at(bundle)
    if not inside.any():
        return 0.0
    return float(np.sqrt(np.mean((missed / sigmas_of(bundle))[inside] ** 2)))
