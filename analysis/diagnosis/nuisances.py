"""What is free throughout: the rig file's numbers within their sigma, clocks and zeros."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.diagnosis.recording import Recording
from analysis.engine.system import Nuisance
from cdpr8.rigfile import Rig
from cdpr8.rigfile.schema import Cable

DRIVE_SHARE = 2e-3
"""How well the drive makes its amplitude."""

DRIVE_S = 2e-4
"""How well the drive keeps to its command in time."""

START_S = 2e-4
"""How well the start of the motion is known on the tension clock, where it was recorded."""

UNKNOWN_START_S = 0.02
"""And where it was found by correlation."""

LATENCY_S = 2.5e-4
"""How well the camera's stamps are on the tension clock."""

CLOCK_PPM = 30.0
"""Crystals: of the camera against the electronics, and of the drive."""

SAMPLE_S = 2e-4
"""How far off a cell's sampling instants may be: by a quarter of an amplifier's period."""

SEEN_TURN = 2e-4
"""Base points known better than this share of their distance are taken as they are."""

CELL_SHARE = 1e-3
"""Calibration of a force cell."""

CAMERA_SHARE = 1e-3
"""Calibration of the camera."""

CAMERA_AXIS_DEG = 0.1
"""How well the camera's pose to the platform's frame is known."""

TRIMMED = 1.0
"""Of a machine whose numbers are not the rig file's: by how much its pretensions may be those that
leave it at rest where the rig file has it, 1, or those of the rig file, 0."""

POSE_ZERO_M, POSE_ZERO_RAD = 3e-4, 1e-3
"""How well the plate's place on the platform is known."""

STRINGS = "string"
"""For the effect of a number of a cable that shows in its string alone."""

STRING_KEYS = {"density_share": "line_density_kg_per_m", "loss_share": "damping_1_per_s"}
"""In which rows of a cable a rig file has what `model.Strings` has shares of."""

EVERY = -1
"""For the number of a run: all of them."""


@dataclass(frozen=True)
class Meaning:
    """What a nuisance moves.

    Parameters
    ----------
    effect, parameter
        A number of the library's effect; "start" for the start of the motion, "pose_zero" for the
        plate's place, "sampling" for the instants at which a cell is read, "string" for a number
        of `model.Strings`.
    cable
        1 to 8, or 0.
    record
        The run it belongs to, or `EVERY`.
    axis
        For "pose_zero".
    """

    effect: str
    parameter: str = ""
    cable: int = 0
    record: int = EVERY
    axis: int = 0


def nuisances(recordings: Sequence[Recording]) -> tuple[tuple[Nuisance, ...], tuple[Meaning, ...]]:
    """The nuisances of runs of one machine, and what each moves."""
    found: list[tuple[Nuisance, Meaning]] = []
    rig = recordings[0].rig

    def add(effect: str, parameter: str, sigma: float, unit: str, cable: int = 0) -> None:
        if sigma > 0.0:
            term = f"{parameter}@{cable}" if cable else parameter
            found.append(
                (Nuisance(f"{effect} {term}", sigma, unit, effect, term),
                 Meaning(effect, parameter, cable))
            )  # fmt: skip

    for i, cable in enumerate(rig.cable, start=1):
        k = cable.stiffness_n_per_m
        add("stiffness", "stiffness_share", k.sigma / k.value, "1", i)
        add("cell_gain", "gain_share", CELL_SHARE, "1", i)
        found.append(
            (
                Nuisance(f"sampling instant@{i}", _sample_s(recordings, i), "s", loose=True),
                Meaning("sampling", cable=i),
            )
        )
        found += _of_string(cable, i)
        length = float(np.linalg.norm(cable.base_m.value))
        for axis in "xyz":
            # A far base point that is a little off turns its cable by too little to be seen.
            if cable.base_m.sigma > SEEN_TURN * length:
                add("geometry", f"base_{axis}_m", cable.base_m.sigma, "m", i)
            add("geometry", f"anchor_{axis}_m", cable.anchor_m.sigma, "m", i)
    mass = rig.platform.mass_kg
    add("mass", "mass_share", mass.sigma / mass.value, "1")
    for axis, share in zip(("roll", "pitch", "yaw"), inertia_shares(rig), strict=True):
        add("inertia", f"{axis}_share", share, "1")
    for axis in "xyz":
        add("centre_of_mass", f"centre_{axis}_m", rig.platform.centre_of_mass_m.sigma, "m")
    add("drive_amplitude", "amplitude_share", DRIVE_SHARE, "1")
    add("drive_phase", "late_s", DRIVE_S, "s")
    add("drive_frequency", "frequency_share", CLOCK_PPM * 1e-6, "1")
    if any(one.has_pose for one in recordings):
        add("camera_gain", "gain_share", CAMERA_SHARE, "1")
        add("camera_latency", "latency_s", LATENCY_S, "s")
        add("clock_drift", "drift_ppm", CLOCK_PPM, "ppm")
        for axis in ("roll", "pitch", "yaw"):
            add("camera_axis", f"axis_{axis}_deg", CAMERA_AXIS_DEG, "deg")
        for i in range(6):
            sigma = POSE_ZERO_M if i < 3 else POSE_ZERO_RAD
            unit = "m" if i < 3 else "rad"
            found.append((Nuisance(f"pose zero {i}", sigma, unit), Meaning("pose_zero", axis=i)))
    # What is off in every run of a machine is off once: it is the candidate's. Of several runs each
    # has a deviation of its own beside it.
    several = len(recordings) > 1
    if several:
        for i, cable in enumerate(rig.cable, start=1):
            add("pretension", "pretension_offset_n", cable.pretension_n.sigma, "N", i)
    for r, one in enumerate(recordings):
        found += _of_run(r, one, None if several else "pretension")
    found.append(
        (Nuisance("trim of the pretensions", TRIMMED, "1"), Meaning("pretension", "trimmed_share"))
    )
    columns = list(zip(*found, strict=True))
    return tuple(columns[0]), tuple(columns[1])


def _of_string(cable: Cable, number: int) -> Iterator[tuple[Nuisance, Meaning]]:
    """What a cable weighs and how fast its string dies away: it shows where strings vibrate."""
    for parameter, key in STRING_KEYS.items():
        row = getattr(cable, key)
        if row.sigma > 0.0 and row.value > 0.0:
            yield (
                Nuisance(f"{STRINGS} {parameter}@{number}", row.sigma / row.value, "1"),
                Meaning(STRINGS, parameter, number),
            )


def _of_run(
    number: int, recording: Recording, cause: str | None
) -> Iterator[tuple[Nuisance, Meaning]]:
    """When a run starts, and its pretensions; of a single run those are the cause's."""
    name = recording.run.name
    known = recording.run.start.motion_start_known
    sigma = START_S if known else UNKNOWN_START_S
    if recording.excitation.amplitude_deg > 0.0:
        yield (
            Nuisance(f"start of {name}", sigma, "s", record=name),
            Meaning("start", record=number),
        )
    for i, cable in enumerate(recording.rig.cable, start=1):
        row = cable.pretension_n
        if row.sigma > 0.0:
            term = f"pretension_offset_n@{i}" if cause else None
            yield (
                Nuisance(f"pretension of {name}@{i}", row.sigma, "N", cause, term, record=name),
                Meaning("pretension", "pretension_offset_n", i, number),
            )


def _sample_s(recordings: Sequence[Recording], cable: int) -> float:
    """How far off a cell's sampling instants may be, in the run where they may be most."""
    offsets = [
        offset_s
        for one in recordings
        for number, offset_s in zip(one.cables, one.offset_s, strict=True)
        if number == cable
    ]
    return float(np.hypot(SAMPLE_S, max(offsets, default=0.0)))


def inertia_shares(rig: Rig) -> tuple[float, float, float]:
    """Relative sigma of the three moments of inertia."""
    row = rig.platform.inertia_kg_m2
    value = np.asarray(row.value, dtype=float)
    principal = np.diag(value) if value.ndim == 2 else value
    roll, pitch, yaw = (row.sigma / float(one) for one in principal)
    return (roll, pitch, yaw)
