"""One machine as plain numbers, and what a true machine differs by from its rig file."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.rigfile import Rig

Array = NDArray[np.float64]


def rotations(axis: Array, angle: Array) -> Array:
    """Rotation matrices about a unit axis, shape (n, 3, 3), by Rodrigues.

    Parameters
    ----------
    axis
        Shape (3,).
    angle
        Shape (n,), rad.
    """
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, rest = np.sin(angle)[:, None, None], (1.0 - np.cos(angle))[:, None, None]
    return np.asarray(np.eye(3) + sine * skew + rest * (skew @ skew))


@dataclass(frozen=True)
class Machine:
    """Platform and cables, SI units.

    Parameters
    ----------
    mass
        kg.
    inertia
        About the centre of mass, platform frame, shape (3, 3), kg m2.
    centre
        The true centre of mass from the rig file's, platform frame, shape (3,), m.
    base, anchor
        In O-XYZ, and from the rig file's centre of mass in the platform frame; shape (8, 3), m.
    stiffness, pretension, line_density, string_loss
        Of each cable, shape (8,); N/m, N, kg/m and 1/s.
    """

    mass: float
    inertia: Array
    centre: Array
    base: Array
    anchor: Array
    stiffness: Array
    pretension: Array
    line_density: Array
    string_loss: Array

    @classmethod
    def from_rig(cls, rig: Rig) -> Self:
        """The machine that a rig file describes."""

        def column(name: str) -> Array:
            return np.array([getattr(cable, name).value for cable in rig.cable], dtype=float)

        inertia = np.array(rig.platform.inertia_kg_m2.value, dtype=float)
        return cls(
            mass=rig.platform.mass_kg.value,
            inertia=np.diag(inertia) if inertia.ndim == 1 else inertia,
            centre=np.zeros(3),
            base=column("base_m"),
            anchor=column("anchor_m") - np.array(rig.platform.centre_of_mass_m.value),
            stiffness=column("stiffness_n_per_m"),
            pretension=column("pretension_n"),
            line_density=column("line_density_kg_per_m"),
            string_loss=column("damping_1_per_s"),
        )

    @property
    def lines(self) -> tuple[Array, Array]:
        """Lengths at rest, shape (8,), m, and directions from anchor to base, shape (8, 3)."""
        line = self.base - self.anchor
        length = np.linalg.norm(line, axis=1)
        return length, line / length[:, None]

    @property
    def structure(self) -> Array:
        """Columns [u_i, r_i x u_i] at rest, about the rig file's centre of mass, shape (6, 8)."""
        _, direction = self.lines
        return np.vstack([direction.T, np.cross(self.anchor, direction).T])

    @property
    def weight(self) -> Array:
        """Force and moment of gravity about the rig file's centre of mass, shape (6,); N, N m."""
        force = np.array([0.0, 0.0, -self.mass * STANDARD_GRAVITY_M_PER_S2])
        return np.concatenate([force, np.cross(self.centre, force)])

    @property
    def inner(self) -> Array:
        """Orthonormal tensions that leave the platform alone, shape (8, 2)."""
        return np.asarray(np.linalg.svd(self.structure)[2][6:].T)

    def balanced(self, drive: Array) -> "Machine":
        """The same, the pretensions changed as little as can be, at rest in the zero pose.

        Parameters
        ----------
        drive
            Wrench of the frozen drive at rest, shape (6,), N and N m.
        """
        left = self.structure @ self.pretension + self.weight + drive
        change = np.linalg.lstsq(self.structure, left, rcond=None)[0]
        return replace(self, pretension=self.pretension - change)


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
        zero, points = np.zeros(8), np.zeros((8, 3))
        return cls(0.0, np.zeros(3), np.zeros(3), zero, zero, zero, points, points, zero)

    def applied(self, nominal: Machine, drive: Array) -> Machine:
        """The true machine, at rest in the zero pose under the drive's wrench (6,)."""
        found = replace(
            nominal,
            mass=nominal.mass * (1.0 + self.mass_share),
            inertia=nominal.inertia + np.diag(self.inertia_kg_m2),
            centre=self.centre_m,
            base=nominal.base + self.base_m,
            anchor=nominal.anchor + self.anchor_m,
            stiffness=nominal.stiffness * (1.0 + self.stiffness_share),
            pretension=nominal.pretension + self.pretension_n,
            line_density=nominal.line_density * (1.0 + self.density_share),
            string_loss=nominal.string_loss * (1.0 + self.loss_share),
        )
        return found.balanced(drive)

    def with_set(self, parts: Mapping[str, Array | float]) -> "Offset":
        """The same with numbers set where the parts are not zero: so a mismatch is as told."""
        found = self
        for name, part in parts.items():
            there: Any = part if np.ndim(part) == 0 else np.where(part, part, getattr(self, name))
            found = replace(found, **{name: there})
        return found

    def with_added(self, **parts: Array | float) -> "Offset":
        """The same with parts added, by name."""
        return replace(self, **{name: getattr(self, name) + part for name, part in parts.items()})
