"""One case: a true machine, the runs made with it and what they conceal."""

from dataclasses import dataclass, field, replace

import numpy as np

from analysis.challenge.plants import (
    FIRST,
    Concealed,
    Course,
    Measured,
    Offset,
    Plant,
    Sensing,
    plant_named,
)
from cdpr8.rigfile import Excitation, Rig


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
    plant
        Which makes its runs.
    """

    name: str
    kind: str
    runs: tuple[PlannedRun, ...]
    sensing: Sensing
    offset: Offset
    concealed: tuple[Concealed, ...] = ()
    plant: Plant = field(default_factory=lambda: plant_named(FIRST))

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
            step_s = self.plant.fine_step_s
        return self.recorded(run, self.happened(run, step_s), noise=noise)

    def happened(self, run: PlannedRun, step_s: float | None = None) -> Course:
        """What the machine does in one of its runs."""
        if step_s is None:
            step_s = self.plant.step_s
        found: Course = self.plant.happened(run.rig, self.offset, self.concealed, step_s)
        return found

    def recorded(self, run: PlannedRun, course: Course, *, noise: bool = True) -> Measured:
        """What cells and camera make of it."""
        found: Measured = self.plant.recorded(
            run.rig, self.offset, self.concealed, course, self.sensing, run.seed, noise=noise
        )
        return found
