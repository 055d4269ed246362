"""What could be recorded next, and what each of it is expected to tell of which rival it is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from threadpoolctl import threadpool_limits

from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.menu import Experiment, experiments
from analysis.diagnosis.telling import Rival, Telling, information_bits
from analysis.engine.array import Array
from analysis.engine.cause import Cause
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.fitted import Fitted
from analysis.engine.judge import Judgement

ENOUGH = float(np.log(20.0))
"""Expected log odds from which two rivals count as told apart."""

MOST_RIVALS = 4

IN_EARNEST = 3
"""Experiments that are looked at with everything uncertain, for the next one."""

NOTHING = "nothing left out"

Tell = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Outlook:
    """One experiment and what it is expected to tell.

    Attributes
    ----------
    experiment
        The experiment.
    log_odds
        Expected, between any two rivals, shape (r, r).
    bits
        Expected information on which rival it is.
    """

    experiment: Experiment
    log_odds: Array
    bits: float

    @property
    def bits_per_minute(self) -> float:
        """Of rig time."""
        return self.bits / self.experiment.minutes


class Survey:
    """Rivals, and what could be recorded to tell them apart.

    Parameters
    ----------
    machine, diagnosis
        The runs and what was found.
    rivals
        What is to be told apart.
    workers
        Processes.
    tell
        Told of progress.
    """

    def __init__(
        self,
        machine: RecordedMachine,
        diagnosis: Diagnosis,
        rivals: tuple[Rival, ...],
        workers: int = 2,
        tell: Tell | None = None,
    ) -> None:
        self.rivals = rivals
        self.weights = np.array([one.probability for one in rivals])
        effects = sorted({name for one in rivals for name in one.fitted.hypothesis.names})
        asked = experiments(machine.recordings, effects)
        promising = []
        for i, experiment in enumerate(asked):
            with threadpool_limits(1):
                seen = Telling(machine, diagnosis.calibrated.rotation, rivals, experiment, workers)
            bits = information_bits(seen.at_most(), self.weights)
            promising.append((-bits / experiment.minutes, i, experiment, seen))
            if tell is not None:
                tell("simulating what could be recorded next", i + 1, len(asked))
        self._left = sorted(promising, key=lambda one: one[:2])
        self._outlooks: list[Outlook] = []

    @cached_property
    def best(self) -> Outlook | None:
        """Of the most promising, what tells the first rival from another; None: none does."""
        found = self.outlooks(IN_EARNEST)
        return next((one for one in found if one.log_odds[0, 1:].max() > ENOUGH), None)

    def outlooks(self, count: int) -> list[Outlook]:
        """The most promising with everything uncertain, the most telling a minute first."""
        while self._left and len(self._outlooks) < count:
            _, _, experiment, seen = self._left.pop(0)
            with threadpool_limits(1):
                log_odds = seen.log_odds()
            bits = information_bits(log_odds, self.weights)
            self._outlooks.append(Outlook(experiment, log_odds, bits))
        return sorted(self._outlooks, key=lambda one: -one.bits_per_minute)


def survey(
    machine: RecordedMachine, diagnosis: Diagnosis, workers: int = 2, tell: Tell | None = None
) -> Survey | None:
    """Look at what could be recorded next; None: there are no two explanations to tell apart.

    Parameters
    ----------
    machine, diagnosis
        The runs and what was found.
    workers
        Processes.
    tell
        Told of progress.
    """
    rivals = _rivals(diagnosis)
    return Survey(machine, diagnosis, rivals, workers, tell) if len(rivals) > 1 else None


def _rivals(diagnosis: Diagnosis) -> tuple[Rival, ...]:
    """Explanations to tell apart: of the least sure cause; where all are sure, the runners-up."""
    judgement, search = diagnosis.judgement, diagnosis.search
    if judgement is None or search is None or not judgement.causes:
        return ()
    found: list[tuple[str, float, Fitted]] = []
    if judgement.verdict == "ambiguous":
        cause = min(judgement.causes, key=lambda one: one.probability)
        head = _head(cause, judgement, search.fitted)
        found = [(cause.name, cause.probability, head)]
        found += [(one.name, one.probability, one.fitted) for one in cause.rivals]
        others = set(judgement.chosen.hypothesis.names) - set(cause.names)
        without = [one for one in search.fitted if set(one.hypothesis.names) == others]
        if without and 1.0 - cause.present > 0.1:
            found.append((NOTHING, 1.0 - cause.present, without[0]))
    else:
        for fitted in search.fitted:
            name = " and ".join(fitted.hypothesis.names) or NOTHING
            if name not in [one[0] for one in found]:
                found.append((name, 1.0, fitted))
    found = sorted(found, key=lambda one: -one[1])[:MOST_RIVALS]
    total = sum(one[1] for one in found)
    return tuple(Rival(name, probability / total, fitted) for name, probability, fitted in found)


def _head(cause: Cause, judgement: Judgement, fitted: Sequence[Fitted]) -> Fitted:
    """The cause's own best fit: the chosen hypothesis, or the best that has it in its place."""
    if cause.name in judgement.chosen.hypothesis.names:
        return judgement.chosen
    ours = set(judgement.chosen.hypothesis.names)
    near = [
        one for one in fitted
        if cause.name in one.hypothesis.names and len(set(one.hypothesis.names) - ours) == 1
    ]  # fmt: skip
    return near[0] if near else judgement.chosen
