"""How well an experiment that was not done yet would tell rivals apart.

Each rival is simulated in it where the runs so far have it. Two rivals are apart by their
difference in units of everything that is uncertain: noise, the error of form of both laws
(`analysis.engine.evidence`), and parameters and the rivals' own numbers within what the runs so far
leave of them. The expected logarithm of the odds follows for Gaussians, and is tempered as the
verdict is. From that the information on which rival it is: the bound of Kolchinsky and Tracey,
Entropy 19 (2017) 361, with Bhattacharyya distances.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.menu import Experiment
from analysis.diagnosis.sharing import LANES_FROM
from analysis.engine.array import Array
from analysis.engine.fitted import Fitted
from analysis.engine.lens import Lens
from analysis.engine.sensitivity import nuisance_columns, simulate_features
from analysis.engine.state import State
from analysis.engine.system import Point
from analysis.engine.variance import base_variance, form_variance
from analysis.engine.weights import TEMPER

ONCE = ("frames_dropped",)
"""What happened in one recording and not in the next."""

FEW = LANES_FROM - 1
"""Points that are simulated one by one."""

LOOSE = 1e6
"""Prior variance of a magnitude, in its steps: what the runs do not hold is anywhere."""


@dataclass(frozen=True)
class Rival:
    """One explanation.

    Attributes
    ----------
    name
        What it is called.
    probability
        Against the others.
    fitted
        As the runs have it.
    """

    name: str
    probability: float
    fitted: Fitted


class Telling:
    """One experiment, and the rivals in it.

    Parameters
    ----------
    machine
        The runs there are.
    rotation
        Nuisances of the directions that the runs see, shape (nuisances, p).
    rivals
        What is to be told apart.
    experiment
        The experiment.
    workers
        Processes.
    """

    def __init__(
        self,
        machine: RecordedMachine,
        rotation: Array,
        rivals: Sequence[Rival],
        experiment: Experiment,
        workers: int,
    ) -> None:
        names = sorted({name for one in rivals for name in one.fitted.hypothesis.names})
        self.rivals = tuple(rivals)
        self._rotation = rotation
        # Without any effect named, the library's whole would be looked at.
        planned = [experiment.recording(machine.recordings[0])]
        new = RecordedMachine(planned, names or ["mass"], workers)
        self._new = new.with_peaks(machine.peaks_n)
        self._lens = Lens(list(self._new.bundles))
        places = {one.name: i for i, one in enumerate(machine.nuisances)}
        self._known = [places.get(one.name, -1) for one in self._new.nuisances]
        self._shares = {one.name: one.form_share for one in machine.candidates}
        self._features, self._variance = self._simulate()

    def _point(self, state: State, nuisance: Array) -> Point:
        here = np.array([nuisance[i] if i >= 0 else 0.0 for i in self._known])
        point = state.point(here)
        lasting = {name: one for name, one in point.effects.items() if name not in ONCE}
        return Point(here, lasting)

    def _simulate(self) -> tuple[Array, Array]:
        """Features of each rival and their variance, shapes (rivals, f)."""
        points, owners = [], []
        for i, one in enumerate(self.rivals):
            state, nuisance = one.fitted.state, one.fitted.point.nuisance
            points.append(self._point(state, nuisance))
            owners.append((i, ""))
            for name in state.hypothesis.names:
                points.append(self._point(state.without(name), nuisance))
                owners.append((i, name))
        found = self._seen(points)
        wholes = np.array([row for row, (_, name) in zip(found, owners, strict=True) if not name])
        variance = np.array([base_variance(self._lens, row, wholes[0]) for row in wholes])
        for row, (i, name) in zip(found, owners, strict=True):
            if name:
                does = wholes[i] - row
                variance[i] += form_variance(self._lens.labels, does, self._shares[name], 1.0)
        return wholes, variance

    def _seen(self, points: Sequence[Point]) -> Array:
        """Features of points, a few at a time: laws of unlike steps do not run side by side."""
        parts = [points[first : first + FEW] for first in range(0, len(points), FEW)]
        return np.vstack([simulate_features(self._new, self._lens, part) for part in parts])

    def at_most(self) -> Array:
        """Expected log odds if all numbers were known, shape (rivals, rivals)."""
        return self._log_odds([np.zeros((self._lens.size, 0))] * len(self.rivals))

    def log_odds(self) -> Array:
        """Expected log odds between the rivals, shape (rivals, rivals)."""
        nuisance = nuisance_columns(self._new, self._lens, np.zeros(len(self._known)))
        return self._log_odds([self._spread(one.fitted, nuisance) for one in self.rivals])

    def _spread(self, fitted: Fitted, nuisance: Array) -> Array:
        """What the numbers still move the features by: columns of unit variance, shape (f, k)."""
        own = self._own_columns(fitted)
        known = np.zeros((self._lens.size, len(self._rotation)))
        unknown = []
        for column, place in zip(nuisance.T, self._known, strict=True):
            if place >= 0:
                known[:, place] = column
            else:
                unknown.append(column)
        seen = known @ self._rotation
        root = _posterior_root(fitted)
        unseen = known - seen @ self._rotation.T
        return np.hstack(
            [np.hstack([seen, own]) @ root, unseen, *(one[:, None] for one in unknown)]
        )

    def _own_columns(self, fitted: Fitted) -> Array:
        """What a rival's own numbers do, in the order of its names, shape (f, k)."""
        state, count = fitted.state, len(fitted.state.free)
        if not count:
            return np.zeros((self._lens.size, 0))
        nuisance = fitted.point.nuisance
        moved = [state, *(state.bumped(k) for k in range(count))]
        points = [replace(self._point(one, nuisance), ring="damped") for one in moved]
        # One law's own numbers: these do run side by side.
        found = np.array(simulate_features(self._new, self._lens, points))
        steps = np.array([state.signed_step(k) for k in range(count)])
        columns = ((found[1:] - found[0]) / steps[:, None]).T
        return np.asarray(columns[:, _order(state)])

    def _log_odds(self, spreads: Sequence[Array]) -> Array:
        used = ~self._lens.labels.ringing
        found = np.zeros((len(self.rivals), len(self.rivals)))
        for i in range(len(self.rivals)):
            for k in range(i):
                root = np.sqrt(0.5 * (self._variance[i] + self._variance[k])[used])
                apart = (self._features[i] - self._features[k])[used] / root
                free = np.hstack([spreads[i], spreads[k]])[used] / root[:, None] / np.sqrt(2.0)
                along = free.T @ apart
                inner = np.eye(free.shape[1]) + free.T @ free
                square = float(apart @ apart - along @ np.linalg.solve(inner, along))
                found[i, k] = found[k, i] = 0.5 * max(square, 0.0) / TEMPER
        return found


def information_bits(log_odds: Array, weights: Array) -> float:
    """Expected information on which rival it is, bits; at most what is not known of it.

    Parameters
    ----------
    log_odds
        Expected, between any two, shape (r, r).
    weights
        Probabilities, shape (r,).
    """
    # Of Gaussians of one covariance the Bhattacharyya distance is a quarter of the divergence.
    likeness = np.exp(-log_odds / 4.0)
    return max(float(-weights @ np.log2(likeness @ weights)), 0.0)


def _order(state: State) -> list[int]:
    return [k for name in state.hypothesis.names for k in state.places(name)]


def _posterior_root(fitted: Fitted) -> Array:
    """A root of the covariance of directions and the rival's numbers, after the runs so far."""
    problem, state = fitted.problem, fitted.state
    names = state.hypothesis.names
    own = [fitted.columns[name] for name in names]
    columns = np.hstack([problem.nuisance, *own])[problem.used]
    columns = columns / np.sqrt(fitted.weighed.variance[problem.used])[:, None]
    directions = problem.nuisance.shape[1]
    order = _order(state)
    prior = np.ones(columns.shape[1])
    for place, k in enumerate(order):
        prior[directions + place] = 1.0 / (LOOSE * state.signed_step(k) ** 2)
    precision = columns.T @ columns + np.diag(prior)
    rows = state.shape_rows()[1][:, order]
    precision[directions:, directions:] += rows.T @ rows
    # Numbers of very unlike units: scaled, so that the inverse is sound.
    scale = 1.0 / np.sqrt(np.diag(precision))
    inverse = np.linalg.inv(precision * np.outer(scale, scale))
    root = np.linalg.cholesky(0.5 * (inverse + inverse.T) + 1e-12 * np.eye(len(inverse)))
    return np.asarray(scale[:, None] * root)
