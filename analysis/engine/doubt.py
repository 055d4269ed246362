"""The doubt of what explains best, by what it leaves: of samples, of lines, or of the mismatch."""

from collections.abc import Mapping

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.evidence import FORM_SIZES
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import LOG_COST, LOG_ODDS

DOUBTFUL = 8.0
"""How much more than noise leaves it even whether what explains best is what is there, for one
whose law has this for an error of form: what is known exactly must explain to the noise."""

SUREST = 0.4
"""As much more leaves it even where a law has no error of form."""

SLIGHT = 0.1
"""What is left of all that parameters alone leave, as an amplitude, and is less than this share of
a law's error of form, that form leaves: the less, the less doubt."""

MOST_DOUBT = 0.6
"""What was led to the ring's phase and is far from the noise is more often wrong than right."""

DOUBT_A_CAUSE = 0.2
"""Where no simulation can be led to the ring's phase, lines alone speak: for each cause that they
need, this is the doubt. One cause that explains all lines is mostly the right one; three are what a
missing law is made up of."""

EVEN_OF_LINES = 15.0
"""There, what leaves so many times more of lines than noise and the error of form is as likely
something else."""

FORMS_OFF = FORM_SIZES[-1]
"""Where nothing rings: laws that leave so many of their errors of form, as a share of the mismatch,
are as likely something else that does much the same: it is the largest that evidence forgives."""

LEAST_FORM, TINY = 0.01, 1e-9
"""The same for laws that state none, for simulators have one; and what no mismatch is."""

HARDLY = 2.0 * (LOG_COST - LOG_ODDS)
"""A cause and its number must lower the squared misfit of what is simulated by what they cost."""


def doubt_of(
    fitted: Fitted,
    candidates: Mapping[str, Candidate],
    *,
    lost: bool,
    noise: float,
    alone: float = np.nan,
) -> float:
    """The probability that what explains best is not what is there, by what it leaves.

    Parameters
    ----------
    fitted
        What explains best.
    candidates
        By name.
    lost
        Whether it could not be led to the ring's phase.
    noise
        The squared misfit of a sample that noise leaves.
    alone
        That which parameters alone leave; NaN: not known.
    """
    if lost:
        doubt = min(DOUBT_A_CAUSE * len(fitted.hypothesis.parts), MOST_DOUBT)
        return 1.0 - (1.0 - doubt) / (1.0 + max(fitted.lines_left - 1.0, 0.0) / EVEN_OF_LINES)
    if np.isnan(fitted.left):
        return 0.0
    form = max((candidates[name].form_share for name in fitted.hypothesis.names), default=0.0)
    more = max(fitted.left - noise, 0.0)
    beyond = more / max(DOUBTFUL * form, SUREST)
    if more < (SLIGHT * form) ** 2 * (alone - noise):
        beyond *= float(np.sqrt(more / (alone - noise))) / (SLIGHT * form)
    return min(beyond / (1.0 + beyond), MOST_DOUBT)


def doubt_beside(
    fitted: Fitted, null: Fitted, candidates: Mapping[str, Candidate], noise: float
) -> float:
    """The probability that what explains best is not what is there, by its share of the mismatch.

    Parameters
    ----------
    fitted
        What explains best, where it stays.
    null
        Nothing, where that stays.
    candidates
        By name.
    noise
        The squared misfit that noise leaves.
    """
    odds = missed(fitted, null, candidates, noise) ** 2
    return odds / (1.0 + odds)


def hardly_explains(fitted: Fitted, null: Fitted) -> bool:
    """Whether a hypothesis leaves hardly less than parameters alone, or more: it is out then.

    Evidence forgives laws their form, and may prefer one that leaves many times as much.

    Parameters
    ----------
    fitted, null
        As for `doubt_beside`.
    """
    return bool(fitted.hypothesis.parts) and squares_of(null) - squares_of(fitted) < HARDLY


def missed(
    fitted: Fitted, null: Fitted, candidates: Mapping[str, Candidate], noise: float
) -> float:
    """The share of the mismatch that is left, over that which makes it even what the law is.

    Parameters
    ----------
    fitted, null, candidates, noise
        As for `doubt_beside`.
    """
    form = max((candidates[name].form_share for name in fitted.hypothesis.names), default=0.0)
    beyond = max(fitted.left - noise, 0.0)
    share = np.sqrt(beyond / max(null.left - noise, TINY)) if beyond else 0.0
    return float(share / max(FORMS_OFF * form, LEAST_FORM))


def squares_of(fitted: Fitted) -> float:
    """Squared misfit of what was simulated, in noise, and of the parameters to their prior."""
    return fitted.left * int(fitted.problem.used.sum()) + float(
        fitted.problem.at @ fitted.problem.at
    )
