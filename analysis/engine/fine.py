"""Differences as fine as what they move asks for, where everything is simulated anew.

A long difference has a bend in it, which looks like something that the recording tells, along
directions of which it tells nothing: parameters end sigmas off. One that is too short is lost in
what a solver is off by. So what moves the features by many times their noise is moved by less, and
parameters both ways, which leaves a bend of third order alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Setting
from analysis.engine.lens import Lens
from analysis.engine.sensitivity import simulate_features, sound
from analysis.engine.state import State
from analysis.engine.system import Point, System

FINEST = 0.02
"""Differences of nuisances where everything is simulated anew, in sigmas, at most."""

FINER = 0.025
"""And fine ones of what is on, as a share of their steps: the moment of an event is not told by
what one far from it does."""

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
        Features where no number is moved, and their noise, shapes (f,): infinity for one that does
        not count; for all, no difference is made shorter.
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


def own_columns(
    system: System,
    lens: Lens,
    state: State,
    nuisance: Array,
    here: Array,
    root: Array,
    *,
    fine: bool,
) -> tuple[Array, bool]:
    """What one unit of each free number does, shape (f, k), and whether all came to something.

    Parameters
    ----------
    system, lens
        What is simulated and how it is looked at.
    state, nuisance
        The numbers, and the nuisances in sigmas.
    here, root
        As for `columns_of`.
    fine
        By fine differences; else by whole steps.
    """
    stated = np.array([state.signed_step(k) for k in range(len(state.free))])

    def simulated(which: Sequence[int], by: Array) -> Array:
        shares = (step / stated[k] for k, step in zip(which, by, strict=True))
        moved = (state.bumped(k, one) for k, one in zip(which, shares, strict=True))
        points = [replace(one.point(nuisance), ring="damped") for one in moved]
        return simulate_features(system, lens, points)

    return columns_of(simulated, here, root, FINER * stated if fine else stated, stated, both=False)


def nuisances_beside(
    system: System, lens: Lens, about: Array, effects: Mapping[str, Setting], root: Array
) -> Array:
    """What one sigma of each nuisance does beside what is on, shape (f, nuisances).

    Parameters
    ----------
    system, lens
        What is simulated and how it is looked at.
    about, effects
        Nuisances about which, in sigmas, and what is on.
    root
        As for `columns_of`.
    """
    stated = np.array([one.step for one in system.nuisances])

    def simulated(which: Sequence[int], by: Array) -> Array:
        moved = by[:, None] * np.eye(len(about))[which]
        points = [Point(about + one, effects, ring="damped") for one in moved]
        return simulate_features(system, lens, points)

    (here,) = simulate_features(system, lens, [Point(about, effects, ring="damped")])
    return columns_of(simulated, here, root, np.minimum(stated, FINEST), stated, both=True)[0]
