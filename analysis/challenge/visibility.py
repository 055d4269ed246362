"""How well an effect shows in its runs, and which others could be told from it.

Everything is measured in the noise of the runs: a change of 1 is one standard deviation in the
direction of the change. Numbers of the machine are free within their sigmas: what they can absorb
does not count. All by the plant itself, in straight lines about the true machine.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.case import Case
from analysis.challenge.plants import Concealed, Effect
from analysis.challenge.whitened import Reference, whitened

Array = NDArray[np.float64]

SMALL = 5e-3
"""Difference taken of a machine's number, in its sigmas."""

SEEN = 6.0
"""A change that stands out by less is too weak to see."""

SEEN_PARAMETER = 3.0
"""A number of the machine cannot stand out by more than the sigmas it is off by."""

SENSED = ("cell", "camera", "clock")
"""Sides whose effects leave what happens as it is."""

SLOPE = 1e-3
"""Share of its size at which an effect in proportion shows its slope."""

TOLD_APART = 12.0
"""Twice the logarithm of the likelihood ratio from which two effects can be told apart."""


@dataclass(frozen=True)
class Metric:
    """Length of a change of the data, less what the machine's numbers can absorb.

    Parameters
    ----------
    known
        The data with nothing concealed.
    absorbing
        Change of the data for one sigma of each number, then of what sound machines have of an
        effect, shape (n, numbers + effects).
    numbers
        Name of each number and its one sigma.
    """

    known: Reference
    absorbing: Array
    numbers: tuple[tuple[str, Array | float], ...]

    @classmethod
    def of(cls, case: Case, step_s: float | None = None) -> "Metric":
        """That of a case's machine and runs; what it conceals is left out.

        Parameters
        ----------
        case
            Its machine and runs.
        step_s
            Of the integration, s; default: the longest at which its friction sticks quietly.
        """
        bare = case.with_concealed()
        longest_s = case.plant.longest_step_s(case.runs[0].rig, case.concealed)
        known = Reference.of(bare, step_s or longest_s)
        columns = []
        numbers = tuple(_steps(case))
        for name, step in numbers:
            moved = replace(bare, offset=bare.offset.with_added(**{name: SMALL * step}))
            columns.append((whitened(moved, known.step_s) - known.data) / SMALL)
        for name, effect in case.plant.catalogue().items():
            if effect.sound > 0.0:
                small = case.plant.concealed(name, SMALL * effect.sound, (), {})
                shown = bare.with_concealed(small)
                columns.append((whitened(shown, known.step_s) - known.data) / SMALL)
        return cls(known, np.stack(columns, axis=1), numbers)

    def sigmas(self, offset: Mapping[str, Array | float]) -> Array | None:
        """How many sigmas of each column an offset is; None where it moves another number."""
        if not {name for name, _ in self.numbers} >= set(offset):
            return None
        found = np.zeros(self.absorbing.shape[1])
        for j, (name, step) in enumerate(self.numbers):
            found[j] = np.sum(np.multiply(offset.get(name, 0.0), step)) / np.sum(np.square(step))
        return found

    def inner(self, one: Array, other: Array) -> float:
        """The product one^T (1 + J J^T)^-1 other."""
        left, right = self.absorbing.T @ one, self.absorbing.T @ other
        size = self.absorbing.shape[1]
        inner = np.eye(size) + self.absorbing.T @ self.absorbing
        return float(one @ other - left @ np.linalg.solve(inner, right))

    def length(self, change: Array) -> float:
        """How far a change stands out."""
        return float(np.sqrt(max(self.inner(change, change), 0.0)))


def _steps(case: Case) -> list[tuple[str, Array | float]]:
    """One sigma of each of the machine's numbers that a run can feel."""
    rig = case.runs[0].rig
    each = np.eye(8)
    stiffness = [c.stiffness_n_per_m.sigma / c.stiffness_n_per_m.value for c in rig.cable]
    pretension = [c.pretension_n.sigma for c in rig.cable]
    platform = rig.platform
    steps: list[tuple[str, Array | float]] = []
    steps += [("stiffness_share", stiffness[i] * each[i]) for i in range(8)]
    steps += [("pretension_n", pretension[i] * each[i]) for i in range(8)]
    steps.append(("mass_share", platform.mass_kg.sigma / platform.mass_kg.value))
    for name, row in (
        ("inertia_kg_m2", platform.inertia_kg_m2.sigma),
        ("centre_m", platform.centre_of_mass_m.sigma),
    ):
        steps += [(name, row * np.eye(3)[j]) for j in range(3)]
    for i, cable in enumerate(rig.cable):
        for name, sigma in (("base_m", cable.base_m.sigma), ("anchor_m", cable.anchor_m.sigma)):
            steps += [(name, sigma * np.outer(each[i], np.eye(3)[j])) for j in range(3)]
    return steps


@dataclass(frozen=True)
class Seen:
    """How one concealed effect shows.

    Parameters
    ----------
    rms
        Change of the data where it is switched off, in noise, root mean square of all samples.
    whole
        Length of that change.
    stands_out
        The same, less what the machine's numbers absorb.
    rivals
        Of other effects: how far the best of their sizes stays away from it.
    threshold
        By how much it has to stand out to be seen.
    """

    rms: float
    whole: float
    stands_out: float
    rivals: dict[str, float] | None
    threshold: float = SEEN

    @property
    def visible(self) -> bool:
        """Whether it could be seen at all."""
        return self.stands_out >= self.threshold

    @property
    def separable(self) -> bool | None:
        """Whether every rival could be told from it; None where none was tried."""
        if self.rivals is None:
            return None
        return self.visible and min(self.rivals.values(), default=np.inf) ** 2 >= TOLD_APART


def look(case: Case, metric: Metric, *, rivals: bool) -> list[Seen]:
    """How each effect of a case shows, the others staying.

    Parameters
    ----------
    case
        As it will be made.
    metric
        Of its machine and runs.
    rivals
        Whether to try other effects.
    """
    if not case.concealed:
        return []
    step_s = metric.known.step_s
    all_on = whitened(case, step_s)
    tried = _rivals(case, metric) if rivals else None
    seen = []
    for number, one in enumerate(case.concealed):
        rest = [other for j, other in enumerate(case.concealed) if j != number]
        change = all_on - (
            whitened(case.with_concealed(*rest), step_s) if rest else metric.known.data
        )
        slope = slope_of(case, one, metric)
        away = None
        if tried is not None:
            others = ((name, rival) for name, rival in tried.items() if name != one.effect.name)
            away = {name: _apart(metric, slope, rival) for name, rival in others}
        seen.append(
            Seen(
                rms=float(np.sqrt(np.mean(change**2))),
                whole=float(np.linalg.norm(change)),
                stands_out=shows(case, one, metric),
                rivals=away,
                threshold=seen_from(one.effect),
            )
        )
    return seen


def seen_from(effect: Effect) -> float:
    """By how much an effect has to stand out to be seen."""
    return SEEN_PARAMETER if effect.side == "parameter" else SEEN


def slope_of(case: Case, own: Concealed, metric: Metric) -> Array:
    """Change of the data by an effect alone, by its slope where it acts in proportion."""
    known = metric.known
    if own.effect.side == "parameter":
        sigmas = metric.sigmas(case.plant.numbers(own, case.runs[0].rig))
        if sigmas is not None:
            return np.asarray(metric.absorbing @ sigmas)
    share = SLOPE if own.effect.straight else 1.0
    courses = known.courses if own.effect.side in SENSED else None
    shown = case.with_concealed(own.resized(share * own.size))
    return np.asarray((whitened(shown, known.step_s, courses) - known.data) / share)


def shows(case: Case, own: Concealed, metric: Metric) -> float:
    """How far one effect alone stands out."""
    found = metric.length(slope_of(case, own, metric))
    if own.effect.straight and own.effect.side != "parameter":
        # Out of phase is out of phase: a straight line would go on.
        whole = whitened(case.with_concealed(own), metric.known.step_s) - metric.known.data
        found = min(found, metric.length(whole))
    return found


def _rivals(case: Case, metric: Metric) -> dict[str, Array]:
    """Change of the data by every effect at its usual size, on the same cables."""
    cables = max((one.cables for one in case.concealed), key=len, default=())
    generator = np.random.default_rng(0)
    found = {}
    for name in case.plant.catalogue():
        rival = case.plant.rival(name, cables or tuple(range(1, 9)), case.runs[0].rig, generator)
        found[name] = slope_of(case, rival, metric)
    return found


def _apart(metric: Metric, change: Array, rival: Array) -> float:
    """What is left of a change where a rival of the best size is taken off."""
    own = metric.inner(rival, rival)
    left = metric.inner(change, change)
    if own > 0.0:
        left -= metric.inner(change, rival) ** 2 / own
    return float(np.sqrt(max(left, 0.0)))
