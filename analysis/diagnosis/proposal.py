"""A law proposed for a missing force: sparse regression, by what holds on cycles that it never saw.

Terms enter one by one, each the one that explains most beside those before it (orthogonal matching
pursuit), in units of noise and of all that is known with a sigma only. How many enter is decided
block by block: fitted to the others, they must foretell it. Resampled blocks say how firm the
choice is, and what does as well in a term's place is told with it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from analysis.diagnosis.missing_force import Missing
from analysis.diagnosis.state_terms import TERMS

Array = NDArray[np.float64]

MOST_TERMS = 3

FIRM, FURTHER = 6.0, 4.0
"""Sigmas by which the first term must stand out, and any other. Rings that a slow camera folds onto
the drive's harmonics are in no sigma, and make 5 in clean runs."""

WORTH = 0.05
"""Of the squared mismatch of held-out blocks, that a further term must take off."""

NEAR = 0.05
"""Of it, by which what stands in a term's place may do worse and be told beside it."""

LEAST_SHARE = 0.5
"""Of what is missing on held-out blocks, that a proposal must explain; and of the resamples, those
that a term must be chosen in."""

RESAMPLES = 100

MOST_FOLDS = 10

UNTOLD = 9.0
"""Terms whose gains are within three sigmas are not told apart: the first of the list enters."""

SAME = 1e-6
"""A column of whose square less is left beside those chosen is one of them."""


@dataclass(frozen=True)
class Chosen:
    """One term of a proposal.

    Attributes
    ----------
    term
        Place in `TERMS`.
    value, sigma
        Of its coefficient, in the term's unit.
    share
        Of the resamples, those that chose it.
    alternatives
        Places in `TERMS`, and value and sigma there, of what does as well in its place.
    """

    term: int
    value: float
    sigma: float
    share: float
    alternatives: tuple[tuple[int, float, float], ...]


@dataclass(frozen=True)
class Proposal:
    """The law proposed for one cable.

    Attributes
    ----------
    cable
        1 to 8.
    terms
        What it is made of, in the order in which they entered.
    explains
        Share of the squared mismatch of blocks that were not used, beyond what noise makes of it.
    blocks
        That there were.
    """

    cable: int
    terms: tuple[Chosen, ...]
    explains: float
    blocks: int


def propose(
    missing: Missing,
    generator: np.random.Generator,
    *,
    everywhere: bool = False,
    resamples: int = RESAMPLES,
) -> Proposal | None:
    """Propose a law for a cable's missing force; None: nothing beats the noise.

    Parameters
    ----------
    missing
        The force.
    generator
        Source of the resamples.
    everywhere
        Whether all cables are off, so that the platform's own state may stand in.
    resamples
        How many.
    """
    evidence = _Evidence(missing)
    own = [k for k, one in enumerate(TERMS) if not one.common]
    path, gains = evidence.whole.path(own, MOST_TERMS)
    left = [evidence.held_out(path[:count]) for count in range(len(path) + 1)]
    excess = max(left[0] - len(missing.force), 1.0)
    rivals = range(len(TERMS)) if everywhere else own
    for count in range(_how_many(gains, left), 0, -1):
        explains = min((left[0] - left[count]) / excess, 1.0)
        drawn = [evidence.resampled(generator).path(own, count)[0] for _ in range(resamples)]
        terms = evidence.chosen(path[:count], rivals, drawn, left[count] + NEAR * left[0])
        if terms and explains >= LEAST_SHARE:
            return Proposal(missing.cable, terms, explains, len(np.unique(missing.block)))
    return None


def _how_many(gains: Sequence[float], left: Sequence[float]) -> int:
    """Terms that stand out and hold on blocks they were not fitted to."""
    for i, gain in enumerate(gains):
        firm = gain > (FURTHER if i else FIRM) ** 2
        if not firm or left[i] - left[i + 1] < WORTH * left[0]:
            return i
    return len(gains)


@dataclass(frozen=True)
class _White:
    """Rows of unit variance: levels, terms and force."""

    level: Array
    terms: Array
    force: Array

    @classmethod
    def of(cls, missing: Missing, rows: NDArray[np.int64]) -> "_White":
        """Some rows, less noise and what is known with a sigma only."""
        known = missing.known[rows]
        root = cholesky(np.diag(missing.variance[rows]) + known @ known.T, lower=True)
        both = np.column_stack([missing.level[rows], missing.terms[rows], missing.force[rows]])
        white = solve_triangular(root, both, lower=True)
        runs = missing.level.shape[1]
        return cls(white[:, :runs], white[:, runs:-1], white[:, -1])

    def path(self, allowed: Sequence[int], most: int) -> tuple[list[int], list[float]]:
        """Terms in the order they enter, and by how much each lowers the square."""
        columns, left = self.terms.copy(), self.force.copy()
        for level in self.level.T:
            _project(columns, left, level)
        whole = (self.terms**2).sum(axis=0)
        found: list[int] = []
        gains: list[float] = []
        while len(found) < most:
            square = (columns**2).sum(axis=0)
            free = np.isin(np.arange(len(whole)), allowed) & (square > SAME * whole)
            if not free.any():
                break
            gain = np.where(free, (columns.T @ left) ** 2 / np.where(free, square, 1.0), -1.0)
            best = int(np.argmax(gain >= gain.max() - UNTOLD))
            found.append(best)
            gains.append(float(gain[best]))
            _project(columns, left, columns[:, best].copy())
        return found, gains

    def fit(self, chosen: Sequence[int]) -> Array:
        """Levels and coefficients."""
        design = np.hstack([self.level, self.terms[:, chosen]])
        scale = np.sqrt((design**2).sum(axis=0))
        scale[scale == 0.0] = 1.0
        return np.asarray(np.linalg.lstsq(design / scale, self.force, rcond=None)[0] / scale)

    def coefficients(self, chosen: Sequence[int]) -> tuple[list[float], list[float]]:
        """Values and standard errors; a fit worse than noise makes these larger."""
        design = np.hstack([self.level, self.terms[:, chosen]])
        scale = np.sqrt((design**2).sum(axis=0))
        found = self.fit(chosen)
        rest = self.force - design @ found
        worse = max(float(rest @ rest) / max(len(rest) - design.shape[1], 1), 1.0)
        scaled = design / scale
        spread = np.sqrt(worse * np.diag(np.linalg.pinv(scaled.T @ scaled))) / scale
        runs = self.level.shape[1]
        return found[runs:].tolist(), spread[runs:].tolist()


class _Evidence:
    """A cable's missing force, whole and in folds."""

    def __init__(self, missing: Missing) -> None:
        self._missing = missing
        self._blocks = np.unique(missing.block)
        self.whole = _White.of(missing, np.arange(len(missing.force)))

    @cached_property
    def _folds(self) -> list[tuple[_White, _White]]:
        """What is fitted and what is foretold."""
        found = []
        for out in np.array_split(self._blocks, min(len(self._blocks), MOST_FOLDS)):
            held = np.isin(self._missing.block, out)
            both = (_White.of(self._missing, np.flatnonzero(one)) for one in (~held, held))
            found.append((next(both), next(both)))
        return found

    def held_out(self, chosen: Sequence[int]) -> float:
        """Squared mismatch of all blocks, each foretold by terms fitted to others."""
        total = 0.0
        for used, held in self._folds:
            rest = held.force - np.hstack([held.level, held.terms[:, chosen]]) @ used.fit(chosen)
            total += float(rest @ rest)
        return total

    def resampled(self, generator: np.random.Generator) -> _White:
        """Blocks drawn with replacement."""
        drawn = generator.choice(self._blocks, len(self._blocks))
        rows = np.concatenate([np.flatnonzero(self._missing.block == one) for one in drawn])
        return _White.of(self._missing, rows)

    def chosen(
        self,
        chosen: Sequence[int],
        rivals: Sequence[int],
        drawn: Sequence[Sequence[int]],
        most: float,
    ) -> tuple[Chosen, ...]:
        """The terms with their rivals; empty: one of them is another in most resamples."""
        value, sigma = self.whole.coefficients(chosen)
        found = []
        for i, k in enumerate(chosen):
            others = self._instead(chosen, i, rivals, most)
            alike = {k, *(rival for rival, _, _ in others)}
            if sum(not alike.isdisjoint(one) for one in drawn) < LEAST_SHARE * len(drawn):
                return ()
            share = sum(k in one for one in drawn) / max(len(drawn), 1)
            found.append(Chosen(k, value[i], sigma[i], share, others))
        return tuple(found)

    def _instead(
        self, chosen: Sequence[int], place: int, rivals: Sequence[int], most: float
    ) -> tuple[tuple[int, float, float], ...]:
        """What leaves no more than `most` in the place of one chosen term."""
        found = []
        for rival in rivals:
            if rival in chosen:
                continue
            other = [rival if i == place else k for i, k in enumerate(chosen)]
            if (left := self.held_out(other)) <= most:
                value, sigma = self.whole.coefficients(other)
                found.append((left, rival, value[place], sigma[place]))
        return tuple(one[1:] for one in sorted(found))


def _project(columns: Array, left: Array, along: Array) -> None:
    """Take what lies along a column off others, in place."""
    square = float(along @ along)
    if square > 0.0:
        unit = along / np.sqrt(square)
        columns -= np.outer(unit, unit @ columns)
        left -= unit * (unit @ left)
