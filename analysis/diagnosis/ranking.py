"""Everything that was weighed, as plain data: hypotheses in order, and what each effect came to."""

from typing import Any

import numpy as np

from analysis.engine.diagnosis import Diagnosis
from analysis.engine.fitted import Fitted
from analysis.engine.judge import IMPLAUSIBLE
from analysis.engine.weights import TEMPER

SHOWN = 12
"""Hypotheses kept."""

SHOWS = 0.01
"""Of what a cause does in all, a harmonic at which it shows has this share."""


def ranking(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Hypotheses that were fitted in earnest, the best first.

    Parameters
    ----------
    diagnosis
        What the engine found.

    Returns
    -------
    list of dict
        `effects` (empty: nothing left out), `log_odds` against the best as the evidence has it,
        `tempered` as it counts, `probability`, `chosen`, and `implausible`: numbers at the edge of
        their range. The null hypothesis is always among them.
    """
    search, judgement = diagnosis.search, diagnosis.judgement
    if search is None or judgement is None:
        return []
    scores = [_score(one) for one in search.fitted]
    best = max(scores)
    found: list[dict[str, Any]] = [
        {
            "effects": list(one.hypothesis.names),
            "log_odds": score - best,
            "tempered": (score - best) / TEMPER,
            "probability": probability,
            "chosen": one is judgement.chosen,
            "implausible": [f"{name} {number}" for name, number in one.at_limit],
        }
        for one, score, probability in zip(
            search.fitted, scores, judgement.probability, strict=True
        )
    ]
    found.sort(key=lambda one: -one["log_odds"])
    kept = found[:SHOWN]
    return kept + [one for one in found[SHOWN:] if not one["effects"] or one["chosen"]]


def ruled_out(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Effects that are neither a cause nor in a cause's set, the nearest first.

    Returns
    -------
    list of dict
        `effect`; `log_odds` of the best hypothesis that has it, against the best of all; `how`:
        "instead" of what was found, "beside" it, or "screened": to first order only, alone, against
        the best single effect; `probability` of all hypotheses that have it.
    """
    search, judgement = diagnosis.search, diagnosis.judgement
    if search is None or judgement is None:
        return []
    named = {name for cause in judgement.causes for name in cause.names}
    chosen = set(judgement.chosen.hypothesis.names)
    best = max(_score(one) for one in search.fitted)
    found: dict[str, dict[str, Any]] = {}
    for one, probability in zip(search.fitted, judgement.probability, strict=True):
        names = set(one.hypothesis.names)
        for name in names - named:
            entry = found.setdefault(
                name, {"effect": name, "log_odds": -float("inf"), "how": "", "probability": 0.0}
            )
            entry["probability"] += probability
            if _score(one) - best > entry["log_odds"]:
                entry["log_odds"] = _score(one) - best
                entry["how"] = "beside" if chosen and chosen <= names else "instead"
    top = search.screened[0].log_score if search.screened else 0.0
    for scored in search.screened:
        (name,) = scored.hypothesis.names
        if name not in named and name not in found:
            found[name] = {
                "effect": name,
                "log_odds": min(scored.log_score - top, 0.0),
                "how": "screened",
                "probability": 0.0,
            }
    return sorted(found.values(), key=lambda one: (one["how"] == "screened", -one["log_odds"]))


def harmonics_of(diagnosis: Diagnosis, effect: str) -> list[int]:
    """Harmonics of the drive at which a cause shows, 0 for the mean.

    Parameters
    ----------
    diagnosis
        What the engine found.
    effect
        One of the chosen hypothesis; of another, nothing is known and the list is empty.
    """
    judgement = diagnosis.judgement
    done = None if judgement is None else judgement.chosen.done.get(effect)
    if done is None or judgement is None:
        return []
    labels = judgement.chosen.problem.labels
    own = ~labels.free & (labels.order == 0)
    power = np.bincount(np.round(labels.line[own]).astype(int), done[own] ** 2)
    return [int(one) for one in np.flatnonzero(power > SHOWS * power.sum())]


def _score(fitted: Fitted) -> float:
    """As the judge counts it: a number at the edge of its plausible range costs."""
    return fitted.log_score - IMPLAUSIBLE * len(fitted.at_limit)
