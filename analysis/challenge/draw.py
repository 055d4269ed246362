"""Drawing cases: which machine, which runs, what is concealed and how strongly."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.excitations import campaign, single
from analysis.challenge.plant.concealed import Concealed, Effect, catalogue
from analysis.challenge.plant.machine import Machine
from analysis.challenge.plant.plant import simulate
from analysis.challenge.plant.record import Sensing
from analysis.challenge.rigs import cdpr8, drawn_machine
from analysis.challenge.truth import drawn_offset
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

KINDS = ("single", "campaign")

STRENGTHS = ("limit", "typical", "strong")

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

TRIES = 40

LOOK_STEP_S = 5e-4
"""Of the integration where only the size of a swing matters, s."""


@dataclass(frozen=True)
class Slot:
    """What a case is to be.

    Parameters
    ----------
    number
        From 1.
    kind
        "single" or "campaign".
    effects
        Names of what it conceals.
    strengths
        Of each of them.
    """

    number: int
    kind: str
    effects: tuple[str, ...]
    strengths: tuple[str, ...]

    @property
    def name(self) -> str:
        """The folder's name."""
        return f"case_{self.number:04d}"


def slots(count: int, generator: np.random.Generator, kinds: Sequence[str] = KINDS) -> list[Slot]:
    """What each case is to be: every effect and strength about as often, in no order.

    Parameters
    ----------
    count
        Of cases, as many of each kind; a quarter of each hold nothing, half one effect, a quarter
        two.
    generator
        Source of the draw.
    kinds
        "single" runs, "campaign"s, or both.
    """
    deck = _Deck(sorted(catalogue()), generator)
    plan: list[tuple[str, int]] = []
    sizes = [count - count // len(kinds) * (len(kinds) - 1)]
    sizes += [count // len(kinds)] * (len(kinds) - 1)
    for kind, size in zip(kinds, sizes, strict=True):
        none, pairs = round(size / 4), round(size / 4)
        holds = [0] * none + [2] * pairs + [1] * (size - none - pairs)
        plan += [(kind, held) for held in holds]
    order = generator.permutation(len(plan))
    found = []
    for number, index in enumerate(order.tolist(), start=1):
        kind, held = plan[index]
        effects = deck.take(held)
        strengths = tuple(STRENGTHS[generator.integers(3)] for _ in effects)
        found.append(Slot(number, kind, effects, strengths))
    return found


class _Deck:
    """Names in random order, all of them before any comes again."""

    def __init__(self, names: Sequence[str], generator: np.random.Generator) -> None:
        self._names, self._generator = list(names), generator
        self._left: list[str] = []

    def take(self, count: int) -> tuple[str, ...]:
        """The next names, none of them clashing."""
        taken: list[str] = []
        while len(taken) < count:
            if not any(_fits(name, taken) for name in self._left):
                self._left += [str(name) for name in self._generator.permutation(self._names)]
            name = next(name for name in self._left if _fits(name, taken))
            self._left.remove(name)
            taken.append(name)
        return tuple(taken)


def _fits(name: str, taken: Sequence[str]) -> bool:
    return name not in taken and not any(
        {name, other} <= clash for clash in CLASHES for other in taken
    )


def draw_case(slot: Slot, seed: np.random.SeedSequence) -> Case:
    """A case of sound runs with its effects at their usual size.

    Parameters
    ----------
    slot
        What it is to be.
    seed
        All its randomness.
    """
    draws, noise = seed.spawn(2)
    generator = np.random.default_rng(draws)
    for _ in range(TRIES):
        rig = drawn_machine(generator) if generator.uniform() < OTHER_MACHINES else cdpr8()
        alone = slot.kind == "single"
        planned = [(rig, single(generator))] if alone else campaign(rig, generator)
        offset = drawn_offset(rig, generator)
        sensing = Sensing.drawn(generator)
        runs = tuple(
            PlannedRun(_ready(one, excitation), child)
            for (one, excitation), child in zip(planned, noise.spawn(len(planned)), strict=True)
        )
        case = Case(slot.name, slot.kind, runs, sensing, offset)
        if all(_sound(case, run) for run in runs):
            effects = catalogue()
            concealed = [_placed(effects[name], case, generator) for name in slot.effects]
            return case.with_concealed(*concealed)
    raise RuntimeError(f"{slot.name}: no machine of {TRIES} swings without a slack cable")


def _ready(rig: Rig, excitation: Excitation) -> Rig:
    return rig.model_copy(update={"excitation": excitation})


def _sound(case: Case, run: PlannedRun) -> bool:
    """Whether the true machine, nothing concealed, moves with every cable taut and in no tone."""
    course = simulate(run.rig, run.excitation, case.offset, step_s=LOOK_STEP_S)
    machine = Machine.from_rig(run.rig)
    reach = np.deg2rad(run.excitation.amplitude_deg) * np.linalg.norm(machine.anchor, axis=1)
    swing = np.abs(course.tension_n - course.tension_n[0]).max(axis=0)
    expected = machine.stiffness * reach + 1.0
    taut = course.tension_n.min() > max(SLACK_BELOW_N, 0.1 * machine.pretension.min())
    return bool(taut and np.all(swing < SWING * expected))


def _placed(effect: Effect, case: Case, generator: np.random.Generator) -> Concealed:
    """An effect at its usual size, on some of the cables, with its further numbers."""
    details = dict(effect.draw(generator))
    order = (1 + generator.permutation(8)).tolist()
    count = {"one": 1, "pair": 2, "all": 8, "none": 0, "some": int(generator.choice([1, 2, 4, 8]))}
    cables = tuple(sorted(int(cable) for cable in order[: count[effect.cables]]))
    if effect.name == "cell_saturation":
        run = case.runs[0]
        course = simulate(run.rig, run.excitation, case.offset, step_s=LOOK_STEP_S)
        tension = course.tension_n[:, cables[0] - 1]
        details = {"rest_n": float(tension[0]), "top_n": float(tension.max())}
    size = effect.typical * float(np.exp(generator.uniform(-0.35, 0.35)))
    size = min(max(size, effect.least), effect.most)
    if effect.signed and generator.uniform() < 0.5:
        size = -size
    return Concealed(effect, size, cables, details)
