"""Drawing cases: which machine, which runs, what is concealed and how strongly."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.plants import FIRST, Plant, plant_named

KINDS = ("single", "campaign")

STRENGTHS = ("limit", "typical", "strong")

TRIES = 40


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


def slots(
    count: int,
    generator: np.random.Generator,
    kinds: Sequence[str] = KINDS,
    plant: Plant | None = None,
) -> list[Slot]:
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
    plant
        Whose effects; default: the first.
    """
    deck = _Deck(plant_named(FIRST) if plant is None else plant, generator)
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

    def __init__(self, plant: Plant, generator: np.random.Generator) -> None:
        self._names, self._clashes = sorted(plant.catalogue()), plant.clashes
        self._generator = generator
        self._left: list[str] = []

    def take(self, count: int) -> tuple[str, ...]:
        """The next names, none of them clashing."""
        taken: list[str] = []
        while len(taken) < count:
            if not any(self._fits(name, taken) for name in self._left):
                self._left += [str(name) for name in self._generator.permutation(self._names)]
            name = next(name for name in self._left if self._fits(name, taken))
            self._left.remove(name)
            taken.append(name)
        return tuple(taken)

    def _fits(self, name: str, taken: Sequence[str]) -> bool:
        return name not in taken and not any(
            {name, other} <= clash for clash in self._clashes for other in taken
        )


def draw_case(slot: Slot, seed: np.random.SeedSequence, plant: Plant | None = None) -> Case:
    """A case of sound runs with its effects at their usual size.

    Parameters
    ----------
    slot
        What it is to be.
    seed
        All its randomness.
    plant
        Which makes it; default: the first.
    """
    if plant is None:
        plant = plant_named(FIRST)
    draws, noise = seed.spawn(2)
    generator = np.random.default_rng(draws)
    for _ in range(TRIES):
        rigs, sensing, offset = plant.planned(slot.kind, slot.effects, generator)
        runs = tuple(
            PlannedRun(rig, child) for rig, child in zip(rigs, noise.spawn(len(rigs)), strict=True)
        )
        if all(plant.sound(rig, offset) for rig in rigs):
            concealed = [plant.placed(name, rigs[0], offset, generator) for name in slot.effects]
            return Case(slot.name, slot.kind, runs, sensing, offset, tuple(concealed), plant)
    raise RuntimeError(f"{slot.name}: no machine of {TRIES} swings without a slack cable")
