"""The next step on the way to the ring's phase: Gauss and Newton's, as far as differences hold."""

from collections.abc import Iterator, Sequence
from itertools import chain, islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.followed import FINE, Followed, straight_on
from analysis.engine.known import LOOSE, Known
from analysis.engine.ring_samples import Samples
from analysis.engine.solve import bounded

HALFWAY = 0.5
"""Of a step that brings less of what it promises, shorter ones are tried:"""

DAMPINGS = (10.0, 100.0, 1e3, 1e4, 1e6, 1e8)
"""as if everything were known so much better where it is (Levenberg 1944, Marquardt 1963)."""

ABREAST = 2
"""So many are simulated together, where the second may turn out not to be wanted."""

OUT, TIMES_BACK, BACK = (1.0, 0.5, 0.25), 4, 100.0
"""Shares of a step that leads out of a valley that turns, from where it is brought back, at most so
often, as if everything were known so much better there: what is known well stays, and the rest
moves no further."""

MORE, LONGER, LONGEST = 1.25, 2.0, 4.0
"""One that brings so much more than it promises is taken farther, up to that many times."""


class Step(NamedTuple):
    """Where a step leads, by which change, what is left there, and by how much the cost falls."""

    there: Followed
    change: Array
    residual: Array
    fell: float


class Stepper:
    """Looks for a step from where one is.

    Parameters
    ----------
    samples
        By which it is led.
    known
        What is known of free numbers.
    at, here
        Where one is, and what is left there of all samples, shape (n,).
    inside
        Samples that count, shape (n,).
    seen
        Share of the time that is simulated.
    """

    def __init__(
        self,
        samples: Samples,
        known: Known,
        at: Followed,
        here: Array,
        inside: NDArray[np.bool_],
        seen: float,
    ) -> None:
        self._samples = samples
        self._known = known
        self._at = at
        self._here = here[inside]
        self._inside = inside
        self._seen = seen
        self.before = float(self._here @ self._here) + known.cost(at.numbers)
        """Squared misfit here, and to what is known of numbers."""

    def step(self, columns: Array, steps: Array, least: float) -> tuple[float, Step] | None:
        """What a step promises, and what the best of its kind comes to; None: it promises little.

        Parameters
        ----------
        columns, steps
            What one unit of each number does to all samples, shape (k, n), and the differences by
            which that was told, shape (k,).
        least
            A step that promises a smaller fall of the cost is none.
        """
        at, columns = self._at, columns[:, self._inside]
        count = len(at.nuisance)
        # What a short window does not tell of a law stays about where it is (Levenberg 1944).
        known = self._known.information.copy()
        own = np.arange(count, len(known))
        known[own, own] += (LOOSE * FINE / steps[own]) ** 2
        matrix = columns @ columns.T + known
        right = columns @ self._here - self._known.information @ (at.numbers - self._known.at)
        lows, highs = np.full(len(right), -np.inf), np.full(len(right), np.inf)
        if at.state is not None:
            lows[count:], highs[count:] = at.state.bounds()
        target = bounded(matrix, right, lows, highs)
        promised = float(right @ target)
        if promised < least:
            return None
        damped = (matrix + damping * known for damping in DAMPINGS)
        shorter = (bounded(one, right, lows, highs) for one in damped)
        found = self._best(chain([target], shorter), HALFWAY * promised)
        if found.fell < HALFWAY * promised:
            stiff = matrix + BACK * known
            back = self._brought_back(target, columns, stiff, (lows, highs))
            found = next((one for one in back if one.fell > MORE * found.fell), found)
        # Along a valley that turns, differences promise too little: a step is too short.
        times = LONGER
        while times <= LONGEST and found.fell > MORE * promised:
            (farther,) = self._along([times * target])
            if farther.fell < found.fell:
                break
            found, times = farther, times * LONGER
        return promised, found

    def _best(self, changes: Iterator[Array], enough: float) -> Step:
        """The first step, where it brings enough; else the best of ever shorter ones."""
        best: Step | None = None
        # Differences may hold over less than that, and least along what tells least.
        while pair := list(islice(changes, ABREAST)):
            for one in self._along(pair):
                if best is not None and best.fell > max(one.fell, 0.0):
                    return best
                if best is None and one.fell >= enough:
                    return one
                best = one if best is None else max(best, one, key=lambda step: step.fell)
        assert best is not None
        return best

    def _brought_back(
        self, target: Array, columns: Array, stiff: Array, bounds: tuple[Array, Array]
    ) -> Iterator[Step]:
        """Along a valley that turns: out of it by a share of the step, and back.

        Back goes by the same differences, in directions that the samples tell well. That is what
        the second order along the step would do (Transtrum and Sethna 2011), again and again, for a
        simulation each.

        Parameters
        ----------
        target
            The step, shape (k,).
        columns
            What one unit of each number does to the samples that count, shape (k, n).
        stiff
            Their normal equations, as if everything were known better, shape (k, k).
        bounds
            Of the step, shapes (k,).
        """
        lows, highs = bounds
        for share in OUT:
            change = share * target
            (there,) = self._along([change])
            for _ in range(TIMES_BACK):
                off = self._known.information @ (there.there.numbers - self._known.at)
                right = columns @ there.residual[self._inside] - off
                change = change + bounded(stiff, right, lows - change, highs - change)
                (closer,) = self._along([change])
                if closer.fell <= there.fell:
                    break
                there = closer
            yield there

    def _along(self, changes: Sequence[Array]) -> list[Step]:
        """What steps come to."""
        found = []
        ends = [straight_on(self._samples.system, self._at, change) for change in changes]
        residuals = self._samples.residuals([one.point for one in ends], self._seen)
        for there, change, residual in zip(ends, changes, residuals, strict=True):
            left = residual[self._inside]
            now = float(left @ left) + self._known.cost(there.numbers)
            found.append(Step(there, change, residual, self.before - now))
        return found
