"""How large a concealed effect is: near the limit of what can be seen, usual, or strong."""

import numpy as np

from analysis.challenge.case import Case
from analysis.challenge.plants import Concealed
from analysis.challenge.visibility import Metric, shows
from cdpr8.errors import DataError

LIMIT = (10.0, 30.0)
"""By how much an effect near the limit is to stand out."""

STRONG = (2.5, 4.0)
"""Of the usual size."""

WEAKEST = 1.0 / 30.0
"""Of the usual size; weaker, an effect is below what any model of such a machine is good for."""

FARTHEST_RAD = 0.6
"""A platform that turns farther has broken loose: no laboratory would keep the run."""

ROUNDS = 4
CLOSE = 1.3

HALVINGS = 12
"""An effect is made smaller so often at most."""


def of_strength(
    case: Case,
    concealed: Concealed,
    strength: str,
    metric: Metric,
    generator: np.random.Generator,
) -> Concealed:
    """The effect at the size that a strength asks for.

    Parameters
    ----------
    case
        Its machine and runs.
    concealed
        At its usual size.
    strength
        "limit", "typical" or "strong".
    metric
        Of the machine and runs.
    generator
        Source of the draw.
    """
    effect = concealed.effect
    sign = -1.0 if concealed.size < 0.0 else 1.0
    if strength == "typical":
        return concealed
    if strength == "strong":
        size = abs(concealed.size) * float(generator.uniform(*STRONG))
        return concealed.resized(sign * min(size, effect.most))
    goal = float(np.exp(generator.uniform(*np.log(LIMIT))))
    size = abs(concealed.size)
    least = max(effect.least, WEAKEST * effect.typical)
    for _ in range(ROUNDS):
        found = shows(case, concealed.resized(sign * size), metric)
        if goal / CLOSE < found < goal * CLOSE:
            break
        ratio = goal / max(found, 1e-3)
        # Towards zero an effect may die off as its square or stay as its root.
        size *= float(np.clip(ratio, 1e-3, 30.0))
        size = min(max(size, least), effect.most)
        if size in (least, effect.most) and ratio != 1.0:
            break
    return concealed.resized(sign * size)


def tamed(case: Case) -> Case:
    """The same case, its effects made smaller until the machine holds together.

    Raises
    ------
    DataError
        It does not, however small they are: what comes apart is the integration.
    """
    steps_s = (case.plant.longest_step_s(run.rig, case.concealed) for run in case.runs)
    step_s = min(case.plant.look_step_s, *steps_s)
    for _ in range(HALVINGS):
        if not case.concealed or holds(case, step_s):
            return case
        case = case.with_concealed(*(one.resized(0.5 * one.size) for one in case.concealed))
    raise DataError(
        f"the machine does not hold together with {' and '.join(_names(case))}, "
        f"made {2**HALVINGS} times smaller, in steps of {1e6 * step_s:g} us",
        where=case.name,
        remedy="give that plant shorter steps",
    )


def _names(case: Case) -> list[str]:
    return [one.effect.name for one in case.concealed]


def holds(case: Case, step_s: float) -> bool:
    """Whether the machine holds together in every run, integrated by this step.

    Parameters
    ----------
    case
        With what it conceals.
    step_s
        Of the integration, s.
    """
    courses = (case.happened(run, step_s) for run in case.runs)
    return all(
        np.isfinite(course.tension_n).all()
        and np.isfinite(course.pose).all()
        and np.abs(course.pose[:, 3:]).max() < FARTHEST_RAD
        for course in courses
    )
