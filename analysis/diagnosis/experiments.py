"""The next experiment: which of those that can be recorded tells the rivals apart, a minute."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.measurements import Measurement, measurement
from analysis.diagnosis.menu import write_rig
from analysis.diagnosis.outlook import ENOUGH, IN_EARNEST, Outlook, Survey, survey
from analysis.diagnosis.telling import information_bits
from analysis.engine.array import Array
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.judge import Judgement

__all__ = ["campaign", "next_experiment", "survey"]

CAMPAIGN = 5
"""Experiments of a campaign, at most."""


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
    best, outlooks = looked.best, looked.outlooks(IN_EARNEST)
    if best is None:
        odds = max((float(one.log_odds[0, 1:].max()) for one in outlooks), default=None)
        return _measured(measurement(names[0], names[1]), names[:2], odds)
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
        how = (
            measurement(names[0], left[0]).what
            if then is None
            else f"record {then.experiment.what}"
        )
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
    order = [looked.best] if looked.best is not None else []
    left = [one for one in looked.outlooks(CAMPAIGN) if one is not looked.best]
    known = sum((one.log_odds for one in order), np.zeros([len(looked.rivals)] * 2))
    while left and len(order) < CAMPAIGN:
        have = information_bits(known, looked.weights)

        def gain(one: Outlook, known: Array = known, have: float = have) -> tuple[float, float]:
            added = information_bits(known + one.log_odds, looked.weights) - have
            # Once everything is told, what would tell it by itself comes first.
            return max(round(added, 3), 0.0) / one.experiment.minutes, one.bits_per_minute

        chosen = max(left, key=gain)
        left = [one for one in left if one is not chosen]
        order.append(chosen)
        known = known + chosen.log_odds
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
    what, minutes = "record the same motion at half the amplitude and at another frequency", 2.0
    if judgement.verdict == "parameter":
        what = f"measure what {names[0]} stands for by itself, and correct the rig file"
        minutes = 30.0
    elif not names:
        # Nothing was named: there is no rig file with it in to compare with.
        what += (
            ": whether what is missed halves too, and whether it moves with the drive, tells "
            "friction, a number that is off and a ring apart"
        )
    else:
        what += ", and compare it with improved.toml: a law that is right foretells it to the noise"
    return {
        "what": what,
        "separates": names,
        "excitation": None,
        "expected_log_odds": None,
        "bits": None,
        "minutes": minutes,
        "command": None,
    }
