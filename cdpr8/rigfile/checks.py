"""What no machine can have: checks of a rig file that need more than one of its values."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.errors import RigFileError
from cdpr8.rigfile.lines import Location
from cdpr8.rigfile.schema import Rig

Array = NDArray[np.float64]
Where = Callable[[Location], str]

EQUILIBRIUM_SIGMAS = 3.0
"""A static residual is refused beyond this many standard deviations of what it is made of."""

RESIDUAL_FLOOR = 1e-3
"""Residuals below this fraction of the weight are rounding of the file's digits, not a fault."""


def check_physics(rig: Rig, where: Where) -> None:
    """Refuse a rig that cannot hang at rest as described.

    Parameters
    ----------
    rig
        The rig, already sound key by key.
    where
        Spells a location of the file for a message.

    Raises
    ------
    RigFileError
        A value that must be positive is not, the inertia is of no rigid body, a cable is slack at
        rest, or the pretensions do not carry the weight.
    """
    _check_signs(rig, where)
    _check_inertia(rig, where)
    _check_geometry(rig, where)
    _check_amplifiers(rig, where)
    _check_equilibrium(rig, where)


def inertia_tensor(rig: Rig) -> Array:
    """Inertia about the centre of mass in the platform frame, shape (3, 3), in kg m2."""
    value = np.asarray(rig.platform.inertia_kg_m2.value, dtype=float)
    return np.diag(value) if value.ndim == 1 else value


def anchors_from_centre_of_mass(rig: Rig) -> Array:
    """x_Pi of Eq. 1: anchors relative to the centre of mass, platform frame, shape (8, 3), in m."""
    anchors: Array = np.array([cable.anchor_m.value for cable in rig.cable])
    anchors -= rig.platform.centre_of_mass_m.value
    return anchors


def structure_matrix_at_rest(rig: Rig) -> Array:
    """J_A^T of Eq. 2 at rest: columns [u_i, r_i x u_i], shape (6, 8); u_i from anchor to base."""
    anchors = anchors_from_centre_of_mass(rig)
    vectors = np.array([cable.base_m.value for cable in rig.cable]) - anchors
    directions = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.vstack([directions.T, np.cross(anchors, directions).T])


def _check_signs(rig: Rig, where: Where) -> None:
    rows: list[tuple[Location, float, str]] = [
        (("platform", "mass_kg"), rig.platform.mass_kg.value, "kg, above 0")
    ]
    for index, cable in enumerate(rig.cable):
        at: Location = ("cable", index)
        rows += [
            ((*at, "stiffness_n_per_m"), cable.stiffness_n_per_m.value, "N/m, above 0"),
            ((*at, "line_density_kg_per_m"), cable.line_density_kg_per_m.value, "kg/m, above 0"),
        ]
        if cable.damping_1_per_s.value < 0:
            raise RigFileError(
                f"cable {index + 1} has damping {cable.damping_1_per_s.value} 1/s",
                where=where((*at, "damping_1_per_s")),
                allowed="1/s, 0 or above",
            )
        if not cable.pretension_n.value > 0:
            raise RigFileError(
                f"cable {index + 1} would be slack at rest: pretension "
                f"{cable.pretension_n.value} N",
                where=where((*at, "pretension_n")),
                allowed="N, above 0: a cable cannot push",
                remedy="raise the pretensions together, in static equilibrium with the weight",
            )
    for location, value, allowed in rows:
        if not (np.isfinite(value) and value > 0):
            raise RigFileError(f"value {value} is refused", where=where(location), allowed=allowed)


def _check_inertia(rig: Rig, where: Where) -> None:
    tensor = inertia_tensor(rig)
    at = where(("platform", "inertia_kg_m2"))
    if not np.allclose(tensor, tensor.T, rtol=1e-9, atol=0.0):
        raise RigFileError(
            f"inertia {tensor.tolist()} is not symmetric", where=at, allowed="I_xy = I_yx and so on"
        )
    smallest, middle, largest = np.linalg.eigvalsh(tensor)
    if smallest <= 0 or smallest + middle < largest * (1 - 1e-9):
        raise RigFileError(
            f"no rigid body has principal inertias {smallest:.5g}, {middle:.5g}, {largest:.5g} "
            "kg m2",
            where=at,
            allowed="each above 0, and no one larger than the sum of the other two",
        )


def _check_geometry(rig: Rig, where: Where) -> None:
    for index, cable in enumerate(rig.cable):
        if np.allclose(cable.base_m.value, cable.anchor_m.value, atol=1e-6):
            raise RigFileError(
                f"cable {index + 1} has no length: base and anchor are the same point",
                where=where(("cable", index, "base_m")),
            )
    rank = np.linalg.matrix_rank(structure_matrix_at_rest(rig), tol=1e-9)
    if rank < 6:
        raise RigFileError(
            f"the eight cables hold only {rank} of the platform's 6 degrees of freedom",
            where=where(("cable",)),
            remedy="check base_m and anchor_m",
        )


def _check_amplifiers(rig: Rig, where: Where) -> None:
    seen: dict[int, int] = {}
    for index, cable in enumerate(rig.cable):
        if cable.amplifier is None:
            continue
        address = cable.amplifier.address
        if address in seen:
            raise RigFileError(
                f"cables {seen[address]} and {index + 1} share the bus address {address}",
                where=where(("cable", index, "amplifier", "address")),
                allowed="each address once, 0 to 31",
            )
        seen[address] = index + 1


def _check_equilibrium(rig: Rig, where: Where) -> None:
    structure = structure_matrix_at_rest(rig)
    pretension = np.array([cable.pretension_n.value for cable in rig.cable])
    weight = rig.platform.mass_kg.value * STANDARD_GRAVITY_M_PER_S2
    residual = structure @ pretension
    residual[2] -= weight
    variance = structure**2 @ np.array([cable.pretension_n.sigma**2 for cable in rig.cable])
    variance[2] += (rig.platform.mass_kg.sigma * STANDARD_GRAVITY_M_PER_S2) ** 2
    variance += _geometry_variance(rig, pretension)
    arm = np.linalg.norm(anchors_from_centre_of_mass(rig), axis=1).max()
    floor = RESIDUAL_FLOOR * weight * np.array([1, 1, 1, arm, arm, arm])
    worst = int(np.argmax(np.abs(residual) / (EQUILIBRIUM_SIGMAS * np.sqrt(variance) + floor)))
    allowed = EQUILIBRIUM_SIGMAS * np.sqrt(variance[worst]) + floor[worst]
    if abs(residual[worst]) <= allowed:
        return
    axis = ("force along X", "force along Y", "force along Z", "roll moment", "pitch moment",
            "yaw moment")[worst]  # fmt: skip
    unit = "N" if worst < 3 else "N m"
    nearest = pretension - np.linalg.pinv(structure) @ residual
    raise RigFileError(
        f"the pretensions are out of static equilibrium with the weight of {weight:.3f} N: "
        f"{axis} is {residual[worst]:+.4g} {unit}",
        where=where(("cable", 0, "pretension_n")),
        allowed=f"within {allowed:.2g} {unit} ({EQUILIBRIUM_SIGMAS:g} sigma of pretensions, mass "
        "and points)",
        remedy="nearest pretension_n in equilibrium: " + ", ".join(f"{t:.4f}" for t in nearest),
    )


def _geometry_variance(rig: Rig, pretension: Array) -> Array:
    """Variance of the static wrench from the uncertainty of the points, shape (6,).

    A point off by s turns its cable by s/L and shifts its moment arm by s.
    """
    point = np.array([np.hypot(cable.base_m.sigma, cable.anchor_m.sigma) for cable in rig.cable])
    anchors = anchors_from_centre_of_mass(rig)
    length = np.linalg.norm(np.array([c.base_m.value for c in rig.cable]) - anchors, axis=1)
    force = float(np.sum((pretension * point / length) ** 2))
    reach = np.linalg.norm(anchors, axis=1)
    moment = float(np.sum((pretension * point * (1.0 + reach / length)) ** 2))
    return np.array([force] * 3 + [moment] * 3)
