"""What can be concealed: the size of each effect, its further numbers, where it goes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.machine import Machine
from analysis.challenge.outsider.plant import NOTHING, Hidden
from analysis.challenge.outsider.record import Faults
from cdpr8.rigfile import Excitation

Array = NDArray[np.float64]
Details = Mapping[str, float]

SOUND = Faults()

PAIRS = ((1, 2), (3, 4), (5, 8), (6, 7))
"""Cables that mirror each other: what happens to one often happens to both."""

SWAPS = ((1, 3), (2, 5), (4, 6), (3, 8), (2, 7))
"""Neighbours in a cabinet; mirrored ones, swapped, would not show."""

EVERY = tuple(range(1, 9))

SPREAD = 0.12
"""By which cables differ in what is concealed in them, at most."""


@dataclass(frozen=True)
class Scene:
    """What an effect needs to know of where it is concealed.

    Parameters
    ----------
    nominal, true
        The machine by its rig file, and as it is but for effects.
    excitation
        The motion asked for.
    """

    nominal: Machine
    true: Machine
    excitation: Excitation


@dataclass(frozen=True)
class Parts:
    """What one effect changes: physics, the machine's numbers, or the sensors."""

    hidden: Hidden = NOTHING
    offset: Mapping[str, Array | float] = field(default_factory=dict)
    faults: Faults = SOUND


Law = Callable[[float, Array, Details, Scene], Parts]
"""Parts of a size, a mask of cables (shape (8,), 0 or 1), further numbers and the scene."""

Told = Callable[[float, Array, Details], dict[str, float]]
"""Numbers of a size, a mask of cables and further numbers."""

Draw = Callable[[np.random.Generator], dict[str, float]]


@dataclass(frozen=True)
class Effect:
    """One effect that can be concealed.

    Parameters
    ----------
    name, side
        As diagnosis names them (design, section 6).
    size, unit
        The number that makes it large or small; its name is that of the fitting library where the
        two mean the same, so that a reported value can be held against it.
    typical, most
        A usual size and the largest drawn.
    law
        Where it goes.
    cables
        Which it may take, with their odds: "one", "pair" (mirrored), "all", "swap"; none: it is of
        no cable.
    draw
        Its further numbers.
    signed
        Whether the size may be negative.
    told
        The numbers a diagnosis can be held against, by the fitting library's names.
    least
        Smallest size drawn.
    straight
        Whether a small size acts like a large one in proportion.
    sound
        What a sound machine has of it, one sigma: so much is no mismatch. Quartz is off by this.
    """

    name: str
    side: str
    size: str
    unit: str
    typical: float
    most: float
    law: Law
    cables: Mapping[str, float] = field(default_factory=dict)
    draw: Draw = lambda _: {}
    signed: bool = False
    told: Told | None = None
    least: float = 0.0
    straight: bool = False
    sound: float = 0.0

    def chosen(self, generator: np.random.Generator) -> tuple[int, ...]:
        """Cables that it is concealed in."""
        if not self.cables:
            return ()
        kind = str(generator.choice(list(self.cables), p=list(self.cables.values())))
        if kind == "all":
            return EVERY
        if kind == "one":
            return (int(generator.integers(1, 9)),)
        choice = PAIRS if kind == "pair" else SWAPS
        return choice[int(generator.integers(len(choice)))]


@dataclass(frozen=True)
class Concealed:
    """One effect as it is in a case.

    Parameters
    ----------
    effect
        Which.
    size
        How large, in its unit.
    cables
        Numbers of the cables it is on, 1 to 8; empty where it is of none.
    details
        Its further numbers.
    """

    effect: Effect
    size: float
    cables: tuple[int, ...]
    details: Details

    @property
    def mask(self) -> Array:
        """1 where a cable has it, shape (8,)."""
        found = np.zeros(8)
        found[[cable - 1 for cable in self.cables]] = 1.0
        return found

    def parts(self, scene: Scene) -> Parts:
        """What it changes in the plant."""
        return self.effect.law(self.size, self.mask, self.details, scene)

    def told(self) -> dict[str, float]:
        """Its numbers as a diagnosis should report them."""
        if self.effect.told is None:
            return {self.effect.size: self.size}
        return self.effect.told(self.size, self.mask, self.details)

    def resized(self, size: float) -> "Concealed":
        """The same, of another size."""
        return Concealed(self.effect, size, self.cables, self.details)


def unsaid(*_: object) -> dict[str, float]:
    """No number of this effect means the same in the fitting library."""
    return {}


def between(**ranges: tuple[float, float]) -> Draw:
    """Numbers drawn evenly, by name."""

    def draw(generator: np.random.Generator) -> dict[str, float]:
        return {name: float(generator.uniform(*limits)) for name, limits in ranges.items()}

    return draw


def each(name: str, low: float, high: float) -> Draw:
    """A number of each cable, drawn evenly: `name`_1 to `name`_8."""
    return between(**{f"{name}_{cable}": (low, high) for cable in EVERY})


def both(*draws: Draw) -> Draw:
    """The numbers of several draws."""

    def draw(generator: np.random.Generator) -> dict[str, float]:
        found: dict[str, float] = {}
        for one in draws:
            found |= one(generator)
        return found

    return draw


def of_each(details: Details, name: str, default: float) -> Array:
    """The number of each cable that `each` drew, shape (8,)."""
    return np.array([details.get(f"{name}_{cable}", default) for cable in EVERY])


UNEVEN = each("share", 1.0 - SPREAD, 1.0 + SPREAD)
"""Cables are not alike in what is concealed in them."""


def uneven(size: float, mask: Array, details: Details) -> Array:
    """A size of each cable that has it, shape (8,)."""
    return np.asarray(size * mask * of_each(details, "share", 1.0))


def mean_told(name: str, factor: float = 1.0) -> Told:
    """The mean size of the cables that have it, times a factor, under one name."""

    def told(size: float, mask: Array, details: Details) -> dict[str, float]:
        return {name: factor * float(uneven(size, mask, details)[mask > 0.0].mean())}

    return told


def direction(details: Details) -> Array:
    """A unit vector from the details x, y, z."""
    vector = np.array([details["x"], details["y"], details["z"]])
    return np.asarray(vector / np.linalg.norm(vector))


def anywhere(generator: np.random.Generator) -> dict[str, float]:
    """A direction in space."""
    return dict(zip("xyz", generator.standard_normal(3).tolist(), strict=True))


def along(*names: str) -> Told:
    """The size along a drawn direction, under three names."""

    def told(size: float, mask: Array, details: Details) -> dict[str, float]:
        return dict(zip(names, (size * direction(details)).tolist(), strict=True))

    return told


def catalogue() -> dict[str, Effect]:
    """Every effect that can be concealed, by name."""
    from analysis.challenge.outsider.concealed_cable import CABLE_EFFECTS
    from analysis.challenge.outsider.concealed_friction import FRICTION_EFFECTS
    from analysis.challenge.outsider.concealed_platform import PLATFORM_EFFECTS
    from analysis.challenge.outsider.concealed_sensors import SENSOR_EFFECTS

    effects = (*FRICTION_EFFECTS, *CABLE_EFFECTS, *PLATFORM_EFFECTS, *SENSOR_EFFECTS)
    return {effect.name: effect for effect in effects}
