"""True machines: off their rig file by what its sigmas allow."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.machine import Offset
from cdpr8.rigfile import Rig

Array = NDArray[np.float64]

CLIP = 2.0
"""No number is off by more sigmas than this: beyond 3 it would be a mismatch."""


def drawn_offset(rig: Rig, generator: np.random.Generator) -> Offset:
    """A true machine less its rig file, each number Gaussian by its sigma.

    Parameters
    ----------
    rig
        With its sigmas.
    generator
        Source of the draw.
    """

    def normal(*shape: int) -> Array:
        return np.clip(generator.standard_normal(shape), -CLIP, CLIP)

    def share(name: str) -> Array:
        rows = [getattr(cable, name) for cable in rig.cable]
        return np.array([row.sigma / row.value for row in rows]) * normal(8)

    platform = rig.platform
    base = np.array([cable.base_m.sigma for cable in rig.cable])[:, None] * normal(8, 3)
    anchor = np.array([cable.anchor_m.sigma for cable in rig.cable])[:, None] * normal(8, 3)
    pretension = np.array([cable.pretension_n.sigma for cable in rig.cable]) * normal(8)
    return Offset(
        mass_share=float(platform.mass_kg.sigma / platform.mass_kg.value * normal(1)[0]),
        inertia_kg_m2=_inertia(rig, generator),
        centre_m=platform.centre_of_mass_m.sigma * normal(3),
        stiffness_share=share("stiffness_n_per_m"),
        density_share=share("line_density_kg_per_m"),
        loss_share=share("damping_1_per_s"),
        base_m=base,
        anchor_m=anchor,
        pretension_n=pretension,
    )


def _inertia(rig: Rig, generator: np.random.Generator) -> Array:
    """Three gains that leave a body that can be."""
    row = rig.platform.inertia_kg_m2
    value = np.array(row.value, dtype=float)
    principal = np.diag(value) if value.ndim == 2 else value
    while True:
        gain = row.sigma * np.clip(generator.standard_normal(3), -CLIP, CLIP)
        small, middle, large = np.sort(principal + gain)
        if small > 0.3 * principal.min() and small + middle > large:
            return np.asarray(gain)
