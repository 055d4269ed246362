"""Who simulates what: points in shares for processes, as many side by side as pays.

Sixteen simulations side by side take as long as some few one by one. What is asked of several runs
is better left whole, a run for each process; what is asked of one is better divided among them.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.engine.system import Point
from model.library.discovery import library
from model.library.effect import Acts
from model.library.lanes import LANES

LANES_FROM = 8
"""Fewer simulations than this are faster one by one,"""

OF_PULLEYS_FROM = 4
"""and fewer than this where laws of pulleys are on: of roots vectors take several in the time of
one."""

LOOKING = 0.3
"""What it takes to look at a simulation once more, of what it takes to simulate."""


@dataclass(frozen=True)
class Share:
    """Some points of one run: place of the point -> what to simulate."""

    record: int
    points: Mapping[int, Point]


@dataclass(frozen=True)
class Alike:
    """Points of one run that are simulated as one, and only looked at differently.

    Attributes
    ----------
    points
        Place of the point -> point.
    simulations
        How many it takes.
    """

    points: Mapping[int, Point]
    simulations: int

    @property
    def takes(self) -> float:
        """How long, by itself, in simulations."""
        return self.simulations + LOOKING * (len(self.points) - 1)

    @property
    def effects(self) -> Iterable[str]:
        """Names of what is on."""
        return next(iter(self.points.values())).effects


def lanes_from(effects: Iterable[str]) -> int:
    """Fewer simulations than this are faster one by one.

    Parameters
    ----------
    effects
        Names of what is on in any of them.
    """
    of_pulleys = any(library()[name].acts is Acts.PULLEY for name in effects)
    return OF_PULLEYS_FROM if of_pulleys else LANES_FROM


def shares(asked: Sequence[Sequence[Alike]], processes: int) -> list[Share]:
    """Shares in the order in which processes take them by turns.

    Parameters
    ----------
    asked
        What is asked of each run, like beside like.
    processes
        So many.
    """
    plans = []
    for divided in sorted({1, processes}):
        parts = [
            (record, part)
            for record, every in enumerate(asked)
            for part in _divided(every, divided)
        ]
        parts.sort(key=lambda one: -_takes(one[1]))
        longest = max(
            (sum(_takes(part) for _, part in parts[i::processes]) for i in range(processes)),
            default=0.0,
        )
        plans.append((longest, parts))
    _, best = min(plans, key=lambda one: one[0])
    return [
        Share(record, {place: one for alike in part for place, one in alike.points.items()})
        for record, part in best
    ]


def _divided(every: Sequence[Alike], among: int) -> list[list[Alike]]:
    """What is asked of one run, in as many parts for each process, and each about as long."""
    if not every:
        return []
    count = sum(one.simulations for one in every)
    parts = max(-(-count // (LANES * among)), 1) * among
    takes = np.array([one.takes for one in every])
    part = (np.cumsum(takes) - 0.5 * takes) * parts // takes.sum()
    if np.bincount(part.astype(int)).max() > LANES:
        part = np.arange(len(every)) * parts // len(every)
    found = [[every[i] for i in np.flatnonzero(part == number).tolist()] for number in range(parts)]
    return [one for one in found if one]


def _takes(part: Sequence[Alike]) -> float:
    """How long a process takes for it, in simulations one by one."""
    count = sum(one.simulations for one in part)
    lanes = lanes_from({name for one in part for name in one.effects})
    full, rest = divmod(count, LANES)
    return full * lanes + min(rest, lanes) + sum(one.takes - one.simulations for one in part)
