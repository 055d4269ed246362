"""Effects on the platform, in the machine's numbers and in the drive."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.concealed import (
    Details,
    Effect,
    Parts,
    Scene,
    along,
    anywhere,
    between,
    direction,
    unsaid,
)
from analysis.challenge.outsider.drive import DriveFault
from analysis.challenge.outsider.plant import Hidden

Array = NDArray[np.float64]

AIR_KG_PER_M3 = 1.2
AIR_ARM_M = 0.15
"""Where the air takes hold, from the centre of mass."""


def _damping(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    turning = size * details["turning_share"]
    return Parts(Hidden(platform={at_.DAMPING: size, at_.TURNING_DAMPING: turning}))


def _air(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    drag = 0.5 * AIR_KG_PER_M3 * size
    return Parts(Hidden(platform={at_.DRAG: drag, at_.DRAG_ARM: AIR_ARM_M}))


def _hose(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    platform = {at_.HOSE: size, at_.HOSE_LOSS: size * details["loss_s"]}
    at = {at_.HOSE_AT + j: details[name] for j, name in enumerate(("x_m", "y_m", "z_m"))}
    return Parts(Hidden(platform=platform | at))


def _stiffness(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(offset={"stiffness_share": size * mask})


def _pretension(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Along tensions that leave the platform alone: a machine that was wrongly tightened."""
    inner = scene.nominal.inner @ np.array([details["first"], details["second"]])
    return Parts(offset={"pretension_n": size * inner / np.abs(inner).max()})


def _inwards(generator: np.random.Generator) -> dict[str, float]:
    first, second = generator.standard_normal(2).tolist()
    return {"first": first, "second": second}


def _mass(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(offset={"mass_share": size})


def _inertia(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """The whole tensor, scaled."""
    return Parts(offset={"inertia_kg_m2": size * np.diag(scene.nominal.inertia)})


def _inertia_told(size: float, mask: Array, details: Details) -> dict[str, float]:
    return dict.fromkeys(("roll_share", "pitch_share", "yaw_share"), size)


def _centre(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(offset={"centre_m": size * direction(details)})


def _fore_or_up(generator: np.random.Generator) -> dict[str, float]:
    fore = float(generator.integers(2))
    return {"x": fore, "y": 0.0, "z": 1.0 - fore}


def _geometry(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """An anchor that is elsewhere."""
    return Parts(offset={"anchor_m": size * mask[:, None] * direction(details)})


def _amplitude(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(Hidden(drive=DriveFault(amplitude_share=size)))


def _frequency(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(Hidden(drive=DriveFault(frequency_share=size)))


def _phase(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(Hidden(drive=DriveFault(late_s=size)))


def _harmonic(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    fault = DriveFault(
        harmonic_share=size,
        harmonic_order=int(details["order"]),
        harmonic_phase_rad=details["harmonic_phase_rad"],
    )
    return Parts(Hidden(drive=fault))


def _line(generator: np.random.Generator) -> dict[str, float]:
    phase = float(generator.uniform(0.0, 2.0 * np.pi))
    return {"order": float(generator.integers(2, 4)), "harmonic_phase_rad": phase}


def _backlash(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Size: half the clearance, as the fitting library has it."""
    return Parts(Hidden(drive=DriveFault(play_rad=2.0 * float(np.radians(size)))))


PLATFORM_EFFECTS = (
    Effect(
        "platform_damping", "plant", "linear_n_s_per_m", "N s/m", 2.2, 12.0, _damping,
        draw=between(turning_share=(0.01, 0.04)), straight=True,
    ),
    Effect("air_drag", "plant", "drag_area_m2", "m2", 0.3, 1.5, _air),
    Effect(
        "umbilical", "plant", "spring_n_per_m", "N/m", 120.0, 600.0, _hose,
        draw=between(loss_s=(2e-3, 0.01), x_m=(-0.15, -0.05), y_m=(-0.05, 0.05), z_m=(0.03, 0.12)),
        straight=True,
    ),
    Effect(
        "stiffness", "parameter", "stiffness_share", "1", 0.16, 0.4, _stiffness,
        {"one": 0.5, "pair": 0.5}, signed=True, least=0.08, straight=True,
    ),
    Effect(
        "pretension", "parameter", "pretension_offset_n", "N", 1.5, 4.0, _pretension,
        {"all": 1.0}, _inwards, signed=True, told=unsaid, least=0.4, straight=True,
    ),
    Effect(
        "mass", "parameter", "mass_share", "1", 0.18, 0.4, _mass, least=0.04, straight=True
    ),
    Effect(
        "inertia", "parameter", "inertia_share", "1", 0.5, 0.9, _inertia, told=_inertia_told,
        least=0.3, straight=True,
    ),
    Effect(
        "centre_of_mass", "parameter", "centre_m", "m", 0.014, 0.03, _centre, draw=_fore_or_up,
        signed=True, told=along("centre_x_m", "centre_y_m", "centre_z_m"), least=4e-3,
        straight=True,
    ),
    Effect(
        "geometry", "parameter", "anchor_m", "m", 0.011, 0.03, _geometry, {"one": 1.0}, anywhere,
        told=along("anchor_x_m", "anchor_y_m", "anchor_z_m"), least=4e-3, straight=True,
    ),
    Effect("drive_amplitude", "drive", "amplitude_share", "1", 0.05, 0.2, _amplitude, signed=True),
    Effect(
        "drive_frequency", "drive", "frequency_share", "1", 5e-3, 0.03, _frequency, signed=True,
        sound=30e-6,
    ),
    Effect("drive_phase", "drive", "late_s", "s", 0.012, 0.08, _phase),
    Effect("drive_harmonic", "drive", "harmonic_share", "1", 0.028, 0.12, _harmonic, draw=_line),
    Effect("drive_backlash", "drive", "backlash_deg", "deg", 0.07, 0.3, _backlash),
)  # fmt: skip
