"""Which causes explain more as they usually are than straight lines about the ring promise."""

from collections.abc import Mapping, Sequence
from math import log

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.evidence import weigh
from analysis.engine.faint import Faint
from analysis.engine.faint_search import nuisances_by
from analysis.engine.fitted import Fitted
from analysis.engine.guess import Guess
from analysis.engine.screen import LOOSE_FORM
from analysis.engine.stride import SIZES

LEAST, MOST = 0.5, 2.0
"""So many times as much of it may be told from there."""


def stride_guesses(
    found: Faint, candidates: Mapping[str, Candidate], faintly: Sequence[Fitted]
) -> list[Guess]:
    """Causes that are likelier as they usually are than straight lines say, the best first.

    By how much decides what becomes of them: see `NearNoise`.

    Parameters
    ----------
    found
        Everything about where parameters alone came, what strides do there among it.
    candidates
        By name.
    faintly
        What straight lines say.
    """
    told = {one.hypothesis.names: one.log_score for one in faintly}
    guesses: dict[str, Guess] = {}
    for stride, does in found.strides:
        name = stride.candidate.name
        weighed = weigh(
            found.problem,
            {name: does[:, None]},
            {name: np.zeros(len(does))},
            {name: stride.candidate.form_share * LOOSE_FORM},
            np.array([LEAST]),
            np.array([MOST]),
            rounds=2,
        )
        state = stride.state(float(weighed.estimate[0]), candidates)
        prior = state.hypothesis.log_prior(candidates, moved=False)
        score = weighed.log_evidence + prior - log(len(SIZES))
        before = guesses[name].log_score if name in guesses else told.get((name,), -np.inf)
        if score > before:
            guesses[name] = Guess(state, nuisances_by(found, weighed), score)
    return sorted(guesses.values(), key=lambda one: -one.log_score)
