"""What the challenge asks of a plant, and which plants there are.

A plant imports nothing of the challenge: it has these attributes by itself. What one of its doors
gives, another takes (a course, an offset, a sensing); the challenge looks at the named parts only.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

NAMES = ("mujoco", "outsider")
FIRST = NAMES[0]
"""The plant where none is named: challenges made before there were two say nothing of it."""

Offset = Any
"""True machine less its rig file: a frozen dataclass with `with_added`, by names such as
stiffness_share, pretension_n, mass_share, inertia_kg_m2, centre_m, base_m and anchor_m."""


class Effect(Protocol):
    """One effect that can be concealed: how it is called, told and sized."""

    @property
    def name(self) -> str:
        """As diagnosis names it (design, section 6)."""

    @property
    def side(self) -> str:
        """Plant, parameter, drive, cell, camera or clock."""

    @property
    def size(self) -> str:
        """Name of the number that makes it large or small."""

    @property
    def unit(self) -> str:
        """Of that number."""

    @property
    def typical(self) -> float:
        """A usual size."""

    @property
    def most(self) -> float:
        """The largest drawn."""

    @property
    def least(self) -> float:
        """The smallest drawn."""

    @property
    def straight(self) -> bool:
        """Whether a small size acts like a large one in proportion."""

    @property
    def sound(self) -> float:
        """What a sound machine has of it, one sigma."""


class Concealed(Protocol):
    """One effect as it is in a case."""

    @property
    def effect(self) -> Effect:
        """Which."""

    @property
    def size(self) -> float:
        """How large, in its unit."""

    @property
    def cables(self) -> tuple[int, ...]:
        """Numbers of the cables it is on, 1 to 8; empty where it is of none."""

    @property
    def details(self) -> Mapping[str, float]:
        """Its further numbers."""

    def resized(self, size: float) -> "Concealed":
        """The same, of another size."""


class Course(Protocol):
    """What happened in a run, a frozen dataclass; not-a-number from where a machine came apart."""

    @property
    def t_s(self) -> Array:
        """Shape (n,), s."""

    @property
    def tension_n(self) -> Array:
        """At the cells, shape (n, 8), N."""

    @property
    def pose(self) -> Array:
        """Shape (n, 6), m and rad."""


class Sensing(Protocol):
    """How a run is measured where nothing is wrong; a dataclass of numbers and arrays."""

    @property
    def poll_hz(self) -> float:
        """Samples a second of each cable."""

    @property
    def tension_noise_n(self) -> Array:
        """Of each amplifier, shape (8,), N."""


class Measured(Protocol):
    """A run as recorded."""

    @property
    def tension_t_s(self) -> Array:
        """Shape (n, 8), s."""

    @property
    def tension_n(self) -> Array:
        """Shape (n, 8), N."""

    @property
    def pose_t_s(self) -> Array:
        """Shape (m,), s."""

    @property
    def pose(self) -> Array:
        """Shape (m, 6), m and rad."""

    @property
    def covariance(self) -> Array:
        """Of each pose, shape (m, 6, 6)."""


class Plant(Protocol):
    """A plant: what it can conceal, the cases it draws, and how it makes a run of one."""

    @property
    def name(self) -> str:
        """One of `NAMES`."""

    @property
    def remark(self) -> str:
        """How its runs come about, for readers of the proof."""

    @property
    def fine_step_s(self) -> float:
        """Of the integration of what is recorded, s."""

    @property
    def step_s(self) -> float:
        """Of an integration where nothing else is said, s."""

    @property
    def look_step_s(self) -> float:
        """Of the integration where only the size of a swing matters, s."""

    @property
    def steps_s(self) -> tuple[float, ...]:
        """Of the integration of differences, the longest first, s."""

    @property
    def clashes(self) -> Sequence[set[str] | frozenset[str]]:
        """Effects that are never both in one case."""

    def catalogue(self) -> Mapping[str, Any]:
        """Every effect that can be concealed, by name."""

    def concealed(
        self, name: str, size: float, cables: tuple[int, ...], details: Mapping[str, float]
    ) -> Any:
        """An effect of a size."""

    def planned(
        self, kind: str, effects: Sequence[str], generator: np.random.Generator
    ) -> tuple[list[Rig], Any, Offset]:
        """Rig file of each run with its excitation, the sensing, the true machine."""

    def sound(self, rig: Rig, offset: Offset) -> bool:
        """Whether the true machine, nothing concealed, makes a run worth keeping."""

    def placed(self, name: str, rig: Rig, offset: Offset, generator: np.random.Generator) -> Any:
        """An effect at its usual size, on some of the cables, with its further numbers."""

    def rival(
        self, name: str, cables: Sequence[int], rig: Rig, generator: np.random.Generator
    ) -> Any:
        """An effect at its usual size, on the cables of another."""

    def numbers(self, one: Any, rig: Rig) -> Mapping[str, Array | float]:
        """What an effect changes in the machine's numbers, by the names of its offset."""

    def told(self, one: Any, rig: Rig) -> dict[str, float]:
        """An effect's numbers as a diagnosis should report them."""

    def longest_step_s(self, rig: Rig, concealed: Sequence[Any]) -> float:
        """The longest of its steps at which these effects, grown stronger, can be integrated."""

    def happened(self, rig: Rig, offset: Offset, concealed: Sequence[Any], step_s: float) -> Any:
        """The course of a run."""

    def recorded(
        self,
        rig: Rig,
        offset: Offset,
        concealed: Sequence[Any],
        course: Any,
        sensing: Any,
        seed: np.random.SeedSequence,
        *,
        noise: bool,
    ) -> Any:
        """What cells and camera make of it; instants and noise depend on the seed alone."""

    def write(
        self,
        folder: Path,
        title: str,
        rig_text: str,
        excitation: Excitation,
        sensing: Any,
        measured: Any,
    ) -> None:
        """Write a run folder."""


def plant_named(name: str) -> Plant:
    """The plant of a name, one of `NAMES`.

    Parameters
    ----------
    name
        "mujoco" (an optional extra) or "outsider".
    """
    doors: dict[str, Callable[[], Plant]] = {"mujoco": _mujoco, "outsider": _outsider}
    return doors[name]()


def _mujoco() -> Plant:
    from analysis.challenge.mujoco_plant import MuJoCo

    return MuJoCo()


def _outsider() -> Plant:
    from analysis.challenge.outsider.entrant import Outsider

    return Outsider()
