"""The runs of a case as one vector in units of their noise, quickly made."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.case import Case
from analysis.challenge.plant.friction import BRISTLE_LOSS_S
from analysis.challenge.plant.machine import Machine
from analysis.challenge.plant.plant import Course

Array = NDArray[np.float64]

STEPS_S = (1e-3, 5e-4, 2.5e-4)
"""Of the integration: sensitivities are differences of equal steps, the longest that is stable."""

STABLE = 2.5
"""Limit of (w h)^2 + 2 c h for friction that sticks; 4 where nothing else were there."""

STRONGEST = 4.0
STIFFEST_RIVAL_N_PER_M = 6e3
"""Of the bristles of a rival at its usual size."""

APART = 1e6
"""Stands for tensions, N, and poses, m and rad, of a machine that came apart."""

COMPARED_HZ = 100.0
"""Faster samples are thinned to this rate, and weighed accordingly."""


@dataclass(frozen=True)
class Reference:
    """A machine and its runs with nothing concealed.

    Parameters
    ----------
    step_s
        Of the integration: differences are taken at equal steps.
    courses
        What the machine does in each run.
    data
        Their `whitened` data.
    """

    step_s: float
    courses: tuple[Course, ...]
    data: Array

    @classmethod
    def of(cls, case: Case, step_s: float) -> "Reference":
        """That of a case; what it conceals is left out."""
        bare = case.with_concealed()
        courses = tuple(bare.happened(run, step_s) for run in bare.runs)
        return cls(step_s, courses, whitened(bare, courses=courses))


def without_release(case: Case) -> Case:
    """The case less the runs where the platform is let go.

    An undamped platform rings there for as long as one looks: its phase tells every number to a
    part in a million, which no straight line follows and no real machine would keep.
    """
    ramped = tuple(run for run in case.runs if run.excitation.ramp_s > 0.0)
    return replace(case, runs=ramped or case.runs)


def whitened(
    case: Case, step_s: float = STEPS_S[0], courses: Sequence[Course] | None = None
) -> Array:
    """All runs of a case without noise, in units of it, shape (n,).

    Parameters
    ----------
    case
        What is done, and how it is measured.
    step_s
        Of the integration, s.
    courses
        What the machine does in each run, where it is known.
    """
    if courses is None:
        courses = [case.happened(run, step_s) for run in case.runs]
    return np.concatenate([_run(case, number, course) for number, course in enumerate(courses)])


def _run(case: Case, number: int, course: Course) -> Array:
    if np.isnan(course.pose[-1, 0]):
        course = replace(
            course,
            tension_n=np.nan_to_num(course.tension_n, nan=APART),
            pose=np.nan_to_num(course.pose, nan=APART),
        )
    measured = case.recorded(case.runs[number], course, noise=False)
    thin = max(1, int(case.sensing.poll_hz / COMPARED_HZ))
    tension = measured.tension_n[::thin] / case.sensing.tension_noise_n * np.sqrt(thin)
    root = np.linalg.cholesky(measured.covariance)
    pose = np.linalg.solve(root, measured.pose[:, :, None])
    return np.concatenate([tension.ravel(), pose.ravel()])


def longest_step_s(case: Case) -> float:
    """The longest step at which friction of this case, four times as strong, sticks quietly."""
    machine = Machine.from_rig(case.runs[0].rig)
    stiff = 0.0
    for one in case.concealed:
        if one.effect.size == "coulomb_n":
            stiff += STRONGEST * one.size / one.details["presliding_m"]
        elif one.effect.name == "pulley_capstan":
            stiff += STRONGEST * one.size * machine.pretension.max() / one.details["presliding_m"]
    stiff = max(stiff, STIFFEST_RIVAL_N_PER_M)
    _, quickest = machine.softest_and_stiffest_rad_per_s
    square = quickest**2 * stiff / machine.stiffness.min()
    for step_s in STEPS_S:
        if square * step_s * (step_s + 2.0 * BRISTLE_LOSS_S) < STABLE:
            return step_s
    return STEPS_S[-1]
