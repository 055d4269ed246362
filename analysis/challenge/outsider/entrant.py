"""The outsider's plant as the challenge takes it: by these doors and no others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import cases
from analysis.challenge.outsider.camera import CameraFault
from analysis.challenge.outsider.cells import CellFault
from analysis.challenge.outsider.concealed import Concealed, Effect, Parts, Scene, catalogue
from analysis.challenge.outsider.machine import Machine, Offset
from analysis.challenge.outsider.plant import NOTHING, STEP_S, Course, rest_wrench, simulate
from analysis.challenge.outsider.record import Faults, Measured, Sensing, measure, write
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

STEPS_S = (1e-3, 5e-4, 2.5e-4, 1.25e-4, 1e-4, STEP_S)

STABLE = 2.5
"""Runge-Kutta's fourth order is stable to 2.78 for decay, and to 2.83 for ringing."""

SHARPEST = {"presliding_m": 20e-6, "static_ratio": 1.9}
"""Bristles of a usual Stribeck friction."""

FRICTION = {"pulley_coulomb", "pulley_capstan", "pulley_stribeck", "pulley_presliding"}
ONE_LAW = {
    "cable_structural", "cable_relaxation", "cable_hysteresis", "cable_stiffening",
    "pulley_inertia", "anchor_play",
}  # fmt: skip
DRIVE = {
    "drive_amplitude", "drive_frequency", "drive_phase", "drive_harmonic", "drive_backlash"
}  # fmt: skip

REMARK = """\
Runs were made by the outsider, a second plant of the challenge, written from the design
and the run folder's page alone by somebody who had read none of the models: quaternions and
Newton-Euler by Runge-Kutta at 50 us, strings with up to three modes in two planes, LuGre bristles,
Bouc-Wen loops or Iwan sliders for hysteresis, Maxwell ladders, an exponential law of stiffening, a
reversible clearance, posts for a frame, cells, camera and rigs of its own. Friction is a bristle
here and in the fitting library, written and integrated apart; the library's ladder of branches can
be this one's since decision 0054, and its relaxation nearly (both two branches, of other shares)
since 0062. Every true machine is off its rig file by what the file's sigmas allow, in balance at
rest. Diagnosis saw the runs alone; the truth was sealed before.
"""


@dataclass(frozen=True)
class Outsider:
    """The second plant; see `analysis.challenge.plants.Plant` for what each door promises."""

    name: str = "outsider"
    step_s: float = STEP_S
    fine_step_s: float = STEP_S
    look_step_s: float = cases.LOOK_STEP_S
    steps_s: tuple[float, ...] = STEPS_S
    clashes: tuple[frozenset[str], ...] = tuple(
        frozenset({one, other})
        for group in (FRICTION | {"pulley_inertia"}, ONE_LAW, DRIVE)
        for one in group
        for other in group
        if one < other
    )
    remark: str = REMARK

    def catalogue(self) -> Mapping[str, Effect]:
        """Every effect that can be concealed, by name."""
        return catalogue()

    def concealed(
        self, name: str, size: float, cables: tuple[int, ...], details: Mapping[str, float]
    ) -> Concealed:
        """An effect of a size."""
        return Concealed(catalogue()[name], size, cables, details)

    def planned(
        self, kind: str, effects: Sequence[str], generator: np.random.Generator
    ) -> tuple[list[Rig], Sensing, Offset]:
        """Rig file of each run, how it is measured, the true machine."""
        return cases.planned(kind, effects, generator)

    def sound(self, rig: Rig, offset: Offset) -> bool:
        """Whether the true machine, nothing concealed, holds together; its rigs were drawn taut."""
        course = simulate(rig, offset, step_s=self.look_step_s)
        return bool(np.isfinite(course.tension_n).all())

    def placed(
        self, name: str, rig: Rig, offset: Offset, generator: np.random.Generator
    ) -> Concealed:
        """An effect at its usual size."""
        return cases.placed(name, rig, offset, generator)

    def rival(
        self, name: str, cables: Sequence[int], rig: Rig, generator: np.random.Generator
    ) -> Concealed:
        """An effect at its usual size, on the cables of another."""
        return cases.rival(catalogue()[name], cables, rig, generator)

    def numbers(self, one: Concealed, rig: Rig) -> Mapping[str, Array | float]:
        """What an effect changes in the machine's numbers, by the names of `Offset`."""
        nominal = Machine.from_rig(rig)
        return one.parts(Scene(nominal, nominal, rig.excitation)).offset

    def told(self, one: Concealed, rig: Rig) -> dict[str, float]:
        """Its numbers as a diagnosis should report them."""
        return one.told()

    def longest_step_s(self, rig: Rig, concealed: Sequence[Concealed]) -> float:
        """The longest step by which bristles can be integrated as this machine moves.

        They relax at |v| / length, whatever their strength. Those of a rival are always thought of:
        what it would look like is tried too.
        """
        excitation, machine = rig.excitation, Machine.from_rig(rig)
        reach_m = (
            np.radians(excitation.amplitude_deg) * np.linalg.norm(machine.anchor, axis=1).max()
        )
        speed = float(2.0 * np.pi * excitation.frequency_hz * reach_m)
        softest = min(_bristle_of(one) for one in (SHARPEST, *(one.details for one in concealed)))
        quickest = speed / softest
        return next((step for step in self.steps_s if quickest * step < STABLE), self.steps_s[-1])

    def happened(
        self, rig: Rig, offset: Offset, concealed: Sequence[Concealed], step_s: float
    ) -> Course:
        """What the machine does in a run."""
        parts = _parts(rig, offset, concealed)
        hidden = NOTHING
        for one in parts:
            hidden = hidden.joined(one.hidden)
        return simulate(rig, _with_numbers(offset, parts), hidden, step_s)

    def recorded(
        self,
        rig: Rig,
        offset: Offset,
        concealed: Sequence[Concealed],
        course: Course,
        sensing: Sensing,
        seed: np.random.SeedSequence,
        *,
        noise: bool,
    ) -> Measured:
        """What cells and camera make of it."""
        cell: dict[str, Any] = {}
        camera: dict[str, Any] = {}
        for one in _parts(rig, offset, concealed):
            cell |= _set(one.faults.cell)
            camera |= _set(one.faults.camera)
        faults = Faults(CellFault(**cell), CameraFault(**camera))
        return measure(course, sensing, faults, seed, noise=noise)

    def write(
        self,
        folder: Path,
        title: str,
        rig_text: str,
        excitation: Excitation,
        sensing: Sensing,
        measured: Measured,
    ) -> None:
        """Write a run folder."""
        write(folder, title, rig_text, excitation, sensing, measured)


def _bristle_of(details: Mapping[str, float]) -> float:
    """Sliding force over stiffness of the bristles that these numbers ask for, m."""
    return details.get("presliding_m", np.inf) / details.get("static_ratio", 1.0)


def _parts(rig: Rig, offset: Offset, concealed: Sequence[Concealed]) -> list[Parts]:
    """What each effect does to the machine that has the numbers concealed in it."""
    nominal = Machine.from_rig(rig)
    drive = rest_wrench(nominal, rig.excitation)
    bare = Scene(nominal, offset.applied(nominal, drive), rig.excitation)
    moved = _with_numbers(offset, [one.parts(bare) for one in concealed])
    scene = Scene(nominal, moved.applied(nominal, drive), rig.excitation)
    return [one.parts(scene) for one in concealed]


def _with_numbers(offset: Offset, parts: Sequence[Parts]) -> Offset:
    for one in parts:
        offset = offset.with_set(one.offset)
    return offset


def _set(fault: object) -> dict[str, Any]:
    """What a fault sets, by name."""
    sound = vars(type(fault)())
    return {k: v for k, v in vars(fault).items() if not np.array_equal(v, sound[k])}
