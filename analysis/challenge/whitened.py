"""The runs of a case as one vector in units of their noise, quickly made."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.case import Case
from analysis.challenge.plants import Course

Array = NDArray[np.float64]

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
    case: Case, step_s: float | None = None, courses: Sequence[Course] | None = None
) -> Array:
    """All runs of a case without noise, in units of it, shape (n,).

    Parameters
    ----------
    case
        What is done, and how it is measured.
    step_s
        Of the integration, s; default: the plant's longest.
    courses
        What the machine does in each run, where it is known.
    """
    if courses is None:
        taken_s = case.plant.steps_s[0] if step_s is None else step_s
        courses = [case.happened(run, taken_s) for run in case.runs]
    return np.concatenate([_run(case, number, course) for number, course in enumerate(courses)])


def _run(case: Case, number: int, course: Course) -> Array:
    if np.isnan(course.pose[-1, 0]):
        broken: Any = course
        course = replace(
            broken,
            tension_n=np.nan_to_num(course.tension_n, nan=APART),
            pose=np.nan_to_num(course.pose, nan=APART),
        )
    measured = case.recorded(case.runs[number], course, noise=False)
    thin = max(1, int(case.sensing.poll_hz / COMPARED_HZ))
    tension = measured.tension_n[::thin] / case.sensing.tension_noise_n * np.sqrt(thin)
    root = np.linalg.cholesky(measured.covariance)
    pose = np.linalg.solve(root, measured.pose[:, :, None])
    return np.concatenate([tension.ravel(), pose.ravel()])
