"""What can be concealed: the size of each effect, its further numbers, where it goes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.machine import Machine
from analysis.challenge.plant.plant import NOTHING, Hidden
from analysis.challenge.plant.sensors import Faults

SOUND = Faults()

Array = NDArray[np.float64]
Details = Mapping[str, float]


@dataclass(frozen=True)
class Parts:
    """What one effect changes: physics, the machine's numbers, or the sensors."""

    hidden: Hidden = NOTHING
    offset: Mapping[str, Array | float] = field(default_factory=dict)
    faults: Faults = SOUND


Law = Callable[[float, Array, Details, Machine], Parts]
"""Parts of a size, a mask of cables (shape (8,), 0 or 1), further numbers and the machine."""

Told = Callable[[float, Details, Machine], dict[str, float]]

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
        How many it may take: "one", "some", "pair", "all" or "none" (it is not of a cable).
    draw
        Its further numbers.
    signed
        Whether the size may be negative.
    told
        The numbers a diagnosis can be held against, by the fitting library's names, all of one
        unit; default: the size under its name.
    least
        Smallest size drawn: off by more than 3 sigma, or a whole frame.
    straight
        Whether a small size acts like a large one in proportion. It then shows by its slope: a
        machine that rings long runs out of phase with a far one, which is no more visible for it.
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
    cables: str = "none"
    draw: Draw = lambda _: {}
    signed: bool = False
    told: Told | None = None
    least: float = 0.0
    straight: bool = False
    sound: float = 0.0


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

    def parts(self, machine: Machine) -> Parts:
        """What it changes in the plant."""
        mask = np.zeros(8)
        mask[[cable - 1 for cable in self.cables]] = 1.0
        return self.effect.law(self.size, mask, self.details, machine)

    def told(self, machine: Machine) -> dict[str, float]:
        """Its numbers as a diagnosis should report them."""
        if self.effect.told is None:
            return {self.effect.size: self.size}
        return self.effect.told(self.size, self.details, machine)

    def resized(self, size: float) -> "Concealed":
        """The same, of another size."""
        return Concealed(self.effect, size, self.cables, self.details)


def unsaid(*_: object) -> dict[str, float]:
    """No number of this effect means the same in the fitting library."""
    return {}


def along(*names: str) -> Told:
    """The size along a drawn direction, under three names."""

    def told(size: float, details: Details, _: Machine) -> dict[str, float]:
        vector = np.array([details["x"], details["y"], details["z"]])
        vector *= size / np.linalg.norm(vector)
        return dict(zip(names, vector.tolist(), strict=True))

    return told


def between(**ranges: tuple[float, float]) -> Draw:
    """Numbers drawn evenly in their logarithm, by name."""

    def draw(generator: np.random.Generator) -> dict[str, float]:
        return {
            name: float(np.exp(generator.uniform(np.log(low), np.log(high))))
            for name, (low, high) in ranges.items()
        }

    return draw


def catalogue() -> dict[str, Effect]:
    """Every effect that can be concealed, by name."""
    from analysis.challenge.plant.concealed_cable import CABLE_EFFECTS
    from analysis.challenge.plant.concealed_platform import PLATFORM_EFFECTS
    from analysis.challenge.plant.concealed_sensors import SENSOR_EFFECTS

    effects = (*CABLE_EFFECTS, *PLATFORM_EFFECTS, *SENSOR_EFFECTS)
    return {effect.name: effect for effect in effects}
