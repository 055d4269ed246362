"""How likely each hypothesis is: scores count for less than they say, for laws are not exact."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from math import log

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import LOG_ODDS, Hypothesis
from analysis.engine.span import FORMS

TEMPER = 2.0
"""Scores count for less than they say, by this factor: laws are never quite the library's."""

EXACT, TEMPER_EXACT = 0.02, 1.4
"""Where what the best says is exact, as a number of a rig file or of a camera is, they count for
less by this alone: where nothing was left out, none has come nearer than 6 to nothing."""

KIN_TEMPER = 4.0
"""And among laws of one family by this factor more."""

TEMPER_SHARE = 0.1
"""Or by this share of what there is to explain, times the square of the error of form of the laws
that explain it: the more there is, the more their form counts."""

MOST_AT_NOISE = 20.0
"""But by no more than this, where the best comes to the noise: its form has shown to be right. What
leaves twice as much beyond a perfect fit as noise may has shown a quarter of that."""

NEARLY = 2.0
"""What leaves no more than so many times what noise may, beyond a perfect fit, is nearly there."""

OF_LEFT = 3.0
"""But what leaves ten times as much, squared, as the likeliest is a thousand times less likely,
however little scores count: their temper has forgiven laws their form, all of them alike."""

MOST_OF_STRAIN = 6.0
"""And by no more than this of what parameters cost that are far from what is known of them: no
error of form makes that likelier. Where nothing rings, by `TEMPER`: they are where they stay."""

SIMPLER, MOST_SHAPES = 0.7, 2
"""Of laws of one family, each number of shape takes this off the logarithm of odds, up to so many:
where a hose is tied on makes it no other law."""


def temper_of(form: float) -> float:
    """By which factor scores count for less at least, by the error of form of what is on."""
    return TEMPER_EXACT if form < EXACT else TEMPER


def weights_of(
    scores: Array,
    fitted: Sequence[Fitted],
    candidates: Mapping[str, Candidate],
    nothing: float,
    noise: float,
    *,
    settled: bool,
) -> Array:
    """Probabilities of hypotheses, shape (h,).

    Parameters
    ----------
    scores
        Of each; minus infinity where it is out of the question, shape (h,).
    fitted, candidates
        Hypotheses, and what can be on, by name.
    nothing
        The score of nothing left out.
    noise
        The squared misfit of a sample that noise leaves.
    settled
        See `judge`.
    """
    best = fitted[int(np.argmax(scores))]
    form = max((candidates[name].form_share for name in best.hypothesis.names), default=0.0)
    temper = max(temper_of(form), TEMPER_SHARE * form**2 * float(scores.max() - nothing))
    if np.isfinite(best.left):
        times = max((best.left - 1.0) / (noise - 1.0), 1.0)
        temper = min(temper, MOST_AT_NOISE * times**2)
        if times == 1.0:
            most_of_strain = TEMPER if settled else MOST_OF_STRAIN
            scores = _strained(scores, fitted, temper, most_of_strain)
    scores = _among_kin(scores, fitted, candidates, temper)
    # However little scores count, one cause more is no likelier beforehand.
    causes_on = np.array([len(one.hypothesis.parts) for one in fitted])
    first = int(np.argmax(scores))
    logs = (scores - scores[first]) / temper + LOG_ODDS * causes_on * (1.0 - 1.0 / temper)
    if settled:
        most = -_more_left(fitted, fitted[first])
    else:
        most = _by_chance(fitted, fitted[first], candidates, noise)
    logs = np.minimum(logs, logs[first] + most)
    weights = np.exp(logs - logs.max())
    return np.asarray(weights / weights.sum())


def _by_chance(
    fitted: Sequence[Fitted], best: Fitted, candidates: Mapping[str, Candidate], noise: float
) -> Array:
    """By how much likelier than the best each can be at most, as a logarithm, shape (h,).

    That is of those that have a cause less than the best; infinity for all others.

    Where the best comes nearly to the noise, and without one of its causes more is left than that
    is, an error of form had to be of the shape of that cause (`log_chance`).

    Parameters
    ----------
    fitted, best, candidates
        Hypotheses, the likeliest, and what can be on.
    noise
        The squared misfit of a sample that noise leaves.
    """
    found = np.full(len(fitted), np.inf)
    if not best.left - 1.0 < NEARLY * (noise - 1.0):
        return found
    for i, one in enumerate(fitted):
        fewer = set(one.hypothesis.names)
        if not (fewer and fewer < set(best.hypothesis.names) and one.left > noise):
            continue
        share = (max(best.left, 1.0) + noise - 2.0) / (one.left + noise - 2.0)
        numbers = numbers_of(best.hypothesis, candidates) - numbers_of(one.hypothesis, candidates)
        chance = log_chance(share, numbers)
        more = best.hypothesis.log_prior(candidates) - one.hypothesis.log_prior(candidates)
        found[i] = chance - more
    return found


def log_chance(share: float, numbers: int) -> float:
    """How likely it is that all but a share of an error of form is where a cause is, its logarithm.

    It lies in any of `FORMS` directions, of unknown size: all but a share s of it is in k of them
    with a probability of s^((FORMS - k) / 2).

    Parameters
    ----------
    share
        Of what is left, what is left with the cause.
    numbers
        Of the cause.
    """
    return 0.5 * max(FORMS - numbers, 0) * log(share)


def numbers_of(hypothesis: Hypothesis, candidates: Mapping[str, Candidate]) -> int:
    """How many magnitudes are free."""
    return sum(len(part.groups(candidates[name])) for name, part in hypothesis.parts.items())


def _more_left(fitted: Sequence[Fitted], best: Fitted) -> Array:
    """By how much less likely each is than the best, for what more it leaves, as a logarithm."""
    left = np.array([max(one.left, 1.0) if np.isfinite(one.left) else np.inf for one in fitted])
    return np.asarray(OF_LEFT * np.log(np.maximum(left / max(best.left, 1.0), 1.0)))


def _strained(scores: Array, fitted: Sequence[Fitted], temper: float, most: float) -> Array:
    """Scores in which parameters that are bent count for more, where the others count for less."""
    strain = np.array([0.5 * one.strain for one in fitted])
    return scores - strain * max(temper / most - 1.0, 0.0)


def _among_kin(
    scores: Array,
    fitted: Sequence[Fitted],
    candidates: Mapping[str, Candidate],
    temper: float,
) -> Array:
    """Scores in which laws of one family differ by less: none of them is the true one."""
    groups: dict[tuple[str, ...], list[int]] = defaultdict(list)
    for i, one in enumerate(fitted):
        names = (candidates[name].kind for name in one.hypothesis.names)
        groups[tuple(sorted(names))].append(i)
    found = scores.copy()
    for places in groups.values():
        best = scores[places].max()
        if np.isfinite(best) and len(places) > 1:
            shapes = [
                sum(len(candidates[name].shapes_of(())) for name in fitted[i].hypothesis.names)
                for i in places
            ]
            more = np.minimum(np.array(shapes) - min(shapes), MOST_SHAPES)
            found[places] = best - (best - scores[places]) / KIN_TEMPER - temper * SIMPLER * more
    return found
