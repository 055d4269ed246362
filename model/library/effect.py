"""An effect as data plus its laws: what one file of `model.effects` says."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from inspect import signature
from typing import Any

Law = Callable[..., Any]


class Acts(StrEnum):
    """Where an effect acts."""

    CABLE = "cable"
    PULLEY = "pulley"
    PLATFORM = "platform"
    PARAMETER = "parameter"
    DRIVE = "drive"
    CELL = "cell"
    CAMERA = "camera"
    CLOCK = "clock"

    @property
    def side(self) -> str:
        """The side of a mismatch it stands on: plant, parameter, drive, cell, camera or clock."""
        return "plant" if self in (Acts.CABLE, Acts.PULLEY, Acts.PLATFORM) else self.value

    @property
    def in_kernel(self) -> bool:
        """Whether its laws are compiled into the kernel."""
        return self.side == "plant"


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Parameters
    ----------
    name, unit
        As in a rig file; the unit of a pure number is "1".
    default
        What the effect takes where nothing is said: a typical size.
    low, high
        The plausible range; anything beyond is refused.
    meaning
        In a few words.
    per_cable
        Whether each cable may have its own.
    magnitude
        Whether zero of it (and of the other magnitudes) is no effect at all.
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    meaning: str
    per_cable: bool = True
    magnitude: bool = False


def elongated(elongation: Any) -> Any:
    """Of a state that follows the elongation of its cable: at rest it has come to it."""
    return elongation


@dataclass(frozen=True)
class State:
    """One internal state of a plant effect, of each cable.

    Parameters
    ----------
    name, unit
        The name is what its laws call it.
    meaning
        In a few words.
    shared
        Whether the cables of one post share it; each adds its part to its rate.
    rests
        What it has come to where the machine hangs, of `elongation` in m, shape (..., 8), of the
        machine's `stiffness` and of the effect's parameters, shape (8,); None: it stays where it
        begins, or is held by a rate.
    goes
        What it gains of a speed that the platform is given at once, as a motion without a ramp
        begins: of `elongation_rate` in m/s, shape (..., 8), and of the same numbers; None: nothing.
    held_by
        The state whose rate is zero where this one is at rest, which may be its own; "": it stays
        where it begins.
    """

    name: str
    unit: str
    meaning: str
    shared: bool = False
    rests: Law | None = None
    goes: Law | None = None
    held_by: str = ""


@dataclass(frozen=True)
class Effect:
    """One left-out effect.

    The arguments of a law are found by their names: parameters and states of the effect, and what
    `model.library.context` lists. A law must be free of branches, of loops and of the C
    library (use `model.library.smooth`), so that the lane kernel can run it side by side.

    Parameters
    ----------
    name
        Stable identifier (design, section 6).
    title
        In plain words.
    acts
        Where it acts.
    equation, source
        The law, and where it comes from.
    signature
        What it looks like in the residual of a model without it.
    parameters, states
        Its numbers and its internal states.
    pull
        Plant: adds to a cable's tension at the anchor, N.
    behind
        Plant: the part of the tension a cell behind the pulley does not see, N. Default: `pull`
        where it acts at the pulley, else nothing.
    rates
        Plant: the rates of the states: one value, or a tuple in their order.
    transverse
        Plant: adds to X_w' and X_w'', m/s and m/s2.
    across
        Plant: adds a force on the platform at a cable's anchor, N, a tuple of three in O-XYZ.
    wrench
        Plant: adds force and moment on the platform, a tuple of six.
    change
        Parameter: gives another `Machine`.
    reckoned
        Plant: gives another `Machine` that the drive was made for.
    command
        Drive: gives another `Motion`.
    measure
        Cell: gives other tensions, of times, tensions and parameters. Camera, clock, and a
        parameter that moves the point that is seen: gives another function from stamps to poses.
    order
        Cell, camera and clock: the place in the chain from the physical quantity to the record.
    steepest
        Plant: the largest slope of the tension over the speed of the cable, N s/m: a slope that
        damps faster than a step can follow makes it unstable.
    stiffest
        Plant: the largest slope of the tension over the elongation beside the cable's own, N/m, as
        of a bristle that sticks: an explicit step must not make its tone grow.
    longest_step_s
        The integrator must not step over a switch this sharp, or what its parameters say of that;
        None where it is smooth.
    cost
        What that costs.
    """

    name: str
    title: str
    acts: Acts
    equation: str
    source: str
    signature: str
    parameters: tuple[Parameter, ...]
    states: tuple[State, ...] = ()
    pull: Law | None = None
    behind: Law | None = None
    rates: Law | None = None
    transverse: Law | None = None
    across: Law | None = None
    wrench: Law | None = None
    change: Law | None = None
    reckoned: Law | None = None
    command: Law | None = None
    measure: Law | None = None
    order: int = 0
    steepest: Law | None = None
    stiffest: Law | None = None
    longest_step_s: float | Law | None = None
    cost: str = ""

    def asks_for(self, name: str) -> bool:
        """Whether a law of its in the kernel asks for this by name, such as "line_density"."""
        laws = (self.pull, self.behind, self.rates, self.transverse, self.across, self.wrench)
        return any(law is not None and name in signature(law).parameters for law in laws)

    @property
    def per_cable(self) -> bool:
        """Whether the cables it acts on can be chosen."""
        return any(parameter.per_cable for parameter in self.parameters)

    @property
    def magnitudes(self) -> tuple[str, ...]:
        """Names of the parameters whose zeros are no effect."""
        return tuple(one.name for one in self.parameters if one.magnitude)
