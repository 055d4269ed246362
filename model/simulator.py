"""`simulate`: a machine, a motion, and what the paper's equations say happens (Eqs. 1 to 18)."""

import hashlib
from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdpr8.provenance import versions
from cdpr8.rigfile.schema import Excitation, Rig
from model.compiled import Announce
from model.drive import wrench_table
from model.kernel import PLATFORM_STATES, STATES
from model.machine import Machine
from model.method import Method, find_method
from model.motion import Motion, RampedSine
from model.outputs import cable_states
from model.simulation import Simulation, Stats
from model.steps import Steps, divide
from model.trajectory import Trajectory, integrate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Disturbance:
    """What is added to the state when the motion starts (Section 4.1 of the paper).

    Parameters
    ----------
    platform_offset_m
        X_p0 in O-XYZ, m.
    cable_offset_m
        X_w0 at mid-span: of every cable, or of each, shape (8,); m.
    """

    platform_offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    cable_offset_m: float | tuple[float, ...] = 0.0

    @classmethod
    def from_excitation(cls, excitation: Excitation) -> Self:
        """The disturbance a rig file's [excitation] asks for."""
        return cls(excitation.platform_offset_m, excitation.cable_offset_m)


NO_DISTURBANCE = Disturbance()


def simulate(
    rig: Rig,
    excitation: Excitation | None = None,
    *,
    excitation_effect: bool = True,
    disturbance: Disturbance | None = None,
    nominal: Rig | None = None,
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
    excitation_effect
        False sets X_w = 0 in Eq. 18: the paper's case without excitation effect.
    disturbance
        Acts when the motion starts. Default: the excitation's with excitation effect, none
        without.
    nominal
        The machine the drive was made for; default: `rig`. Fits change the plant only.
    method
        "dop853" or "rk4".
    step_s
        Longest step; default: what the method needs for this machine.
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
        No such method, or a rate or step that is not positive.

    Examples
    --------
    >>> from cdpr8.rigfile import load_rig
    >>> from model import simulate
    >>> simulate(load_rig()).outcome.sentence()  # doctest: +SKIP
    'ok: every cable taut, nothing diverged'
    """
    excitation = rig.excitation if excitation is None else excitation
    if disturbance is None:
        disturbance = (
            Disturbance.from_excitation(excitation) if excitation_effect else NO_DISTURBANCE
        )
    machine = Machine.from_rig(rig)
    driven = machine if nominal is None else Machine.from_rig(nominal)
    motion = RampedSine.from_excitation(excitation)
    scheme = find_method(method)
    longest_step_s = default_step_s(machine, scheme) if step_s is None else step_s
    steps = divide(motion, output_rate_hz, longest_step_s)
    wrench = wrench_table(driven, motion, steps.stage_s(scheme.nodes), steps.middle_s)
    trajectory = integrate(
        machine,
        scheme,
        steps,
        wrench,
        _state_at(motion, 0.0, -1.0) if steps.jump_point else np.zeros(STATES),
        _jump(motion, steps, disturbance, excitation_effect),
        announce,
    )
    stats = Stats(
        method=method,
        longest_step_s=round(float(steps.step_s.max()), 12),
        steps=trajectory.steps_taken,
        derivatives=trajectory.derivatives,
        solve_s=trajectory.solve_s,
    )
    return _result(machine, motion, trajectory, stats, _provenance(rig, nominal, excitation))


def default_step_s(machine: Machine, method: Method) -> float:
    """The longest step a method should take for a machine, by its highest tone, in s."""
    highest = max(machine.cable_tones_hz.max(), machine.platform_tones_hz.max())
    return method.step_s(float(highest))


def _state_at(motion: Motion, time_s: float, within_s: float) -> Array:
    """The state of a platform that follows X*, cables at rest."""
    pose, rate, _ = motion.at(np.array(time_s), np.array(within_s))
    state = np.zeros(STATES)
    state[0:6], state[6:12] = pose, rate
    return state


def _jump(motion: Motion, steps: Steps, disturbance: Disturbance, excitation_effect: bool) -> Array:
    """What the state gains when the motion starts: any jump of X* and X*', X_p0 and X_w0."""
    at = steps.jump_point
    middle_s = steps.middle_s[:, 0]
    jump = _state_at(motion, motion.start_s, middle_s[min(at, len(middle_s) - 1)])
    if at > 0:
        jump -= _state_at(motion, motion.start_s, middle_s[at - 1])
    jump[0:3] += disturbance.platform_offset_m
    if excitation_effect:
        cables = (STATES - PLATFORM_STATES) // 2
        jump[PLATFORM_STATES : PLATFORM_STATES + cables] += disturbance.cable_offset_m
    return jump


def _result(
    machine: Machine,
    motion: Motion,
    trajectory: Trajectory,
    stats: Stats,
    provenance: dict[str, object],
) -> Simulation:
    pose, rate = trajectory.states[:, 0:6], trajectory.states[:, 6:12]
    vibration = trajectory.states[:, PLATFORM_STATES:STATES]
    mid_span, mid_span_rate = vibration[:, : machine.cables], vibration[:, machine.cables :]
    cables = cable_states(machine, pose, rate, mid_span)
    at_rest = trajectory.time_s < motion.start_s
    return Simulation(
        t_s=trajectory.time_s,
        pose=pose,
        pose_rate=rate,
        commanded_pose=motion.at(trajectory.time_s)[0],
        tension_n=cables.tension_n,
        elongation_m=cables.elongation_m,
        axial_velocity_m_per_s=cables.axial_velocity_m_per_s,
        cable_offset_m=mid_span,
        cable_offset_rate_m_per_s=mid_span_rate,
        rest_tension_n=(
            cables.tension_n[at_rest].mean(axis=0) if at_rest.any() else machine.pretension
        ),
        steady_window_s=motion.steady_window_s,
        outcome=trajectory.outcome,
        stats=stats,
        provenance=provenance,
    )


def _provenance(rig: Rig, nominal: Rig | None, excitation: Excitation) -> dict[str, object]:
    return {
        "rig": rig.name,
        "rig_sha256": _digest(rig),
        "nominal_sha256": _digest(nominal or rig),
        "excitation": excitation.model_dump(mode="json"),
        "versions": _versions(),
    }


def _digest(rig: Rig) -> str:
    """Of the values, so that comments and order in the file do not matter."""
    return hashlib.sha256(rig.model_dump_json().encode()).hexdigest()


@cache
def _versions() -> dict[str, str]:
    return versions()
