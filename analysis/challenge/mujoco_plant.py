"""The first plant, which MuJoCo moves, as the challenge takes it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.excitations import campaign, single
from analysis.challenge.plant.concealed import Concealed, Effect, Parts, catalogue
from analysis.challenge.plant.friction import BRISTLE_LOSS_S
from analysis.challenge.plant.machine import Machine, Offset
from analysis.challenge.plant.plant import FINE_STEP_S, NOTHING, STEP_S, Course, simulate
from analysis.challenge.plant.record import Measured, Sensing, measure, write
from analysis.challenge.plant.sensors import Faults
from analysis.challenge.rigs import cdpr8, drawn_machine
from analysis.challenge.truth import drawn_offset
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

CLASHES = (
    {"pulley_coulomb", "pulley_stribeck", "pulley_presliding"},
    {"cell_saturation", "cell_swapped"},
)
"""Effects of one slot of the plant, or that would hide each other: never both in one case."""

OTHER_MACHINES = 0.35
"""Share of cases on machines other than CDPR-8."""

SLACK_BELOW_N = 0.5
SWING = 2.0
"""A machine whose tensions vary by this much more than its cables' stretch asks is in resonance."""

LOOK_STEP_S = 5e-4

STEPS_S = (1e-3, 5e-4, 2.5e-4)
"""Of the integration: sensitivities are differences of equal steps, the longest that is stable."""

STABLE = 2.5
"""Limit of (w h)^2 + 2 c h for friction that sticks; 4 where nothing else were there."""

STRONGEST = 4.0
STIFFEST_RIVAL_N_PER_M = 6e3
"""Of the bristles of a rival at its usual size."""

REMARK = """\
Runs were made by an independent plant: MuJoCo moves the platform, and cables, friction, frame,
drive, cells and camera follow laws of its own, most of which the fitting library does not hold
(ideal sliders for hysteresis, catenaries for sag, ladders of dashpots for structural loss, several
vibration modes in two planes). Friction is a bristle in both, and a hook with play a damped slider,
written and integrated apart: there the library's form is the plant's, and since decision 0062
nearly in relaxation (both two branches, of other shares). Every true machine is off its rig file by
what the file's sigmas allow. Diagnosis saw the runs alone; the truth was sealed before.
"""


@dataclass(frozen=True)
class MuJoCo:
    """The first plant; see `analysis.challenge.plants.Plant` for what each door promises."""

    name: str = "mujoco"
    step_s: float = STEP_S
    fine_step_s: float = FINE_STEP_S
    look_step_s: float = LOOK_STEP_S
    steps_s: tuple[float, ...] = STEPS_S
    clashes: tuple[frozenset[str], ...] = tuple(frozenset(one) for one in CLASHES)
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
        rig = drawn_machine(generator) if generator.uniform() < OTHER_MACHINES else cdpr8()
        runs = [(rig, single(generator))] if kind == "single" else campaign(rig, generator)
        offset = drawn_offset(rig, generator)
        ready = [one.model_copy(update={"excitation": excitation}) for one, excitation in runs]
        return ready, Sensing.drawn(generator), offset

    def sound(self, rig: Rig, offset: Offset) -> bool:
        """Whether the true machine, nothing concealed, moves with every cable taut, in no tone."""
        course = simulate(rig, rig.excitation, offset, step_s=LOOK_STEP_S)
        machine = Machine.from_rig(rig)
        reach = np.deg2rad(rig.excitation.amplitude_deg) * np.linalg.norm(machine.anchor, axis=1)
        swing = np.abs(course.tension_n - course.tension_n[0]).max(axis=0)
        expected = machine.stiffness * reach + 1.0
        taut = course.tension_n.min() > max(SLACK_BELOW_N, 0.1 * machine.pretension.min())
        return bool(taut and np.all(swing < SWING * expected))

    def placed(
        self, name: str, rig: Rig, offset: Offset, generator: np.random.Generator
    ) -> Concealed:
        """An effect at its usual size, on some of the cables, with its further numbers."""
        effect = catalogue()[name]
        details = dict(effect.draw(generator))
        order = (1 + generator.permutation(8)).tolist()
        some = int(generator.choice([1, 2, 4, 8]))
        count = {"one": 1, "pair": 2, "all": 8, "none": 0, "some": some}[effect.cables]
        cables = tuple(sorted(int(cable) for cable in order[:count]))
        if effect.name == "cell_saturation":
            course = simulate(rig, rig.excitation, offset, step_s=LOOK_STEP_S)
            tension = course.tension_n[:, cables[0] - 1]
            details = {"rest_n": float(tension[0]), "top_n": float(tension.max())}
        size = effect.typical * float(np.exp(generator.uniform(-0.35, 0.35)))
        size = min(max(size, effect.least), effect.most)
        if effect.signed and generator.uniform() < 0.5:
            size = -size
        return Concealed(effect, size, cables, details)

    def rival(
        self, name: str, cables: Sequence[int], rig: Rig, generator: np.random.Generator
    ) -> Concealed:
        """An effect at its usual size, its further numbers in the middle of their range."""
        effect = catalogue()[name]
        details = dict(effect.draw(generator))
        if effect.name == "cell_saturation":
            tension = rig.cable[cables[0] - 1].pretension_n.value
            details = {"rest_n": tension, "top_n": tension + 2.0}
        taken = tuple(cables)
        if effect.cables == "one":
            taken = taken[:1]
        elif effect.cables == "pair":
            taken = taken[:2] if len(taken) > 1 else (*taken, taken[0] % 8 + 1)
        elif effect.cables == "none":
            taken = ()
        return Concealed(effect, effect.typical, taken, details)

    def numbers(self, one: Concealed, rig: Rig) -> Mapping[str, Array | float]:
        """What an effect changes in the machine's numbers, by the names of `Offset`."""
        return one.parts(Machine.from_rig(rig)).offset

    def told(self, one: Concealed, rig: Rig) -> dict[str, float]:
        """Its numbers as a diagnosis should report them."""
        return one.told(Machine.from_rig(rig))

    def longest_step_s(self, rig: Rig, concealed: Sequence[Concealed]) -> float:
        """The longest step at which friction of this case, four times as strong, sticks quietly."""
        machine = Machine.from_rig(rig)
        stiff = 0.0
        for one in concealed:
            if one.effect.size == "coulomb_n":
                stiff += STRONGEST * one.size / one.details["presliding_m"]
            elif one.effect.name == "pulley_capstan":
                pressed = one.size * machine.pretension.max()
                stiff += STRONGEST * pressed / one.details["presliding_m"]
        stiff = max(stiff, STIFFEST_RIVAL_N_PER_M)
        _, quickest = machine.softest_and_stiffest_rad_per_s
        square = quickest**2 * stiff / machine.stiffness.min()
        for step_s in STEPS_S:
            if square * step_s * (step_s + 2.0 * BRISTLE_LOSS_S) < STABLE:
                return step_s
        return STEPS_S[-1]

    def happened(
        self, rig: Rig, offset: Offset, concealed: Sequence[Concealed], step_s: float
    ) -> Course:
        """What the machine does in a run."""
        hidden = NOTHING
        for parts in _parts(rig, concealed):
            hidden = hidden.joined(parts.hidden)
            offset = offset.with_set(**parts.offset)
        return simulate(rig, rig.excitation, offset, hidden, step_s)

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
        faults = Faults()
        for parts in _parts(rig, concealed):
            faults = faults.joined(parts.faults)
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
        write(folder, title, rig_text, excitation, measured)


def _parts(rig: Rig, concealed: Sequence[Concealed]) -> list[Parts]:
    machine = Machine.from_rig(rig)
    return [one.parts(machine) for one in concealed]
