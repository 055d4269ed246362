"""The next experiment: which of those that can be recorded tells the rivals apart, a minute of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.measurements import Measurement, measurement
from analysis.diagnosis.menu import Experiment, experiments, write_rig
from analysis.diagnosis.telling import Rival, Telling, information_bits
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.judge import Cause, Judgement
from analysis.engine.refine import Fitted
from analysis.engine.system import Array

ENOUGH = float(np.log(20.0))
"""Expected log odds from which two rivals count as told apart."""

MOST_RIVALS = 4

IN_EARNEST, CAMPAIGN = 3, 5
"""Experiments that are looked at with everything uncertain: for the next one, for a campaign."""

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
        Threads.
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
        Threads.
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


def next_experiment(
    machine: RecordedMachine,
    diagnosis: Diagnosis,
    looked: Survey | None,
    results: Path | None = None,
) -> dict[str, Any] | None:
    """What to do next, for the JSON of design, section 6.

    Parameters
    ----------
    machine, diagnosis
        The runs and what was found.
    looked
        What could be recorded; None: it was not looked at.
    results
        Folder that takes `next_1.toml`; None: nothing is written.

    Returns
    -------
    dict or None
        `what` (a sentence), `separates`, `excitation`, `expected_log_odds` (of the two named,
        natural logarithm), `bits`, `minutes`, `command`; without an excitation where a measurement
        does it that no motion does. None: nothing is to be told apart.
    """
    judgement = diagnosis.judgement
    if judgement is None or judgement.verdict == "none":
        return None
    if judgement.verdict != "ambiguous" or looked is None:
        return _check(judgement)
    names = [one.name for one in looked.rivals]
    outlooks = looked.outlooks(IN_EARNEST)
    useful = [one for one in outlooks if one.log_odds[0, 1:].max() > ENOUGH]
    if not useful:
        odds = max((float(one.log_odds[0, 1:].max()) for one in outlooks), default=None)
        return _measured(measurement(names[0], names[1]), names[:2], odds)
    best = useful[0]
    told = [k for k in range(1, len(names)) if best.log_odds[0, k] > ENOUGH]
    said = _spelled(best, 1, machine, results)
    said["separates"] = [names[0], names[told[0]]]
    said["expected_log_odds"] = float(best.log_odds[0, told[0]])
    said["also_separates"] = [names[k] for k in told[1:]]
    left = [names[k] for k in range(1, len(names)) if k not in told]
    said["leaves"] = left
    if left:
        k = names.index(left[0])
        then = next((one for one in outlooks if one.log_odds[0, k] > ENOUGH), None)
        how = measurement(names[0], left[0]).what if then is None else f"record {then.experiment.what}"
        said["what"] += f". Against {left[0]} it tells little; for that, {how}"
    return said


def campaign(
    machine: RecordedMachine, looked: Survey, results: Path | None = None
) -> list[dict[str, Any]]:
    """The next experiments in order: each adds the most, a minute, to those before it.

    Parameters
    ----------
    machine
        The runs there are.
    looked
        What could be recorded.
    results
        Folder that takes `next_1.toml` and so on; None: nothing is written.
    """
    left, order = looked.outlooks(CAMPAIGN), []
    known = np.zeros((len(looked.rivals), len(looked.rivals)))
    while left and len(order) < CAMPAIGN:
        have = information_bits(known, looked.weights)

        def gain(one: Outlook, known: Array = known, have: float = have) -> tuple[float, float]:
            added = information_bits(known + one.log_odds, looked.weights) - have
            # Once everything is told, what would tell it by itself comes first.
            return max(round(added, 3), 0.0) / one.experiment.minutes, one.bits_per_minute

        best = max(left, key=gain)
        left.remove(best)
        order.append(best)
        known = known + best.log_odds
    found = []
    for place, one in enumerate(order, start=1):
        said = _spelled(one, place, machine, results)
        i, k = np.unravel_index(int(np.argmax(one.log_odds)), one.log_odds.shape)
        said["separates"] = [looked.rivals[min(i, k)].name, looked.rivals[max(i, k)].name]
        said["expected_log_odds"] = float(one.log_odds.max())
        found.append(said)
    return found


def _spelled(
    one: Outlook, place: int, machine: RecordedMachine, results: Path | None
) -> dict[str, Any]:
    path = None
    if results is not None:
        path = write_rig(one.experiment, machine.recordings[0], results / f"next_{place}.toml")
    file = str(path or f"next_{place}.toml")
    zeros = "" if one.experiment.rig.bus.port == "simulated" else " --zeros zeros.json"
    options = f"--rig {file}{zeros}"
    return {
        "what": f"record {one.experiment.what}",
        "excitation": one.experiment.excitation.model_dump(mode="json", exclude_none=True),
        "bits": one.bits,
        "minutes": one.experiment.minutes,
        "bits_per_minute": one.bits_per_minute,
        "options": options,
        "command": f"rig record {options}",
        "rig_file": None if path is None else str(path),
    }


def _measured(found: Measurement, names: Sequence[str], log_odds: float | None) -> dict[str, Any]:
    best = "" if log_odds is None else f", odds of {np.exp(min(log_odds, ENOUGH)):.2g} to 1 at best"
    return {
        "what": f"{found.what}; no motion in the list tells {names[0]} from {names[1]}{best}",
        "separates": list(names),
        "excitation": None,
        "expected_log_odds": None,
        "bits": None,
        "minutes": found.minutes,
        "command": None,
    }


def _check(judgement: Judgement) -> dict[str, Any]:
    """What would show a named cause wrong."""
    names = [one.name for one in judgement.causes]
    if judgement.verdict == "parameter":
        what = f"measure what {names[0]} stands for by itself, and correct the rig file"
        minutes = 30.0
    else:
        what = (
            "record the same motion at half the amplitude and at another frequency, and compare it "
            "with improved.toml: a law that is right foretells it to the noise"
        )
        minutes = 2.0
    return {
        "what": what,
        "separates": names,
        "excitation": None,
        "expected_log_odds": None,
        "bits": None,
        "minutes": minutes,
        "command": None,
    }
