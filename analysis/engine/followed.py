"""Where following the ring has led to, and the points about there."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.state import State
from analysis.engine.system import Point, System, bend_of

STEP, FINE = 5e-4, 0.025
"""Of the difference that tells what a parameter does, in sigmas, and of what is on, as a share of
its step. Longer ones turn the phase: at 40 times this, what differences are off by is larger than
what the weakest directions do, and steps along them lead nowhere."""

FAR_OFF, BENT = 3.0, 2.0
"""A parameter that is off by more sigmas than this makes up for nothing: it is off. Others do where
they are off by more than this, squared, on average."""


class Lent(NamedTuple):
    """What nuisances do to all samples about some hypothesis, and what is left there.

    Shapes (nuisances, n) and (n,).
    """

    columns: Array
    left: Array


@dataclass(frozen=True)
class Followed:
    """Where following the ring has led to.

    Attributes
    ----------
    nuisance
        In sigmas, shape (p,).
    state
        The free numbers of what is on; None: nothing is.
    share
        Of the time: the shortest over which more than `FAINT` of `ring_fit` is left, or 1.
    left
        Squared misfit of a sample over that time, on average.
    telling
        Of the time: what is left out is looked for up to there.
    about
        Where parameters had not yet begun to make up for what is left out; its `telling` is where
        they have: there is told best what that is. None: they never did, or nothing is left and
        they are near what is known of them.
    misfit
        Squared misfit of all samples.
    roughness
        Squared misfit of a sample as what no motion makes tells it, on average
        (`Samples.roughness`).
    effort
        Whole simulations that it took.
    costs
        Share of the time at the end of each window -> squared misfit up to there, with that of the
        parameters to their prior.
    lends
        What nuisances do to all samples about there; None: not known.
    fresh
        Whether that is of just there, or of what comes to the same.
    borrowed
        Whether that is still, but for corrections, what was lent by another hypothesis, of what
        does not come to the same.
    information
        What all samples tell of the free numbers about there, shape (numbers, numbers): the inverse
        of a covariance, without what was known of them before. None: not known.
    """

    nuisance: Array
    state: State | None
    share: float = 1.0
    left: float = np.inf
    telling: float = 1.0
    about: "Followed | None" = None
    misfit: float = np.inf
    roughness: float = 1.0
    effort: float = 0.0
    costs: Mapping[float, float] = field(default_factory=dict)
    lends: Lent | None = None
    fresh: bool = False
    borrowed: bool = False
    information: Array | None = None

    @property
    def point(self) -> Point:
        """What is to be simulated, ring and all."""
        if self.state is None:
            return Point(self.nuisance, ring="as_is")
        return replace(self.state.point(self.nuisance), ring="as_is")

    @property
    def reached(self) -> tuple[float, float]:
        """The share of the time it was led to, and its cost there: the farther, then the less."""
        share = max(self.costs, default=0.0)
        return share, self.costs.get(share, np.inf)

    @property
    def strain(self) -> float:
        """What parameters cost: how far they are from what is known of them, squared, in sigmas."""
        return float(self.nuisance @ self.nuisance)

    @property
    def is_bent(self) -> bool:
        """Whether parameters are more than a sigma off on average: they make up for something."""
        return self.strain > len(self.nuisance)

    @property
    def is_bent_throughout(self) -> bool:
        """Whether many parameters make up for something; few, far off, are causes of their own."""
        few_far = np.minimum(np.abs(self.nuisance), FAR_OFF)
        return float(few_far @ few_far) > BENT * len(self.nuisance)

    @property
    def to_end(self) -> bool:
        """Whether it was led over all of the time, whatever was left."""
        return self.reached[0] == 1.0

    @property
    def names(self) -> tuple[str, ...]:
        """Of the candidates that are on."""
        return () if self.state is None else self.state.hypothesis.names

    @property
    def numbers(self) -> Array:
        """Nuisances and the free numbers of the state, shape (numbers,)."""
        if self.state is None:
            return self.nuisance
        return np.concatenate([self.nuisance, self.state.values[list(self.state.free)]])

    def rises_without(self, name: str) -> float:
        """By how much the cost rises without a cause that is on, to first order; infinity: unknown.

        Parameters
        ----------
        name
            Of the candidate.
        """
        if self.information is None or self.state is None:
            return np.inf
        count, known = len(self.nuisance), self.known(self.information)
        numbers = [self.state.numbers[i] for i in self.state.free]
        own = [k for k in self.state.places(name) if numbers[k].shape is None]
        there = np.array([count + k for k in own], dtype=np.int64)
        covariance = np.linalg.pinv(known, hermitian=True)[np.ix_(there, there)]
        sizes = self.numbers[there]
        return float(sizes @ np.linalg.lstsq(covariance, sizes, rcond=None)[0])

    def known(self, told: Array) -> Array:
        """What is known of the free numbers, shape (numbers, numbers): an inverse covariance.

        Parameters
        ----------
        told
            What samples tell of them, of that shape; beside it, priors of nuisances and of shapes.
        """
        found, count = told.copy(), len(self.nuisance)
        found[range(count), range(count)] += 1.0
        if self.state is not None:
            _, rows = self.state.shape_rows()
            found[count:, count:] += rows.T @ rows
        return found

    def moved(self, change: Array, share: float) -> "Followed":
        """A share of a step further."""
        count = len(self.nuisance)
        state = self.state
        if state is not None:
            state = state.moved(change[count:], share)
        return Followed(self.nuisance + share * change[:count], state)

    def neighbours(self) -> tuple[list[Point], Array]:
        """A point for each free number, moved a little, and by how much, shape (numbers,)."""
        points, steps = [], []
        for i in range(len(self.nuisance)):
            nuisance = self.nuisance.copy()
            nuisance[i] += STEP
            points.append(replace(self, nuisance=nuisance).point)
            steps.append(STEP)
        if self.state is not None:
            for k in range(len(self.state.free)):
                points.append(replace(self, state=self.state.bumped(k, FINE)).point)
                steps.append(self.state.signed_step(k, FINE))
        return points, np.array(steps)


def straight_on(system: System, here: Followed, change: Array) -> Followed:
    """A step further, where what is simulated is as straight lines have it (`Bent`)."""
    there = here.moved(change, 1.0)
    return replace(there, nuisance=there.nuisance + bend_of(system, here.point, there.point))
