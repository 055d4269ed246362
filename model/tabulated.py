"""The drive at every stage of every step, from a few times of it: between breaks it is smooth.

A drive changes over tenths of a second, and an integrator asks for it some ten thousand times a
second. Over a stretch of steps that meets no break it is taken at Chebyshev points and
interpolated. Where that does not return it at other times of the stretch, as where a cable goes
slack, it is computed at every stage.
"""

from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from model.drive import drive_table
from model.machine import Machine
from model.motion import Motion
from model.steps import SAME_POINT_S

Array = NDArray[np.float64]

STRETCH_S, FEWEST = 0.05, 8
"""Length of a stretch, and the fewest steps of one that is worth it."""

POINTS = 16
"""Times of it at which the drive is taken."""

CHECKED = (0.031, 0.37, 0.71)
"""And at which the interpolation is held against it, as shares of the stretch."""

SAME, ROUNDING = 1e-11, 1e-12
"""What it may be off there, as shares of the largest value of its kind, and of all."""


def drive_at_stages(
    machine: Machine, motion: Motion, point_s: Array, nodes: Array, kind: str
) -> Array:
    """The frozen drive at the stages of steps.

    Parameters
    ----------
    machine
        The nominal machine.
    motion
        X*.
    point_s
        Ends of the steps, shape (n + 1,), s.
    nodes
        Stages of a step, as shares of it, shape (stages,).
    kind
        "wrench" or "winch".

    Returns
    -------
    Array
        Shape (n, stages, 6) or (n, stages, 22), as `model.drive.drive_table` has it.
    """
    length = max(round(STRETCH_S / float(np.median(np.diff(point_s)))), FEWEST)
    firsts = _stretches(point_s, motion.breaks_s, length)
    left = np.ones(len(point_s) - 1, dtype=bool)
    if firsts.size:
        inside, places = _interpolation(tuple(nodes.tolist()), length)
        begin_s, end_s = point_s[firsts][:, None], point_s[firsts + length][:, None]
        at_s = begin_s + places * (end_s - begin_s)
        known = drive_table(machine, motion, at_s, 0.5 * (begin_s + end_s), kind)
        found = inside @ known[:, :POINTS]
        largest = np.abs(known).max(axis=(0, 1))
        allowed = SAME * largest + ROUNDING * largest.max()
        off = np.abs(found[:, -len(CHECKED) :] - known[:, POINTS:])
        smooth = (off <= allowed).all(axis=(1, 2))
        steps = firsts[smooth, None] + np.arange(length)
        left[steps] = False
        table = np.empty((left.size, nodes.size, known.shape[2]))
        stages = found[smooth, : -len(CHECKED)]
        table[steps] = stages.reshape(*steps.shape, nodes.size, known.shape[2])
    if left.any():
        start_s, step_s = point_s[:-1][left, None], np.diff(point_s)[left, None]
        rest = drive_table(machine, motion, start_s + nodes * step_s, start_s + 0.5 * step_s, kind)
        if left.all():
            return rest
        table[left] = rest
    return table


def _stretches(point_s: Array, breaks_s: tuple[float, ...], length: int) -> NDArray[np.int64]:
    """First steps of stretches: so many equal steps on end, and no break between them."""
    step_s = np.diff(point_s)
    other = np.flatnonzero(np.abs(step_s - np.median(step_s)) > SAME_POINT_S)
    met = np.searchsorted(point_s, np.array(breaks_s) - SAME_POINT_S)
    cuts = np.unique(np.concatenate([[0, step_s.size], other, other + 1, met]))
    firsts: list[int] = []
    for begin, end in pairwise(cuts[cuts <= step_s.size].tolist()):
        if end - begin >= length:
            # The last begins earlier, where they do not come out even.
            firsts += [*range(begin, end - length, length), end - length]
    return np.array(firsts, dtype=np.int64)


@lru_cache(maxsize=8)
def _interpolation(nodes: tuple[float, ...], length: int) -> tuple[Array, Array]:
    """What makes a stretch of its points, at its stages and where it is checked; all its times.

    Returns
    -------
    Array, Array
        Shapes (steps * stages + checks, POINTS) and (POINTS + checks,), shares of the stretch.
    """
    from scipy.interpolate import BarycentricInterpolator

    points = 0.5 - 0.5 * np.cos(np.pi * np.arange(POINTS) / (POINTS - 1))
    stages = (np.arange(length)[:, None] + np.array(nodes)).reshape(-1) / length
    wanted = np.append(stages, CHECKED)
    # Over fewer than all orders of the points weights depend on an order that is drawn.
    inside = BarycentricInterpolator(points, np.eye(POINTS), rng=0)(wanted)
    return np.ascontiguousarray(inside), np.append(points, CHECKED)
