"""One machine as plain arrays: what the equations of motion need of a rig file, and no more."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
import numpy.typing as npt
from numpy.typing import NDArray

from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.rigfile.checks import anchors_from_centre_of_mass, inertia_tensor
from cdpr8.rigfile.schema import Rig
from model.cable import tone_hz
from model.kernel import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Machine:
    """Platform and cables, in SI units.

    Parameters
    ----------
    mass
        m, kg.
    inertia
        About the centre of mass in the platform frame, shape (3, 3), kg m2.
    base
        B_i, base points in O-XYZ, shape (8, 3), m.
    anchor
        x_Pi, anchors relative to the centre of mass in the platform frame, shape (8, 3), m.
    stiffness
        k_wi, shape (8,), N/m.
    pretension
        T_0i, shape (8,), N.
    line_density
        rho_w A, shape (8,), kg/m.
    damping
        c_wi of Eq. 17, shape (8,), 1/s.
    gravity
        Along -Z, m/s2.
    drive_arm
        Where the drive's wrench acts, from the centre of mass in the platform frame, shape (3,), m.
    held
        What holds the rig file's machine at rest at X* = 0 beside cables and weight, force and
        moment, shape (6,), N and N m: what its numbers leave of static equilibrium.
    least_pull
        The lowest tension that a drive made for this machine reckons with, N: 0: its cables go
        slack; -inf: they would push. A plant's never push.
    """

    mass: float
    inertia: Array
    base: Array
    anchor: Array
    stiffness: Array
    pretension: Array
    line_density: Array
    damping: Array
    gravity: float = STANDARD_GRAVITY_M_PER_S2
    drive_arm: Array = field(default_factory=lambda: np.zeros(3))
    held: Array = field(default_factory=lambda: np.zeros(6))
    least_pull: float = 0.0

    @classmethod
    def from_rig(cls, rig: Rig) -> Self:
        """The machine a rig file describes."""
        found = cls(
            mass=rig.platform.mass_kg.value,
            inertia=inertia_tensor(rig),
            base=np.array([cable.base_m.value for cable in rig.cable]),
            anchor=anchors_from_centre_of_mass(rig),
            stiffness=np.array([cable.stiffness_n_per_m.value for cable in rig.cable]),
            pretension=np.array([cable.pretension_n.value for cable in rig.cable]),
            line_density=np.array([cable.line_density_kg_per_m.value for cable in rig.cable]),
            damping=np.array([cable.damping_1_per_s.value for cable in rig.cable]),
        )
        return replace(found, held=-found.unbalanced)

    @property
    def cables(self) -> int:
        """Number of cables."""
        return len(self.stiffness)

    @cached_property
    def rest_length(self) -> Array:
        """L_0i, lengths with the platform at rest, shape (8,), m."""
        return np.asarray(np.linalg.norm(self.base - self.anchor, axis=1))

    @cached_property
    def structure(self) -> Array:
        """Force and moment of unit tensions at rest, shape (6, 8)."""
        direction = (self.base - self.anchor) / self.rest_length[:, None]
        return np.hstack([direction, np.cross(self.anchor, direction)]).T

    @property
    def unbalanced(self) -> Array:
        """Wrench at rest of pretensions, weight and what holds it, shape (6,), N and N m."""
        weight = np.array([0.0, 0.0, -self.mass * self.gravity, 0.0, 0.0, 0.0])
        lever = np.concatenate([np.zeros(3), np.cross(self.drive_arm, self.held[:3])])
        return np.asarray(self.structure @ self.pretension + weight + self.held + lever)

    @property
    def cable_tones_hz(self) -> Array:
        """The cables' own first tones at rest, shape (8,), Hz."""
        return np.asarray(tone_hz(self.pretension, self.line_density, self.rest_length))

    @property
    def platform_tones_hz(self) -> Array:
        """Tones of the rigid platform on its elastic cables at rest, shape (6,), Hz.

        From the cables' elastic stiffness J_A^T k J_A alone: what pretension adds is left out.
        """
        squares = self._per_inertia(self.stiffness)
        return np.sort(np.sqrt(np.maximum(squares, 0.0))) / (2.0 * np.pi)

    def fastest_decay_1_per_s(self, damping_n_s_per_m: Array) -> float:
        """How fast the platform's quickest motion dies with dampers along its cables.

        Parameters
        ----------
        damping_n_s_per_m
            Shape (8,).
        """
        return float(self._per_inertia(damping_n_s_per_m).max()) if damping_n_s_per_m.any() else 0.0

    def fastest_tone_rad_per_s(self, stiffer_n_per_m: Array) -> float:
        """The platform's highest tone with springs beside its cables.

        Parameters
        ----------
        stiffer_n_per_m
            Shape (8,).
        """
        return float(np.sqrt(max(self._per_inertia(self.stiffness + stiffer_n_per_m).max(), 0.0)))

    def _per_inertia(self, along_cables: Array) -> Array:
        """Eigenvalues of M^-1 J_A^T c J_A, c a law of each cable along itself, shape (6,)."""
        inertia = np.zeros((6, 6))
        inertia[:3, :3] = self.mass * np.eye(3)
        inertia[3:, 3:] = self.inertia
        whole = (self.structure * along_cables) @ self.structure.T
        return np.asarray(np.linalg.eigvals(np.linalg.solve(inertia, whole)).real)

    def plant(self) -> Plant:
        """The arrays in the order the kernel reads them."""
        return self._plant

    @cached_property
    def _plant(self) -> Plant:
        return Plant(
            mass=float(self.mass),
            gravity=float(self.gravity),
            inertia=_packed(self.inertia),
            inverse_inertia=_packed(np.linalg.inv(self.inertia)),
            drive_arm=_packed(self.drive_arm),
            base=_packed(self.base),
            anchor=_packed(self.anchor),
            rest_length=_packed(self.rest_length),
            stiffness=_packed(self.stiffness),
            pretension=_packed(self.pretension),
            line_density=_packed(self.line_density),
            damping=_packed(self.damping),
            least_pull=float(self.least_pull),
        )


def _packed(values: npt.ArrayLike) -> Array:
    """Contiguous and of one type, whatever came in: the kernel is compiled for exactly that."""
    return np.ascontiguousarray(values, dtype=np.float64)
