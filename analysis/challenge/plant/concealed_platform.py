"""Effects on the platform, in the machine's numbers and in the drive."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.concealed import Details, Effect, Parts, along, between
from analysis.challenge.plant.drive import DriveFault
from analysis.challenge.plant.machine import Machine
from analysis.challenge.plant.plant import Hidden

Array = NDArray[np.float64]

AIR_KG_PER_M3 = 1.2


def _damping(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    turning = size * details["turning_share"]
    return Parts(Hidden(platform={at.DRAG_LINEAR: size, at.DRAG_TURNING: turning}))


def _air(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    platform = {at.FACES + j: 0.5 * AIR_KG_PER_M3 * size for j in range(3)}
    return Parts(Hidden(platform=platform | {at.TURNING_AIR: size * details["turning_share"]}))


def _hose(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    platform = {
        at.HOSE: size,
        at.HOSE_TURNING: size * details["turning_share"],
        at.HOSE_LOSS: details["loss_s"],
        at.HOSE_HARDENING: 400.0,
    }
    return Parts(Hidden(platform=platform))


def _direction(details: Details) -> Array:
    """A unit vector from the details x, y, z."""
    vector = np.array([details["x"], details["y"], details["z"]])
    return np.asarray(vector / np.linalg.norm(vector))


def _anywhere(generator: np.random.Generator) -> dict[str, float]:
    return dict(zip("xyz", generator.standard_normal(3).tolist(), strict=True))


def _stiffness(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(offset={"stiffness_share": size * mask})


def _pretension(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(offset={"pretension_n": size * mask})


def _mass(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(offset={"mass_share": size})


def _inertia(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    # Two axes gain what a rod along the third would bring: any such body can be.
    axis = int(details["axis"])
    gain = np.array([0.0 if j == axis else 1.0 for j in range(3)])
    return Parts(offset={"inertia_kg_m2": size * gain * machine.inertia[1, 1]})


def _inertia_told(size: float, details: Details, machine: Machine) -> dict[str, float]:
    gain = np.diag(
        _inertia(size, np.zeros(8), details, machine).offset["inertia_kg_m2"] * np.eye(3)
    )
    shares = gain / np.diag(machine.inertia)
    return dict(zip(("roll_share", "pitch_share", "yaw_share"), shares.tolist(), strict=True))


def _rod(generator: np.random.Generator) -> dict[str, float]:
    return {"axis": float(generator.choice([0, 2]))}


def _centre(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(offset={"centre_m": size * _direction(details)})


def _geometry(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(offset={"base_m": size * mask[:, None] * _direction(details)})


def _drive_amplitude(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(Hidden(drive=DriveFault(amplitude_share=size)))


def _drive_frequency(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(Hidden(drive=DriveFault(frequency_share=size)))


def _drive_phase(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(Hidden(drive=DriveFault(late_s=size)))


def _drive_harmonic(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    fault = DriveFault(
        harmonic_share=size,
        harmonic_order=int(details["order"]),
        harmonic_phase_rad=details["harmonic_phase_rad"],
    )
    return Parts(Hidden(drive=fault))


def _line(generator: np.random.Generator) -> dict[str, float]:
    phase = float(generator.uniform(-np.pi, np.pi))
    return {"order": float(generator.integers(2, 5)), "harmonic_phase_rad": phase}


def _backlash(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return Parts(Hidden(drive=DriveFault(backlash_rad=float(np.deg2rad(size)))))


PLATFORM_EFFECTS = (
    Effect(
        "platform_damping",
        "plant",
        "linear_n_s_per_m",
        "N s/m",
        1.5,
        40.0,
        _damping,
        "none",
        between(turning_share=(0.01, 0.04)),
        straight=True,
    ),
    Effect(
        "air_drag",
        "plant",
        "drag_area_m2",
        "m2",
        0.1,
        1.0,
        _air,
        "none",
        between(turning_share=(0.02, 0.08)),
    ),
    Effect(
        "umbilical",
        "plant",
        "spring_n_per_m",
        "N/m",
        30.0,
        400.0,
        _hose,
        "none",
        between(turning_share=(0.005, 0.02), loss_s=(2e-3, 0.02)),
        straight=True,
    ),
    Effect(
        "stiffness",
        "parameter",
        "stiffness_share",
        "1",
        0.10,
        0.3,
        _stiffness,
        "some",
        signed=True,
        least=0.08,
        straight=True,
    ),
    Effect(
        "pretension",
        "parameter",
        "pretension_offset_n",
        "N",
        0.8,
        3.0,
        _pretension,
        "some",
        signed=True,
        least=0.4,
        straight=True,
    ),
    Effect(
        "mass",
        "parameter",
        "mass_share",
        "1",
        0.06,
        0.3,
        _mass,
        signed=True,
        least=0.04,
        straight=True,
    ),
    Effect(
        "inertia",
        "parameter",
        "inertia_share",
        "1",
        0.4,
        0.8,
        _inertia,
        "none",
        _rod,
        least=0.36,
        told=_inertia_told,
        straight=True,
    ),
    Effect(
        "centre_of_mass",
        "parameter",
        "centre_m",
        "m",
        6e-3,
        0.02,
        _centre,
        "none",
        _anywhere,
        least=4e-3,
        told=along("centre_x_m", "centre_y_m", "centre_z_m"),
        straight=True,
    ),
    Effect(
        "geometry",
        "parameter",
        "base_m",
        "m",
        8e-3,
        0.05,
        _geometry,
        "some",
        _anywhere,
        least=4e-3,
        told=along("base_x_m", "base_y_m", "base_z_m"),
        straight=True,
    ),
    Effect(
        "drive_amplitude", "drive", "amplitude_share", "1", 0.03, 0.2, _drive_amplitude, signed=True
    ),
    Effect(
        "drive_frequency",
        "drive",
        "frequency_share",
        "1",
        2e-3,
        0.03,
        _drive_frequency,
        signed=True,
        sound=30e-6,
    ),
    Effect("drive_phase", "drive", "late_s", "s", 8e-3, 0.08, _drive_phase),
    Effect(
        "drive_harmonic", "drive", "harmonic_share", "1", 0.02, 0.12, _drive_harmonic, "none", _line
    ),
    Effect("drive_backlash", "drive", "backlash_deg", "deg", 0.04, 0.3, _backlash),
)
