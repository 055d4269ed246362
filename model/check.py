"""Can the numbers be believed: the run with half the step, and the energy of free vibration."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import Rig
from model.compiled import Announce
from model.extras import pack
from model.kernel import STATES
from model.machine import Machine
from model.method import find_method
from model.motion import RampedSine
from model.outputs import cable_states, mechanical_energy
from model.simulation import Simulation
from model.simulator import simulate
from model.steps import divide
from model.task import Task
from model.trajectory import integrate

Array = NDArray[np.float64]

HALVING_TOLERANCE = 1e-5
"""Largest change by halving the step, as a fraction of the quantity's own largest value."""

ENERGY_TOLERANCE = 1e-6
"""Largest drift of the energy of free vibration, as a fraction of it."""

RELEASE_POSE = np.array([5e-3, -3e-3, 4e-3, 0.010, -0.015, 0.020])
"""Direction in which the platform is let go: every axis; m and rad."""

RELEASE_SHARE = 0.1
"""How far it is let go: this share of what would make the first cable slack."""

FREE_DURATION_S = 10.0


@dataclass(frozen=True)
class Check:
    """One check of the numbers.

    Parameters
    ----------
    name
        What was compared.
    value, tolerance
        What was found, and what is allowed.
    """

    name: str
    value: float
    tolerance: float

    @property
    def passed(self) -> bool:
        """Whether the value is within the tolerance."""
        return self.value <= self.tolerance

    def sentence(self) -> str:
        """One line."""
        verdict = "ok" if self.passed else "FAILED"
        return f"{verdict}: {self.name} {self.value:.2g} (allowed {self.tolerance:.0e})"


def step_halving(rig: Rig, simulation: Simulation, excitation: Excitation, **how: object) -> Check:
    """Repeat a simulation with half its step.

    Parameters
    ----------
    rig, excitation
        As they were.
    simulation
        What is checked.
    how
        The other arguments of `simulate`, as they were.

    Returns
    -------
    Check
        The largest change of pose, tensions and cable amplitudes, each as a fraction of its own
        largest value. Infinite where one run blew up earlier than the other.
    """
    arguments: dict[str, Any] = {**how, "step_s": 0.5 * simulation.stats.longest_step_s}
    finer = simulate(rig, excitation, **arguments)
    changes = [
        _change(simulation.pose[:, :3], finer.pose[:, :3]),
        _change(simulation.pose[:, 3:], finer.pose[:, 3:]),
        _change(simulation.tension_n, finer.tension_n),
        _change(simulation.cable_offset_m, finer.cable_offset_m),
    ]
    return Check("change by halving the step", max(changes), HALVING_TOLERANCE)


def free_energy(
    rig: Rig,
    *,
    method: str = "dop853",
    step_s: float | None = None,
    announce: Announce | None = None,
) -> Check:
    """Let the platform go from beside its rest, undriven, undamped, X_w = 0, and weigh its energy.

    Parameters
    ----------
    rig
        The machine.
    method, step_s, announce
        As for `simulate`.

    Returns
    -------
    Check
        The largest change of the energy over 10 s, as a fraction of what was put in.
    """
    machine = Machine.from_rig(rig)
    scheme = find_method(method)
    motion = RampedSine(
        axis=1,
        amplitude_rad=0.0,
        frequency_hz=1.0,
        start_s=0.0,
        motion_s=FREE_DURATION_S,
        ramp_s=0.0,
        duration_s=FREE_DURATION_S,
    )
    longest_step_s = Task(rig, effects=()).step_s(scheme) if step_s is None else step_s
    steps = divide(motion, 1000.0, longest_step_s, join=scheme.inside)
    released = np.zeros(STATES)
    released[:6] = _taut_release(machine)
    trajectory = integrate(
        machine,
        scheme,
        steps,
        np.zeros((steps.step_s.size, scheme.nodes.size, 6)),
        released,
        np.zeros(STATES),
        pack(machine, ()),
        announce,
    )
    pose, rate = trajectory.states[:, :6], trajectory.states[:, 6:12]
    energy = mechanical_energy(machine, pose, rate)
    rest = mechanical_energy(machine, np.zeros((1, 6)), np.zeros((1, 6)))[0]
    drift = float(np.abs(energy - energy[0]).max() / (energy[0] - rest))
    return Check("drift of the energy of free vibration", drift, ENERGY_TOLERANCE)


def _taut_release(machine: Machine) -> Array:
    """A pose beside rest at which every cable stays well taut: a slack cable is a kink."""
    pose = RELEASE_POSE[None, :]
    cables = cable_states(machine, pose, np.zeros((1, 6)), np.zeros((1, machine.cables)))
    change = np.abs(machine.stiffness * cables.elongation_m[0])
    return np.asarray(RELEASE_SHARE * float(np.min(machine.pretension / change)) * RELEASE_POSE)


def _change(coarse: Array, fine: Array) -> float:
    if len(coarse) != len(fine):
        return float("inf")
    largest = float(np.abs(fine).max())
    return float(np.abs(coarse - fine).max()) / largest if largest > 0.0 else 0.0
