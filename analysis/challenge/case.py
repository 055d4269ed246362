"""One case: a true machine, the runs made with it and what they conceal."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.concealed import Concealed, Parts
from analysis.challenge.plant.machine import Machine, Offset
from analysis.challenge.plant.plant import FINE_STEP_S, NOTHING, STEP_S, Course, simulate
from analysis.challenge.plant.record import Measured, Sensing, measure
from analysis.challenge.plant.sensors import Faults
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlannedRun:
    """One run as it will be made.

    Parameters
    ----------
    rig
        What its rig file will say, the excitation included.
    seed
        Of its sampling times and noise.
    """

    rig: Rig
    seed: np.random.SeedSequence

    @property
    def excitation(self) -> Excitation:
        """What is asked of the drive."""
        return self.rig.excitation


@dataclass(frozen=True)
class Case:
    """One case.

    Parameters
    ----------
    name
        "case_0001" and so on.
    kind
        "single" or "campaign".
    runs
        What is done.
    sensing
        How it is measured.
    offset
        True machine less the rig file.
    concealed
        None, one or two effects.
    """

    name: str
    kind: str
    runs: tuple[PlannedRun, ...]
    sensing: Sensing
    offset: Offset
    concealed: tuple[Concealed, ...] = ()

    def with_concealed(self, *concealed: Concealed) -> "Case":
        """The same machine and runs, other effects."""
        return replace(self, concealed=concealed)

    def made(self, run: PlannedRun, *, noise: bool = True, step_s: float | None = None) -> Measured:
        """One of its runs.

        Parameters
        ----------
        run
            Which.
        noise
            False: what would be recorded without noise, at the same times.
        step_s
            Of the integration, s; default: one that is not seen beside the noise.
        """
        if step_s is None:
            step_s = FINE_STEP_S
        return self.recorded(run, self.happened(run, step_s), noise=noise)

    def happened(self, run: PlannedRun, step_s: float = STEP_S) -> Course:
        """What the machine does in one of its runs."""
        hidden, offset = NOTHING, self.offset
        for parts in self._parts(run):
            hidden = hidden.joined(parts.hidden)
            offset = offset.with_set(**parts.offset)
        return simulate(run.rig, run.excitation, offset, hidden, step_s)

    def recorded(self, run: PlannedRun, course: Course, *, noise: bool = True) -> Measured:
        """What cells and camera make of it."""
        faults = Faults()
        for parts in self._parts(run):
            faults = faults.joined(parts.faults)
        return measure(course, self.sensing, faults, run.seed, noise=noise)

    def _parts(self, run: PlannedRun) -> list[Parts]:
        machine = Machine.from_rig(run.rig)
        return [one.parts(machine) for one in self.concealed]
