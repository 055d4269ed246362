"""Machines for the challenge: CDPR-8, others of its kind, and other pretensions of either."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant.machine import Machine
from analysis.challenge.rig_text import rig_text
from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.errors import RigFileError
from cdpr8.rigfile import Rig, load_rig, packaged_rig_path, parse_rig
from cdpr8.rigfile.checks import structure_matrix_at_rest

Array = NDArray[np.float64]

SLOWEST_HZ, QUICKEST_HZ = 4.0, 45.0
"""Tones of the rigid platform that a drawn machine may have: the drive stays below the first."""

ATTEMPTS = 400


def cdpr8() -> Rig:
    """The packaged CDPR-8, without a plate: its poses come tracked."""
    return load_rig(packaged_rig_path()).model_copy(update={"plate": None})


def drawn_machine(generator: np.random.Generator) -> Rig:
    """Another eight-cable machine that hangs taut.

    Parameters
    ----------
    generator
        Source of the draw.
    """
    for _ in range(ATTEMPTS):
        rig = _draw(generator)
        if rig is not None:
            return rig
    raise RuntimeError(f"no machine of {ATTEMPTS} hangs taut")


def with_pretension(rig: Rig, factor: float) -> Rig | None:
    """The same machine, its inner tensions by a factor; None where a cable would hang slack.

    Parameters
    ----------
    rig
        The machine.
    factor
        Of the part of the pretensions that carries no weight.
    """
    tension = np.array([cable.pretension_n.value for cable in rig.cable])
    structure = structure_matrix_at_rest(rig)
    carrying = np.linalg.pinv(structure) @ (structure @ tension)
    changed = tension + (factor - 1.0) * (tension - carrying)
    if changed.min() < 0.5 * tension.min():
        return None
    return _with_tension(rig, changed)


def _with_tension(rig: Rig, tension: Array) -> Rig:
    cables = tuple(
        cable.model_copy(
            update={"pretension_n": cable.pretension_n.model_copy(update={"value": float(value)})}
        )
        for cable, value in zip(rig.cable, np.round(tension, 6), strict=True)
    )
    return rig.model_copy(update={"cable": cables})


def _draw(generator: np.random.Generator) -> Rig | None:
    """One attempt: CDPR-8 stretched, its masses and stiffnesses anew."""
    rig = cdpr8()
    frame = np.exp(generator.uniform(-0.45, 0.35, 3))
    body = np.exp(generator.uniform(-0.35, 0.6, 3))
    mass = float(np.exp(generator.uniform(*np.log([0.4, 6.0]))))
    stiffness = float(np.exp(generator.uniform(*np.log([700.0, 5000.0]))))
    density = float(np.exp(generator.uniform(*np.log([2e-3, 1.5e-2]))))
    loss = float(np.exp(generator.uniform(*np.log([1.5, 8.0]))))
    cell = "platform" if generator.uniform() < 0.8 else "base"
    cables = []
    for cable in rig.cable:
        base = np.array(cable.base_m.value) * frame + 0.08 * generator.standard_normal(3)
        anchor = np.array(cable.anchor_m.value) * body + 0.01 * generator.standard_normal(3)
        stiff = stiffness * float(np.exp(0.15 * generator.standard_normal()))
        cables.append(
            cable.model_dump(mode="json")
            | {
                "base_m": np.round(base, 5).tolist(),
                "anchor_m": np.round(anchor, 5).tolist(),
                "stiffness_n_per_m": round(stiff, 1),
                "line_density_kg_per_m": round(density, 6),
                "damping_1_per_s": round(loss, 4),
                "cell": cell,
            }
        )
    square = (0.16 * body) ** 2
    box = mass / 3.0 * (square.sum() - square)
    inertia = box * np.exp(0.1 * generator.standard_normal(3))
    inertia[np.argmax(inertia)] = min(inertia.max(), 0.97 * np.sort(inertia)[:2].sum())
    platform = {"mass_kg": round(mass, 4), "inertia_kg_m2": np.round(inertia, 6).tolist()}
    raw = rig.model_dump(mode="json") | {
        "name": f"machine {generator.integers(100, 1000)}", "platform": platform, "cable": cables,
    }  # fmt: skip
    candidate = Rig.model_validate(raw)
    tension = _taut(candidate, float(generator.uniform(5.0, 12.0)))
    if tension is None:
        return None
    candidate = _with_tension(candidate, tension)
    tones = np.array(Machine.from_rig(candidate).softest_and_stiffest_rad_per_s) / (2.0 * np.pi)
    if tones[0] < SLOWEST_HZ or tones[1] > QUICKEST_HZ:
        return None
    try:
        return parse_rig(rig_text(candidate), "drawn", Path())
    except RigFileError:
        return None


def _taut(rig: Rig, least: float) -> Array | None:
    """Pretensions that carry the weight, none below `least` N, the largest as small as can be."""
    from scipy.optimize import linprog

    structure = structure_matrix_at_rest(rig)
    weight = np.array([0.0, 0.0, rig.platform.mass_kg.value * STANDARD_GRAVITY_M_PER_S2, 0, 0, 0])
    found = linprog(
        np.array([*np.full(8, 0.01), 1.0]),
        A_ub=np.hstack([np.eye(8), -np.ones((8, 1))]),
        b_ub=np.zeros(8),
        A_eq=np.hstack([structure, np.zeros((6, 1))]),
        b_eq=weight,
        bounds=[(least, 60.0)] * 8 + [(0.0, None)],
    )
    return np.asarray(found.x)[:8] if found.success else None
