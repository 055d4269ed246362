"""Parameters that may be known better than is stated: the recording tells by how much.

Of some parameters it is only known how far off they may be at most, such as the instants at which
eight amplifiers are read by clocks of their own. Where they are as free as that, they make up for
whatever looks like them: a cell that is a little late, a cable that damps a little. But if seven
of eight need not move at all, the eighth was hardly meant to. One share of what is stated is told
for all of them alike, by evidence: for parameters alone, and for each single cause beside them.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.evidence import Problem, directions
from analysis.engine.faint import Faint
from analysis.engine.faint_search import singles_of
from analysis.engine.restated import Restated
from analysis.engine.screen import Screen
from analysis.engine.system import Point, System

SHARES = (0.3, 0.1, 0.03, 0.01)
"""Of what is stated, that may be all that there is."""

SHARPER = (
    "{loose}: known better than is stated, as the recording tells. They may be off by {most:.2g} "
    "{unit}, but fit best where they are off by no more than {told:.2g} {unit}"
)


class Told(NamedTuple):
    """What a recording tells of how well parameters are known.

    Attributes
    ----------
    share
        Of their stated sigmas, at which a single cause, or none, is likeliest.
    cause
        The likeliest single cause.
    rises
        By how much that is likelier than parameters alone, as a logarithm, each at the share that
        suits it.
    """

    share: float
    cause: str
    rises: float


class Sharper(Restated):
    """A system whose loosely known parameters are known better.

    Parameters
    ----------
    stated
        As it is stated.
    told
        How well they are known.
    """

    def __init__(self, stated: System, told: Told) -> None:
        super().__init__(stated)
        self.told = told
        self.scales = scales_of(stated, told.share)
        """How much of its sigma is left of each parameter, shape (p,)."""
        self.nuisances = tuple(
            replace(one, sigma=scale * one.sigma)
            for one, scale in zip(stated.nuisances, self.scales, strict=True)
        )

    @property
    def note(self) -> str:
        """See `Restated`: which parameters, what was stated of the first, and what is told."""
        loose = [one for one in self.stated.nuisances if one.loose]
        first, more = loose[0], f" and {len(loose) - 1} more" if len(loose) > 1 else ""
        told = self.told.share * first.sigma
        return SHARPER.format(loose=first.name + more, most=first.sigma, told=told, unit=first.unit)

    def as_stated(self, point: Point) -> Point:
        """See `Restated`."""
        return replace(point, nuisance=self.scales * point.nuisance)

    def bend(self, here: Point, there: Point) -> Array:
        """See `Bent`."""
        return super().bend(here, there) / self.scales


def scales_of(system: System, share: float) -> Array:
    """The share for each parameter that is known loosely, 1 for the others, shape (p,)."""
    return np.array([share if one.loose else 1.0 for one in system.nuisances])


def how_sharp(system: System, found: Faint, candidates: Mapping[str, Candidate]) -> Told | None:
    """How well loosely known parameters are known; None: as stated, or there are none.

    Parameters
    ----------
    system
        What is simulated.
    found
        What could be there beside parameters that come to the noise alone.
    candidates
        By name: what may be a cause.
    """
    chosen = {name: one for name, one in candidates.items() if not one.fixed}
    if not chosen or not any(one.loose for one in system.nuisances):
        return None
    alone, best = [], []
    for share in (1.0, *SHARES):
        screen = Screen(_sharpened(found, scales_of(system, share)), chosen, found.terms)
        singles = singles_of(screen, chosen)
        if not singles:
            return None
        alone.append(screen.null().log_score)
        best.append(singles[0])
    scores = np.array([one.log_score for one in best])
    i = int(np.argmax(np.maximum(alone, scores)))
    if i == 0:
        return None
    (cause,) = best[i].hypothesis.names
    return Told((1.0, *SHARES)[i], cause, float(scores.max() - max(alone)))


def _sharpened(found: Faint, scales: Array) -> Problem:
    """The same problem, where parameters are known better."""
    problem = found.problem
    columns = (problem.nuisance @ found.rotation.T) * scales
    rotation = directions(columns, problem.base, problem.used)
    at = rotation.T @ (found.followed.nuisance / scales)
    return replace(problem, nuisance=columns @ rotation, at=at)
