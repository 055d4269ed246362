"""Machines that the outsider drives: CDPR-8 and others of its kind, each taut and off resonance."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.drive import AXES
from analysis.challenge.outsider.machine import Machine, Offset, rotations
from analysis.challenge.outsider.plant import rest_wrench
from cdpr8.rigfile import Excitation, Rig, load_rig, packaged_rig_path

Array = NDArray[np.float64]

ATTEMPTS = 4000

DRAWN_TENSION_N = (5.0, 42.0)
SWUNG_TENSION_N = (2.5, 48.0)
"""Of a drawn machine at rest and in motion: taut, and within a cell of 50 N."""

SLOWEST_HZ = 2.2
RESONANCES = ((1, 0.22), (2, 0.08), (3, 0.05))
"""No tone of a drawn machine is nearer to these harmonics of its drive, relative."""

CLIP = 1.6
"""No number of a true machine is off by more sigmas than this."""

POINT_SHARE = 0.7
PRETENSION_SHARE = 0.6
"""Anchors and centre, and pretensions, are off by this much of what the rig file allows."""

BALANCED_WITHIN = 1.9
"""The balance of a true machine must not move a pretension by more sigmas than this."""

TRIES = 400


def packaged() -> Rig:
    """The packaged CDPR-8, without a plate: its poses come tracked."""
    return load_rig(packaged_rig_path()).model_copy(update={"plate": None})


def swung(machine: Machine, excitation: Excitation) -> Array:
    """Tensions at 21 angles of the motion, shape (21, 8), N: no dynamics."""
    reach = np.radians(excitation.amplitude_deg)
    turn = rotations(
        np.eye(3)[AXES.index(excitation.axis)], np.asarray(np.linspace(-reach, reach, 21))
    )
    arm = np.einsum("tij,cj->tci", turn, machine.anchor)
    length = np.linalg.norm(machine.base - arm, axis=2)
    return np.asarray(machine.pretension + machine.stiffness * (length - machine.lines[0]))


def tones_hz(machine: Machine) -> Array:
    """Tones of the platform on its cables, elastic and by their tension, shape (6,), Hz."""
    from scipy.linalg import eigh

    structure = machine.structure
    stiffness = (structure * machine.stiffness) @ structure.T
    length, direction = machine.lines
    for i in range(8):
        x, y, z = machine.anchor[i]
        skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        moved = np.hstack([np.eye(3), -skew])
        across = np.eye(3) - np.outer(direction[i], direction[i])
        stiffness += machine.pretension[i] / length[i] * moved.T @ across @ moved
    inertia = np.zeros((6, 6))
    inertia[:3, :3], inertia[3:, 3:] = machine.mass * np.eye(3), machine.inertia
    squares = eigh(stiffness, inertia, eigvals_only=True)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi))


def drawn(excitation: Excitation, generator: np.random.Generator) -> Rig:
    """Another eight-cable machine that hangs taut, moves taut, and is driven off its tones.

    Parameters
    ----------
    excitation
        What it will be asked to do.
    generator
        Source of the draw.
    """
    for _ in range(ATTEMPTS):
        machine = _attempt(generator)
        if _taut(machine, excitation) and _off_resonance(machine, excitation.frequency_hz):
            return _as_rig(machine, f"rig {generator.integers(100, 1000)}", excitation)
    raise RuntimeError(f"no machine of {ATTEMPTS} hangs and moves taut")


def _taut(machine: Machine, excitation: Excitation) -> bool:
    """At rest and in motion, and not too tight for its cells."""
    at_rest = _fits(machine.pretension, DRAWN_TENSION_N)
    return at_rest and _fits(swung(machine, excitation), SWUNG_TENSION_N)


def _off_resonance(machine: Machine, frequency_hz: float) -> bool:
    tones = tones_hz(machine)
    ratio = tones / frequency_hz
    near = any(np.abs(ratio / n - 1.0).min() < share for n, share in RESONANCES)
    return bool(tones[0] >= SLOWEST_HZ and not near)


def _fits(tension: Array, limits: tuple[float, float]) -> bool:
    return bool(tension.min() > limits[0] and tension.max() < limits[1])


def _attempt(generator: np.random.Generator) -> Machine:
    """Bases and anchors mirrored in one plane, stiffnesses of pairs, one tension all over."""
    base, anchor = _points(generator)
    mass = float(generator.uniform(0.7, 2.6))
    half_x, half_y = anchor[0, 0], anchor[0, 1]
    squares = np.array([half_y**2 + 0.04**2, half_x**2 + 0.04**2, half_x**2 + half_y**2])
    inertia = mass * squares * generator.uniform(0.6, 0.95)
    pairs = generator.uniform(1300.0, 4200.0, 4)[[0, 0, 1, 1, 2, 3, 3, 2]]
    density, loss = generator.uniform(0.004, 0.010), generator.uniform(2.5, 6.0)
    machine = Machine(
        mass=round(mass, 4),
        inertia=np.diag(np.round(inertia, 6)),
        centre=np.zeros(3),
        base=np.round(base, 4),
        anchor=np.round(anchor, 4),
        stiffness=np.round(pairs),
        pretension=np.full(8, generator.uniform(16.0, 30.0)),
        line_density=np.full(8, round(float(density), 6)),
        string_loss=np.full(8, round(float(loss), 3)),
    )
    return machine.balanced(np.zeros(6))


def _as_rig(machine: Machine, name: str, excitation: Excitation) -> Rig:
    """A rig of these numbers, its amplifiers, camera and the like as packaged."""
    raw = packaged().model_dump(mode="json")
    rows = {
        "base_m": machine.base.tolist(),
        "anchor_m": machine.anchor.tolist(),
        "stiffness_n_per_m": machine.stiffness.tolist(),
        "line_density_kg_per_m": machine.line_density.tolist(),
        "damping_1_per_s": machine.string_loss.tolist(),
        "pretension_n": machine.pretension.tolist(),
        "cell": ["platform"] * 8,
    }
    cables = [
        cable | {name: values[i] for name, values in rows.items()}
        for i, cable in enumerate(raw["cable"])
    ]
    inertia = np.diag(machine.inertia).tolist()
    platform = {"mass_kg": machine.mass, "inertia_kg_m2": inertia}
    rig = Rig.model_validate(raw | {"name": name, "platform": platform, "cable": cables})
    rig = rig.model_copy(update={"excitation": excitation})
    return with_pretension(rig, machine.pretension)


def _points(generator: np.random.Generator) -> tuple[Array, Array]:
    """Base points and anchors of a machine, shape (8, 3), m."""
    x1, x2 = generator.uniform(1.2, 2.2), generator.uniform(1.2, 2.6)
    y1, y2 = generator.uniform(1.1, 1.7, 2)
    up, down = generator.uniform(1.2, 2.0), -generator.uniform(1.2, 2.1)
    x3, x4 = generator.uniform(0.4, 2.2), generator.uniform(0.3, 2.0)
    base = [[x1, y1, up], [x1, -y1, up], [-x2, -y1, up], [-x2, y1, up]]
    base += [[x3, y2, down], [-x4, y2, down], [-x4, -y2, down], [x3, -y2, down]]
    ax, ay = generator.uniform(0.15, 0.25), generator.uniform(0.09, 0.17)
    low, high = generator.uniform(-0.09, 0.02), generator.uniform(-0.05, 0.08)
    anchor = [[ax, ay, low], [ax, -ay, low], [-ax, -ay, high], [-ax, ay, high]]
    anchor += [[ax, ay, high], [-ax, ay, low], [-ax, -ay, low], [ax, -ay, high]]
    return np.array(base), np.array(anchor)


def with_pretension(rig: Rig, tension: Array) -> Rig:
    """The same machine with other pretensions, shape (8,), N."""
    cables = tuple(
        cable.model_copy(
            update={"pretension_n": cable.pretension_n.model_copy(update={"value": float(value)})}
        )
        for cable, value in zip(rig.cable, np.round(tension, 6), strict=True)
    )
    return rig.model_copy(update={"cable": cables})


def inner_share(machine: Machine) -> Array:
    """How its tensions change where the machine is tightened, the largest by 1; shape (8,)."""
    inner = machine.inner
    share = inner @ (inner.T @ machine.pretension)
    return np.asarray(share / np.abs(share).max())


def drawn_offset(rig: Rig, generator: np.random.Generator) -> Offset:
    """A true machine less its rig file, by its sigmas, in balance where the rig file's is.

    Parameters
    ----------
    rig
        With its sigmas.
    generator
        Source of the draw.
    """
    nominal = Machine.from_rig(rig)
    drive = rest_wrench(nominal, rig.excitation)
    sigma = np.array([cable.pretension_n.sigma for cable in rig.cable])
    for attempt in range(TRIES):
        # Points far off need tensions far off: what does not balance is drawn closer.
        closer = 1.0 if attempt < 60 else 0.7 if attempt < 150 else 0.45
        offset = Offset(**_numbers(rig, closer, generator))
        change = offset.applied(nominal, drive).pretension - nominal.pretension
        if np.all(np.abs(change) < BALANCED_WITHIN * sigma) and _a_body(rig, offset):
            return replace(offset, pretension_n=change)
    raise RuntimeError(f"no true machine of {TRIES} is in balance")


def _numbers(rig: Rig, closer: float, generator: np.random.Generator) -> dict[str, Any]:
    def normal(*shape: int) -> Array:
        return np.clip(generator.standard_normal(shape), -CLIP, CLIP)

    def share(name: str) -> Array:
        rows = [getattr(cable, name) for cable in rig.cable]
        return np.array([row.sigma / row.value for row in rows]) * normal(8)

    def points(name: str) -> Array:
        rows = [getattr(cable, name) for cable in rig.cable]
        return closer * np.array([row.sigma for row in rows])[:, None] * normal(8, 3)

    platform = rig.platform
    tension = np.array([cable.pretension_n.sigma for cable in rig.cable])
    return {
        "mass_share": float(platform.mass_kg.sigma / platform.mass_kg.value * normal(1)[0]),
        "inertia_kg_m2": platform.inertia_kg_m2.sigma * normal(3),
        "centre_m": POINT_SHARE * closer * platform.centre_of_mass_m.sigma * normal(3),
        "stiffness_share": share("stiffness_n_per_m"),
        "density_share": share("line_density_kg_per_m"),
        "loss_share": share("damping_1_per_s"),
        "base_m": points("base_m"),
        "anchor_m": POINT_SHARE * points("anchor_m"),
        "pretension_n": PRETENSION_SHARE * tension * normal(8),
    }


def _a_body(rig: Rig, offset: Offset) -> bool:
    """Whether a body can have these moments of inertia."""
    before = np.diag(Machine.from_rig(rig).inertia)
    after = before + offset.inertia_kg_m2
    return bool(2.0 * after.max() < 0.999 * after.sum() and after.min() > 0.5 * before.min())
