"""One run reduced to a row: amplitudes by the paper's definitions, and how it ended."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from cdpr8 import CABLES
from cdpr8.rigfile.schema import Rig
from model.batch import simulate_many
from model.jobs import Job, Row
from model.method import find_method
from model.simulation import Simulation
from model.summary import summarise
from model.sweep.plan import Plan, takes_half_step
from model.task import Disturbance, Task

AXES = ("x_mm", "y_mm", "z_mm", "roll_deg", "pitch_deg", "yaw_deg")

CABLE_COLUMNS = tuple(f"cable_{number}_mm" for number in range(1, CABLES + 1))

AMPLITUDES = (
    "displacement_mm",
    "rotation_deg",
    *AXES,
    "distance_mm",
    "max_pitch_deg",
    "cable_mm",
    *CABLE_COLUMNS,
    *(f"tension_{number}_n" for number in range(1, CABLES + 1)),
    "min_tension_n",
)
"""Columns of a row that are amplitudes.

``displacement_mm`` and ``rotation_deg`` are the paper's (Fig. 4): the largest deviation from X*
along any axis and of any angle. Below 8 Hz the paper has rotations under 0.3 deg at a commanded
2 deg: so amplitudes are of the deviation, and `max_pitch_deg` (Table II) is another thing. The
first six are followed by the deviation along each; ``distance_mm`` is of the centre of mass from
X*, ``cable_mm`` the largest of the eight |X_w|, ``tension_i_n`` is max |T_i - T_0i|.
"""


def run_block(rig: Rig, plan: Plan, jobs: Sequence[Job]) -> list[Row]:
    """Simulate a block of a sweep's runs side by side; each is reduced as it ends."""
    rows: dict[int, Row] = {}
    for halved in (False, True):
        chosen = [job for job in jobs if takes_half_step(job.values["repetition"]) is halved]
        if not chosen:
            continue
        step_s = plan.step_s or Task(rig).step_s(find_method(plan.method))
        found = simulate_many(
            [_task(rig, plan, job) for job in chosen],
            row,
            method=plan.method,
            step_s=0.5 * step_s if halved else step_s,
        )
        rows |= {job.number: {**job.values, **one} for job, one in zip(chosen, found, strict=True)}
    return [rows[job.number] for job in jobs]


def _task(rig: Rig, plan: Plan, job: Job) -> Task:
    return Task(
        rig,
        plan.excitation.model_copy(update={"frequency_hz": job.values["frequency_hz"]}),
        disturbance=start(plan, job.values["repetition"], job.generator()),
    )


def start(plan: Plan, repetition: int, generator: np.random.Generator) -> Disturbance:
    """The offsets of a run: the excitation's own in the first, changed a little in the others."""
    own = Disturbance.from_excitation(plan.excitation)
    if repetition == 0:
        return own
    change = 1.0 + plan.spread * generator.uniform(-1.0, 1.0, 3 + CABLES)
    x, y, z = (float(value) for value in np.array(own.platform_offset_m) * change[:3])
    cables = np.broadcast_to(own.cable_offset_m, CABLES) * change[3:]
    return Disturbance((x, y, z), tuple(float(value) for value in cables))


def row(simulation: Simulation) -> Row:
    """What a sweep keeps of a simulation; amplitudes are null where a blow-up left none."""
    outcome = simulation.outcome
    result: dict[str, Any] = {
        "status": str(outcome.status),
        "what": outcome.what,
        "when_s": outcome.time_s,
        "slack_share": outcome.slack_share,
        "step_s": simulation.stats.longest_step_s,
    }
    summary = summarise(simulation)
    if summary is None:
        return result | dict.fromkeys(AMPLITUDES)
    steady = simulation.steady
    deviation = np.abs(simulation.pose[steady] - simulation.commanded_pose[steady]).max(axis=0)
    along = [*(1e3 * deviation[:3]), *np.rad2deg(deviation[3:])]
    values = [
        max(along[:3]),
        summary.rotation_deg,
        *along,
        summary.displacement_mm,
        summary.max_pitch_deg,
        max(summary.cable_amplitude_mm),
        *summary.cable_amplitude_mm,
        *summary.tension_variation_n,
        summary.min_tension_n,
    ]
    return result | {
        name: float(f"{value:.9g}") for name, value in zip(AMPLITUDES, values, strict=True)
    }
