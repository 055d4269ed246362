"""`observe`: what cells and camera would report of a simulation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from model.compiled import compiled
from model.library.effect import Acts
from model.library.selection import ActiveEffect, those_that_act
from model.simulation import Simulation

Array = NDArray[np.float64]
Look = Callable[[Array], Array]

LEAST_ROWS = 2
"""Fewer rows have nothing between them."""


@dataclass(frozen=True)
class Observation:
    """Tensions and poses as recorded; N, m and rad.

    Parameters
    ----------
    tension_t_s
        Times of the tensions, shape (n,), or (n, 8) where the bus is polled in turn.
    tension_n
        Shape (n, 8).
    pose_t_s
        Stamps of the frames, shape (m,).
    pose
        Shape (m, 6).
    """

    tension_t_s: Array
    tension_n: Array
    pose_t_s: Array
    pose: Array


def observe(
    simulation: Simulation,
    effects: Sequence[ActiveEffect] | None = None,
    *,
    tension_t_s: Array | None = None,
    pose_t_s: Array | None = None,
) -> Observation:
    """What cells and camera would report.

    Parameters
    ----------
    simulation
        What happened.
    effects
        Those of cells, camera and clocks act here, in the order from the physical quantity to the
        record; others are passed over. Default: those the simulation was given.
    tension_t_s
        When the cells are read, shape (n,), or (n, 8) each at its own times; default: at each row
        of the simulation.
    pose_t_s
        Stamps of the frames, shape (m,); default: at each row of the simulation.

    Returns
    -------
    Observation
        Without noise. Before and after the simulation, its ends.
    """
    chosen = those_that_act(simulation.effects if effects is None else effects)
    chain = sorted(chosen, key=lambda one: one.effect.order)
    tension = simulation.tension_n
    for one in chain:
        if one.effect.acts is Acts.CELL and one.effect.measure is not None:
            tension = one.effect.measure(simulation.t_s, tension, **one.columns())
    look = _camera(simulation)
    for one in those_that_act(simulation.effects):
        # What moves a frame on the platform moves the point that the camera sees.
        if one.effect.acts is Acts.PARAMETER and one.effect.measure is not None:
            look = one.effect.measure(look, **one.numbers())
    for one in chain:
        if one.effect.acts in (Acts.CAMERA, Acts.CLOCK) and one.effect.measure is not None:
            look = one.effect.measure(look, **one.numbers())
    read_s = simulation.t_s if tension_t_s is None else np.asarray(tension_t_s, dtype=float)
    stamp_s = simulation.t_s if pose_t_s is None else np.asarray(pose_t_s, dtype=float)
    return Observation(read_s, _read(simulation.t_s, tension, read_s), stamp_s, look(stamp_s))


def _camera(simulation: Simulation) -> Look:
    """The pose at any time, by cubics through the rows with their rates; at a row, the row."""
    time_s, pose, rate = simulation.t_s, simulation.pose, simulation.pose_rate
    if len(time_s) < LEAST_ROWS:
        return lambda stamp_s: np.repeat(pose[:1], len(stamp_s), axis=0)

    def look(stamp_s: Array) -> Array:
        at_s = np.clip(stamp_s, time_s[0], time_s[-1])
        row = np.clip(np.searchsorted(time_s, at_s, side="right") - 1, 0, len(time_s) - 2)
        step = (time_s[row + 1] - time_s[row])[:, None]
        part = (at_s - time_s[row])[:, None] / step
        left = 1.0 - part
        seen: Array = left**2 * (
            (1.0 + 2.0 * part) * pose[row] + part * step * rate[row]
        ) + part**2 * ((1.0 + 2.0 * left) * pose[row + 1] - left * step * rate[row + 1])
        return seen

    return look


def _read(time_s: Array, tension: Array, read_s: Array) -> Array:
    """Cubics through the four rows about each time; before and after the rows, their ends.

    A straight line misses the crest of a tone of 27 Hz by 1.5 % at 500 rows a second, which is seen
    in a recording. Tensions may jump: four rows, unlike a spline, let no jump ring on.
    """
    every = read_s[:, None] if read_s.ndim == 1 else read_s
    at_s = np.ascontiguousarray(np.broadcast_to(every, (len(read_s), 8)))
    if len(time_s) < LEAST_ROWS:
        return np.repeat(tension[:1], len(at_s), axis=0)
    seen = np.empty((len(at_s), tension.shape[1]))
    compiled("between_rows")(time_s, np.ascontiguousarray(tension), at_s, seen)
    return seen
