"""A machine as a few numbers: what Table I must have held, for a rig whose sides mirror each other.

Cables come in pairs, left and right: (1, 2), (4, 3), (5, 8), (6, 7). Free are the parameters below.
Three things are not free but follow: how far fore and aft the anchors are (from the tension
variations published for cables 1 and 7), and three of the four pretensions (from static
equilibrium).
"""

from dataclasses import dataclass, fields, replace
from typing import Self, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.rigfile.schema import Rig
from model.machine import Machine

Array = NDArray[np.float64]

KEVLAR_DENSITY_KG_PER_M3 = 1440.0
"""Handbook value; the paper says Kevlar (Section 6)."""

THICKEST_M = 3e-3
"""Section 3.2: d <= 3 mm."""

HEAVIEST_KG_PER_M = KEVLAR_DENSITY_KG_PER_M3 * np.pi / 4.0 * THICKEST_M**2

PAIR_OF_CABLE = np.array([0, 0, 1, 1, 2, 3, 3, 2])
"""Front-up (1, 2), rear-up (3, 4), front-down (5, 8), rear-down (6, 7)."""

SIDE_OF_CABLE = np.array([1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
"""+1 left, -1 right."""

BOUNDS: dict[str, tuple[float, float]] = {
    "front_y": (0.02, 0.30),
    "front_z": (-0.12, 0.12),
    "rear_y": (0.02, 0.30),
    "rear_z": (-0.12, 0.12),
    "front_drop": (-0.10, 0.25),
    "rear_drop": (-0.10, 0.25),
    "base_up_y": (0.4, 2.5),
    "base_down_y": (0.4, 2.5),
    "base_up_z": (0.7, 3.0),
    "base_down_z": (-3.0, -0.7),
    "front_up_x": (-1.0, 4.0),
    "rear_up_x": (-4.0, 1.0),
    "front_down_x": (-1.0, 4.0),
    "rear_down_x": (-4.0, 1.0),
    "mass": (0.4, 5.0),
    "spread_x": (0.04, 0.40),
    "spread_y": (0.04, 0.30),
    "spread_z": (0.02, 0.25),
    "line_density": (0.001, float(HEAVIEST_KG_PER_M)),
    "damping": (0.2, 15.0),
    "rear_down_tension": (3.0, 25.0),
}
"""What a laboratory has room for, and Kevlar; m, kg, kg/m, 1/s, N."""

REACH_M = (0.04, 0.60)
"""How far fore or aft of the centre of mass an anchor may be."""


@dataclass(frozen=True)
class Layout:
    """A symmetric machine; m, kg, kg/m, 1/s, N.

    Parameters
    ----------
    front_x, front_y, front_z
        Anchor of cable 1 from the centre of mass; that of cable 2 mirrors it.
    rear_x, rear_y, rear_z
        Anchor of cable 4.
    front_drop, rear_drop
        How far the anchors of the lower cables (5 and 6) are below those.
    base_up_y, base_up_z, base_down_y, base_down_z
        The frame: base points of the upper and of the lower cables, left side.
    front_up_x, rear_up_x, front_down_x, rear_down_x
        Where along X the base points of the four pairs are.
    mass
        Of the platform.
    spread_x, spread_y, spread_z
        Root mean square distance of the platform's mass from the centre along each axis: any three
        make an inertia a rigid body can have.
    line_density, damping
        Of every cable.
    rear_down_tension
        Pretension of cables 6 and 7; the others follow from equilibrium.
    """

    front_x: float
    front_y: float
    front_z: float
    rear_x: float
    rear_y: float
    rear_z: float
    front_drop: float
    rear_drop: float
    base_up_y: float
    base_down_y: float
    base_up_z: float
    base_down_z: float
    front_up_x: float
    rear_up_x: float
    front_down_x: float
    rear_down_x: float
    mass: float
    spread_x: float
    spread_y: float
    spread_z: float
    line_density: float
    damping: float
    rear_down_tension: float

    @classmethod
    def of_machine(cls, machine: Machine) -> Self:
        """The layout of a machine whose pairs mirror each other and whose inertia is diagonal."""
        half = 0.5 * np.trace(machine.inertia)
        spread = np.sqrt(np.maximum(half - np.diag(machine.inertia), 0.0) / machine.mass)
        base, anchor = machine.base, machine.anchor
        return cls(
            front_x=float(anchor[0, 0]),
            front_y=float(anchor[0, 1]),
            front_z=float(anchor[0, 2]),
            rear_x=float(anchor[3, 0]),
            rear_y=float(anchor[3, 1]),
            rear_z=float(anchor[3, 2]),
            front_drop=float(anchor[0, 2] - anchor[4, 2]),
            rear_drop=float(anchor[3, 2] - anchor[5, 2]),
            base_up_y=float(base[0, 1]),
            base_down_y=float(base[4, 1]),
            base_up_z=float(base[0, 2]),
            base_down_z=float(base[4, 2]),
            front_up_x=float(base[0, 0]),
            rear_up_x=float(base[3, 0]),
            front_down_x=float(base[4, 0]),
            rear_down_x=float(base[5, 0]),
            mass=float(machine.mass),
            spread_x=float(spread[0]),
            spread_y=float(spread[1]),
            spread_z=float(spread[2]),
            line_density=float(machine.line_density[0]),
            damping=float(machine.damping[0]),
            rear_down_tension=float(machine.pretension[5]),
        )

    @classmethod
    def of_vector(cls, vector: Array, front_x: float, rear_x: float) -> Self:
        """The layout of a point of the search: the parameters of `BOUNDS`, in order."""
        values = dict(zip(BOUNDS, map(float, vector), strict=True))
        return cls(front_x=front_x, rear_x=rear_x, **values)

    def vector(self) -> Array:
        """The parameters of `BOUNDS`, in order."""
        return np.array([getattr(self, name) for name in BOUNDS])

    def rounded(self, digits: int) -> Self:
        """With every number to so many significant digits: what a rig file will hold."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return replace(self, **{k: float(f"{v:.{digits}g}") for k, v in values.items()})

    @property
    def base(self) -> Array:
        """Base points, shape (8, 3)."""
        x = np.array([self.front_up_x, self.rear_up_x, self.front_down_x, self.rear_down_x])
        y = np.array([self.base_up_y, self.base_up_y, self.base_down_y, self.base_down_y])
        z = np.array([self.base_up_z, self.base_up_z, self.base_down_z, self.base_down_z])
        return _mirrored(x, y, z)

    @property
    def anchor(self) -> Array:
        """Anchors, shape (8, 3)."""
        x = np.array([self.front_x, self.rear_x, self.front_x, self.rear_x])
        y = np.array([self.front_y, self.rear_y, self.front_y, self.rear_y])
        low = np.array([self.front_drop, self.rear_drop])
        z = np.array([self.front_z, self.rear_z, self.front_z, self.rear_z])
        z[2:] -= low
        return _mirrored(x, y, z)

    @property
    def inertia(self) -> Array:
        """Principal inertias, shape (3,), kg m2."""
        squares = np.array([self.spread_x, self.spread_y, self.spread_z]) ** 2
        return np.asarray(self.mass * (squares.sum() - squares))

    @property
    def pretension(self) -> Array:
        """T_0i that carry the weight, shape (8,): X, Z and pitch are left to balance."""
        line = self.base - self.anchor
        direction = line / np.linalg.norm(line, axis=1, keepdims=True)
        moment = np.cross(self.anchor, direction)
        left = [0, 3, 4, 5]
        rows = 2.0 * np.stack([direction[left, 0], direction[left, 2], moment[left, 1]])
        load = np.array([0.0, self.mass * STANDARD_GRAVITY_M_PER_S2, 0.0])
        load -= rows[:, 3] * self.rear_down_tension
        try:
            others = np.linalg.solve(rows[:, :3], load)
        except np.linalg.LinAlgError:
            others = np.full(3, -np.inf)
        return np.asarray(np.append(others, self.rear_down_tension)[PAIR_OF_CABLE])

    def rig(self, pattern: Rig) -> Rig:
        """The machine as a rig; all that is not mechanical, and the stiffness, are another's."""
        cables = tuple(
            cable.model_copy(
                update={
                    "base_m": _with(cable.base_m, _triple(base)),
                    "anchor_m": _with(cable.anchor_m, _triple(anchor)),
                    "pretension_n": _with(cable.pretension_n, float(pretension)),
                    "line_density_kg_per_m": _with(cable.line_density_kg_per_m, self.line_density),
                    "damping_1_per_s": _with(cable.damping_1_per_s, self.damping),
                }
            )
            for cable, base, anchor, pretension in zip(
                pattern.cable, self.base, self.anchor, self.pretension, strict=True
            )
        )
        platform = pattern.platform.model_copy(
            update={
                "mass_kg": _with(pattern.platform.mass_kg, self.mass),
                "inertia_kg_m2": _with(pattern.platform.inertia_kg_m2, _triple(self.inertia)),
            }
        )
        return pattern.model_copy(update={"platform": platform, "cable": cables})


Row = TypeVar("Row", bound=BaseModel)


def _with(row: Row, value: object) -> Row:
    """A parameter with another value; its unit and sigma stay."""
    return row.model_copy(update={"value": value})


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _mirrored(x: Array, y: Array, z: Array) -> Array:
    """Points of the four pairs as points of the eight cables."""
    pair = PAIR_OF_CABLE
    return np.stack([x[pair], SIDE_OF_CABLE * y[pair], z[pair]], axis=1)


def reach(layout: Layout, cable: int, stiffness: float, pitch_rad: float, wanted_n: float) -> float:
    """How far fore or aft a cable's anchor must be for a given variation of its tension.

    Parameters
    ----------
    layout
        All else; its own `front_x` or `rear_x` says which side of the centre is meant.
    cable
        Index: 0 (cable 1) is on the front anchor, 6 (cable 7) on the rear one.
    stiffness
        k_w, N/m.
    pitch_rad
        Amplitude of the pitch about the centre of mass.
    wanted_n
        max |k Delta L| over that pitch.

    Returns
    -------
    float
        x of the anchor, m; NaN where none within `REACH_M` gives that variation.
    """
    base, anchor = layout.base[cable], layout.anchor[cable]
    side = np.sign(anchor[0])
    x = side * np.linspace(*REACH_M, 113)
    y, z = anchor[1], anchor[2]
    rest = _distance(base, x, y, z)
    variation = np.zeros_like(x)
    for angle in (-pitch_rad, pitch_rad):
        sine, cosine = np.sin(angle), np.cos(angle)
        turned = _distance(base, cosine * x + sine * z, y, cosine * z - sine * x)
        variation = np.maximum(variation, stiffness * np.abs(turned - rest))
    excess = variation - wanted_n
    crossing = np.flatnonzero((excess[:-1] < 0) & (excess[1:] >= 0))
    if crossing.size == 0:
        return float("nan")
    at = crossing[0]
    share = excess[at] / (excess[at] - excess[at + 1])
    return float(x[at] + share * (x[at + 1] - x[at]))


def _distance(base: Array, x: Array, y: float, z: Array | float) -> Array:
    return np.asarray(np.sqrt((base[0] - x) ** 2 + (base[1] - y) ** 2 + (base[2] - z) ** 2))
