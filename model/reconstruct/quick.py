"""Runs of the paper's motion, of which only the amplitudes are kept."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import Rig
from model.batch import simulate_many
from model.simulation import Simulation
from model.simulator import simulate
from model.status import Status
from model.sweep.paper import EXCITATION
from model.task import Disturbance, Task

Array = NDArray[np.float64]

ROUGH_OUTPUT_HZ = 250.0
"""One row a step; over many periods of 18 rows the largest is found to a percent or better."""

EXACT_OUTPUT_HZ = 1000.0
"""The rows of design, section 4, over which the figures at 2.06 Hz are to print as published."""

FEWEST_SIDE_BY_SIDE = 5
"""Sixteen lanes cost about as much as this many runs one by one."""


@dataclass(frozen=True)
class Amplitudes:
    """Largest values over a run, in the units the paper prints.

    Parameters
    ----------
    displacement_mm, rotation_deg
        Of the deviation from X*, along the axis where it is largest.
    max_pitch_deg
        max |theta|.
    cable_mm, cable_5_mm
        max |X_wi|, of the cable where it is largest, and of cable 5.
    tension_1_n, tension_7_n
        max |T_i - T_0i|.
    min_tension_n
        Lowest tension of any cable.
    sound
        False where the run blew up; its amplitudes are then larger than any.
    """

    displacement_mm: float
    rotation_deg: float
    max_pitch_deg: float
    cable_mm: float
    cable_5_mm: float
    tension_1_n: float
    tension_7_n: float
    min_tension_n: float
    sound: bool


BLOWN_UP = Amplitudes(
    displacement_mm=1e4,
    rotation_deg=1e4,
    max_pitch_deg=1e4,
    cable_mm=1e4,
    cable_5_mm=1e4,
    tension_1_n=1e4,
    tension_7_n=1e4,
    min_tension_n=0.0,
    sound=False,
)


@dataclass(frozen=True)
class Case:
    """One run.

    Parameters
    ----------
    frequency_hz
        Of the commanded pitch.
    change
        By what share X_p0 and X_w0 of each cable differ from the excitation's: nine of them, or
        one for all.
    excitation
        The motion but for its frequency.
    """

    frequency_hz: float
    change: Array | float = 0.0
    excitation: Excitation = EXCITATION

    def task(self, rig: Rig) -> Task:
        """As the solver takes it."""
        own = self.excitation
        offsets = np.append(own.platform_offset_m[0], np.full(8, own.cable_offset_m))
        x, *cables = (float(value) for value in offsets * (1.0 + self.change))
        return Task(
            rig,
            own.model_copy(update={"frequency_hz": self.frequency_hz}),
            disturbance=Disturbance((x, 0.0, 0.0), tuple(cables)),
        )


def run(
    rig: Rig, cases: Sequence[Case], output_rate_hz: float = ROUGH_OUTPUT_HZ
) -> list[Amplitudes]:
    """Simulate cases of one machine: a few one by one, more side by side."""
    tasks = [case.task(rig) for case in cases]
    if len(tasks) >= FEWEST_SIDE_BY_SIDE:
        return simulate_many(tasks, _amplitudes, output_rate_hz=output_rate_hz)
    return [
        _amplitudes(
            simulate(
                rig, task.excitation, disturbance=task.disturbance, output_rate_hz=output_rate_hz
            )
        )
        for task in tasks
    ]


def _amplitudes(simulation: Simulation) -> Amplitudes:
    steady = simulation.steady
    if simulation.outcome.status is Status.BLOW_UP or not steady.any():
        return BLOWN_UP
    pose = simulation.pose[steady]
    deviation = np.abs(pose - simulation.commanded_pose[steady]).max(axis=0)
    cables = np.abs(simulation.cable_offset_m[steady]).max(axis=0)
    variation = np.abs(simulation.tension_variation_n[steady]).max(axis=0)
    return Amplitudes(
        displacement_mm=float(1e3 * deviation[:3].max()),
        rotation_deg=float(np.rad2deg(deviation[3:].max())),
        max_pitch_deg=float(np.rad2deg(np.abs(pose[:, 4]).max())),
        cable_mm=float(1e3 * cables.max()),
        cable_5_mm=float(1e3 * cables[4]),
        tension_1_n=float(variation[0]),
        tension_7_n=float(variation[6]),
        min_tension_n=float(simulation.tension_n.min()),
        sound=True,
    )
