"""The doubt of what explains best, where nothing rings: by what it leaves of the mismatch."""

from collections.abc import Mapping

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.evidence import FORM_SIZES
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import LOG_COST, LOG_ODDS

FORMS_OFF = FORM_SIZES[-1]
"""Where nothing rings: laws that leave so many of their errors of form, as a share of the mismatch,
are as likely something else that does much the same: it is the largest that evidence forgives."""

LEAST_FORM, TINY = 0.01, 1e-9
"""The same for laws that state none, for simulators have one; and what no mismatch is."""

HARDLY = 2.0 * (LOG_COST - LOG_ODDS)
"""A cause and its number must lower the squared misfit of what is simulated by what they cost."""


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
