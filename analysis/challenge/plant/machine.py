"""One machine as plain numbers, and what a true machine differs by from its rig file."""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.rigfile import Rig

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Machine:
    """Platform and cables, SI units.

    Parameters
    ----------
    mass
        kg.
    inertia
        About the centre of mass, platform frame, shape (3, 3), kg m2.
    base, anchor
        In O-XYZ, and from the centre of mass in the platform frame; shape (8, 3), m.
    stiffness, pretension, line_density, string_loss
        Of each cable, shape (8,); N/m, N, kg/m and 1/s (of the transverse vibration).
    cell_behind
        Where the cell does not see the friction of the pulley, shape (8,).
    gravity
        m/s2.
    """

    mass: float
    inertia: Array
    base: Array
    anchor: Array
    stiffness: Array
    pretension: Array
    line_density: Array
    string_loss: Array
    cell_behind: NDArray[np.bool_]
    gravity: float = STANDARD_GRAVITY_M_PER_S2

    @classmethod
    def from_rig(cls, rig: Rig) -> Self:
        """The machine that a rig file describes."""
        inertia = np.array(rig.platform.inertia_kg_m2.value, dtype=float)
        centre = np.array(rig.platform.centre_of_mass_m.value)
        column = {
            name: np.array([getattr(cable, name).value for cable in rig.cable])
            for name in (
                "base_m",
                "anchor_m",
                "stiffness_n_per_m",
                "pretension_n",
                "line_density_kg_per_m",
                "damping_1_per_s",
            )
        }
        return cls(
            mass=rig.platform.mass_kg.value,
            inertia=np.diag(inertia) if inertia.ndim == 1 else inertia,
            base=column["base_m"],
            anchor=column["anchor_m"] - centre,
            stiffness=column["stiffness_n_per_m"],
            pretension=column["pretension_n"],
            line_density=column["line_density_kg_per_m"],
            string_loss=column["damping_1_per_s"],
            cell_behind=np.array([cable.cell.value != "platform" for cable in rig.cable]),
        )

    @property
    def lines(self) -> tuple[Array, Array]:
        """Lengths at rest, shape (8,), m, and directions from anchor to base, shape (8, 3)."""
        vector = self.base - self.anchor
        length = np.linalg.norm(vector, axis=1)
        return length, vector / length[:, None]

    @property
    def structure(self) -> Array:
        """Columns [u_i, r_i x u_i] at rest, shape (6, 8)."""
        _, direction = self.lines
        return np.vstack([direction.T, np.cross(self.anchor, direction).T])

    @property
    def post_of(self) -> NDArray[np.int64]:
        """The post of each cable, 0 to 3: the quadrant of the floor its base stands in."""
        return np.asarray((self.base[:, 0] > 0) + 2 * (self.base[:, 1] > 0), dtype=np.int64)

    @property
    def softest_and_stiffest_rad_per_s(self) -> tuple[float, float]:
        """Lowest and highest circular tone of the rigid platform on its cables, rad/s."""
        structure = self.structure
        inertia = np.zeros((6, 6))
        inertia[:3, :3] = self.mass * np.eye(3)
        inertia[3:, 3:] = self.inertia
        squares = np.linalg.eigvals(
            np.linalg.solve(inertia, (structure * self.stiffness) @ structure.T)
        ).real
        return float(np.sqrt(squares.min())), float(np.sqrt(squares.max()))


@dataclass(frozen=True)
class Offset:
    """True machine less the rig file; zeros: the machine is as described.

    Parameters
    ----------
    mass_share, stiffness_share, density_share, loss_share
        Relative; the last three of each cable, shape (8,).
    inertia_kg_m2
        Of the three principal values, shape (3,).
    centre_m
        True centre of mass from the rig file's, platform frame, shape (3,).
    base_m, anchor_m
        Shape (8, 3).
    pretension_n
        Shape (8,).
    """

    mass_share: float
    inertia_kg_m2: Array
    centre_m: Array
    stiffness_share: Array
    density_share: Array
    loss_share: Array
    base_m: Array
    anchor_m: Array
    pretension_n: Array

    @classmethod
    def none(cls) -> Self:
        """No difference."""
        zero = np.zeros(8)
        points = np.zeros((8, 3))
        return cls(0.0, np.zeros(3), np.zeros(3), zero, zero, zero, points, points, zero)

    def applied(self, machine: Machine) -> Machine:
        """The true machine."""
        return replace(
            machine,
            mass=machine.mass * (1.0 + self.mass_share),
            inertia=machine.inertia + np.diag(self.inertia_kg_m2),
            # Seen from the true centre of mass, which rests that far from the rig file's.
            base=machine.base + self.base_m - self.centre_m,
            anchor=machine.anchor + self.anchor_m - self.centre_m,
            stiffness=machine.stiffness * (1.0 + self.stiffness_share),
            pretension=machine.pretension + self.pretension_n,
            line_density=machine.line_density * (1.0 + self.density_share),
            string_loss=machine.string_loss * (1.0 + self.loss_share),
        )

    def with_set(self, **parts: Array | float) -> "Offset":
        """The same with numbers set where the parts are not zero: a mismatch is not softened."""
        found = self
        for name, part in parts.items():
            there: Any = part if np.ndim(part) == 0 else np.where(part, part, getattr(self, name))
            found = replace(found, **{name: there})
        return found

    def with_added(self, **parts: Array | float) -> "Offset":
        """The same with parts added, by name."""
        return replace(self, **{name: getattr(self, name) + part for name, part in parts.items()})
