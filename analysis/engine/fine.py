"""Differences as fine as what they move asks for, where everything is simulated anew.

A long difference has a bend in it, which looks like something that the recording tells, along
directions of which it tells nothing: parameters end sigmas off. One that is too short is lost in
what a solver is off by. So what moves the features by many times their noise is moved by less, and
parameters both ways, which leaves a bend of third order alone.
"""

from collections.abc import Callable, Sequence

import numpy as np

from analysis.engine.sensitivity import sound
from analysis.engine.system import Array

ONE_WAY, BOTH_WAYS = 15.0, 300.0
"""What moves all features together by more than the first, in units of noise, is moved by no more
than that, or both ways and by no more than the second."""

Simulated = Callable[[Sequence[int], Array], Array]
"""Features where each of some numbers is moved by so much, shape (numbers, f)."""


def columns_of(
    simulated: Simulated, here: Array, root: Array, steps: Array, stated: Array, *, both: bool
) -> tuple[Array, bool]:
    """What one unit of each number does, shape (f, k), and whether all simulations came out.

    Parameters
    ----------
    simulated
        See there.
    here, root
        Features where no number is moved, and their noise, shapes (f,).
    steps
        Differences at most, shape (k,).
    stated
        Those of numbers that so little of does not move, shape (k,).
    both
        Numbers may be moved both ways.
    """
    every = range(len(steps))
    if not every:
        return np.zeros((len(here), 0)), True
    steps = steps.copy()
    rows = simulated(every, steps)
    still = [k for k in every if steps[k] != stated[k] and np.array_equal(rows[k], here)]
    if still:
        steps[still] = stated[still]
        rows[still] = simulated(still, steps[still])
    whole = bool(sound(rows).all())
    changes = np.where(sound(rows), rows, here) - here
    far = np.linalg.norm(changes / root, axis=1)
    coarse = [k for k in every if far[k] > ONE_WAY]
    if coarse and both:
        less = steps[coarse] * np.minimum(BOTH_WAYS / far[coarse], 1.0)
        up, down = simulated(coarse, less), simulated(coarse, -less)
        changes[coarse], steps[coarse] = up - down, 2.0 * less
    elif coarse:
        less = steps[coarse] * ONE_WAY / far[coarse]
        changes[coarse], steps[coarse] = simulated(coarse, less) - here, less
    whole = whole and bool(sound(changes).all())
    return np.asarray((np.where(sound(changes), changes, 0.0) / steps[:, None]).T), whole
