"""`simulate`: a machine, a motion, and what the paper's equations say happens (Eqs. 1 to 18)."""

import hashlib
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cdpr8.provenance import versions
from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import Rig
from model.compiled import Announce, compiled
from model.kernel import PLATFORM_STATES, STATES
from model.library.selection import ActiveEffect
from model.method import find_method
from model.motion import Motion
from model.simulation import Simulation, Stats
from model.status import outcome
from model.steps import Steps
from model.task import Disturbance, Task
from model.trajectory import Trajectory, integrate

Array = NDArray[np.float64]

__all__ = ["Disturbance", "simulate"]


def simulate(
    rig: Rig,
    excitation: Excitation | None = None,
    *,
    motion: Motion | None = None,
    effects: Sequence[ActiveEffect] | None = None,
    excitation_effect: bool = True,
    disturbance: Disturbance | None = None,
    nominal: Rig | None = None,
    drive: str | None = None,
    method: str = "dop853",
    step_s: float | None = None,
    output_rate_hz: float = 1000.0,
    announce: Announce | None = None,
) -> Simulation:
    """Simulate one motion of a machine.

    Parameters
    ----------
    rig
        The machine.
    excitation
        The commanded motion; default: the rig's own.
    motion
        Any other motion, in place of the excitation's.
    effects
        Left-out effects (`model.effects`); default: those the rig file has switched on. Those of
        cells, camera and clocks are kept for `model.observe` and change nothing here.
    excitation_effect
        False sets X_w = 0 in Eq. 18: the paper's case without excitation effect.
    disturbance
        Acts when the motion starts. Default: the excitation's with excitation effect, none
        without.
    nominal
        The machine the drive was made for; default: `rig`. Fits and effects change the plant only.
    drive
        "wrench" or "winch"; default: the excitation's.
    method
        "dop853", "dp5" or "rk4".
    step_s
        Longest step; default: what the method needs for this machine and these effects.
    output_rate_hz
        Rows a second.
    announce
        Told one line if the kernel has to be compiled first, which takes some seconds.

    Returns
    -------
    Simulation
        Slack cables and blow-ups are its `outcome`.

    Raises
    ------
    UsageError
        No such method, drive or effect, a value that is not plausible, or a rate or step that is
        not positive.

    Examples
    --------
    >>> from cdpr8.rigfile import load_rig
    >>> from model import simulate
    >>> simulate(load_rig()).outcome.sentence()  # doctest: +SKIP
    'ok: every cable taut, nothing diverged'
    """
    task = Task(
        rig=rig,
        excitation=excitation,
        motion=motion,
        effects=effects,
        excitation_effect=excitation_effect,
        disturbance=disturbance,
        nominal=nominal,
        drive=drive,
    )
    return run(task, method, step_s, output_rate_hz, announce)


def run(
    task: Task,
    method: str = "dop853",
    step_s: float | None = None,
    output_rate_hz: float = 1000.0,
    announce: Announce | None = None,
) -> Simulation:
    """Simulate a task; see `simulate`."""
    scheme = find_method(method)
    steps = task.steps(scheme, output_rate_hz, step_s)
    trajectory = integrate(
        task.machine,
        scheme,
        steps,
        task.drive_at_stages(scheme, steps),
        task.initial(steps),
        task.jump(steps),
        task.extras,
        announce,
    )
    cables = np.empty((5, *trajectory.states.shape[:1], task.machine.cables))
    compiled("observe")(
        trajectory.states,
        task.drive_at_outputs(steps),
        task.machine.plant(),
        task.extras,
        cables,
    )
    return as_simulation(task, steps, trajectory, cables, method)


def as_simulation(
    task: Task, steps: Steps, trajectory: Trajectory, cables: Array, method: str
) -> Simulation:
    """The result as a value.

    Parameters
    ----------
    task, steps, trajectory
        What was asked for, and what came of it.
    cables
        L_i, Delta L_i, v_yi, the tension at the anchor and behind the pulley, shape (5, n, 8).
    method
        Its name.
    """
    pose, rate = trajectory.states[:, 0:6], trajectory.states[:, 6:12]
    vibration = trajectory.states[:, PLATFORM_STATES:STATES]
    count = task.machine.cables
    _, elongation, axial_velocity, at_anchor, behind = cables
    tension = np.where(task.cells_behind_pulley, behind, at_anchor)
    at_rest = trajectory.time_s < task.command.start_s
    return Simulation(
        t_s=trajectory.time_s,
        pose=pose,
        pose_rate=rate,
        commanded_pose=task.command.at(trajectory.time_s)[0],
        tension_n=tension,
        anchor_tension_n=at_anchor,
        elongation_m=elongation,
        axial_velocity_m_per_s=axial_velocity,
        cable_offset_m=vibration[:, :count],
        cable_offset_rate_m_per_s=vibration[:, count:],
        rest_tension_n=(
            tension[at_rest].mean(axis=0) if at_rest.any() else task.machine.pretension
        ),
        steady_window_s=task.command.steady_window_s,
        outcome=outcome(
            trajectory.time_s, at_anchor, culprit=trajectory.culprit, end_s=trajectory.end_s
        ),
        stats=Stats(
            method=method,
            longest_step_s=round(float(steps.step_s.max()), 12),
            steps=trajectory.steps_taken,
            derivatives=trajectory.derivatives,
            solve_s=trajectory.solve_s,
        ),
        provenance=_provenance(task),
        effects=task.acting,
    )


def _provenance(task: Task) -> dict[str, object]:
    return {
        "rig": task.rig.name,
        "rig_sha256": digest(task.rig),
        "nominal_sha256": digest(task.nominal or task.rig),
        "excitation": task.asked.model_dump(mode="json"),
        "drive": task.drive_kind,
        "effects": {one.name: one.as_table() for one in task.acting},
        "versions": _versions(),
    }


def digest(rig: Rig) -> str:
    """Of the values, so that comments and order in the file do not matter."""
    return hashlib.sha256(rig.model_dump_json().encode()).hexdigest()


@lru_cache(maxsize=1)
def _versions() -> dict[str, str]:
    return versions()
