"""What many tasks of a fit ask of one drive, kept: its table, and where it begins."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from model.drive import drive_table
from model.machine import Machine
from model.method import find_method
from model.motion import Motion
from model.steps import Steps
from model.tabulated import drive_at_stages

Array = NDArray[np.float64]


@lru_cache(maxsize=64)
def followed(motion: Motion, time_s: float, within_s: float) -> tuple[Array, Array]:
    """X* and X*' at a time: most tasks of a fit begin one motion."""
    pose, rate, _ = motion.at(np.array(time_s), np.array(within_s))
    return pose, rate


class _ByValue(ABC):
    """A key whose machine and arrays are told apart by value, as a cache asks."""

    @abstractmethod
    def _value(self) -> tuple[object, ...]:
        """What tells it from others."""

    @cached_property
    def _told(self) -> tuple[object, ...]:
        return self._value()

    def __hash__(self) -> int:
        return hash(self._told)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._told == other._told


@dataclass(frozen=True, eq=False)
class Resting(_ByValue):
    """Whose drive at rest."""

    machine: Machine
    motion: Motion

    def _value(self) -> tuple[object, ...]:
        return _bytes_of(self.machine), self.motion


@lru_cache(maxsize=64)
def resting_wrench(of: Resting) -> Array:
    """What the drive does before the motion, shape (6,), N and N m."""
    at_s, before = np.zeros((1, 1)), np.full((1, 1), -1.0)
    return drive_table(of.machine, of.motion, at_s, before, "wrench")[0, 0, :6]


def _bytes_of(machine: Machine) -> bytes:
    return b"".join(np.ascontiguousarray(one).tobytes() for one in machine.plant())


@dataclass(frozen=True, eq=False)
class DriveKey(_ByValue):
    """All that a drive's table depends on."""

    machine: Machine
    motion: Motion
    steps: Steps
    method: str
    kind: str

    def _value(self) -> tuple[object, ...]:
        return (
            _bytes_of(self.machine),
            self.motion,
            self.steps.point_s.tobytes(),
            self.method,
            self.kind,
        )


@lru_cache(maxsize=16)
def table_at_stages(key: DriveKey) -> Array:
    """Tables of some megabytes: a fit to several runs asks thousands of times for a few of them."""
    nodes = find_method(key.method).nodes
    return drive_at_stages(key.machine, key.motion, key.steps.point_s, nodes, key.kind)
