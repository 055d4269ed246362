"""The verdict: which causes are there, how sure that is, and what these data cannot tell apart."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.cause import Cause, cause_of, doubted, within_sigma
from analysis.engine.doubt import doubt_beside, doubt_of, hardly_explains
from analysis.engine.fitted import Fitted
from analysis.engine.moved import Beside, raised, rise_of
from analysis.engine.weights import temper_of, weights_of

NEGLIGIBLE, STANDS_OUT = 0.02, 15.0
"""A magnitude below this share of its usual size is nothing, unless with it the score is so much
higher than without it."""

SECOND = 0.8
"""A cause beside the first is reported if it is present with this probability."""

IMPLAUSIBLE = 4.0
"""What a number at the edge of its plausible range costs, as a logarithm of odds."""

CERTAIN = 0.9
"""A cause named alone is at least this likely."""

UNKNOWN = 0.05
"""No cause is told as surer than this leaves it. Of 168 that were as sure as could be, in blind
sets by two plants, 9 % were not there (5 to 14 %): what no hypothesis says, no score doubts."""

KEEPS = 0.5
"""Of what a number costs less where it is off, squared, another cause that explains it saves so
much: it keeps the number near where it is known to be."""

NOISE = 1.06
"""The squared misfit of a sample that noise allows where it is known, and simulators."""

DOUBT_ASIDE = 0.5
"""Of the share of recordings that what is on could not be led through, this much is doubt."""

MANY, ELSE = 4, 0.5
"""A cause of which more numbers than this were chosen out of many, such as a dozen coordinates of
sixteen points, explains whatever is there: it is as likely something else."""

ON_EDGE = 0.5
"""And so is one with a number at the edge of what is plausible, of which the edge is no law of its
own: of six that were told as sure in blind sets, two were there."""


@dataclass(frozen=True)
class Judgement:
    """What the search comes to.

    Attributes
    ----------
    verdict
        "none", "parameter", "explained", "ambiguous" or "unexplained".
    causes
        The causes, the surest first; empty for "none", and where no ring can be followed though
        lines ask for nothing: "unexplained".
    chosen
        The likeliest hypothesis.
    probability
        Of each fitted hypothesis, in their order.
    doubt
        The probability that it is something else: the best leaves more than noise.
    shown
        What is named was not fitted: samples show it, and no simulation could follow them.
    """

    verdict: str
    causes: tuple[Cause, ...]
    chosen: Fitted
    probability: tuple[float, ...]
    doubt: float = 0.0
    shown: bool = False


def judge(
    fitted: Sequence[Fitted],
    candidates: Mapping[str, Candidate],
    *,
    lost: bool = False,
    noise: float = NOISE,
    aside: float = 0.0,
    moved: Mapping[str, float] | None = None,
    beside: Beside | None = None,
    settled: bool = False,
) -> Judgement:
    """Weigh the fitted hypotheses.

    Parameters
    ----------
    fitted
        The hypotheses, the null among them.
    candidates
        By name.
    lost
        The system rings, and no hypothesis could be led to the ring's phase.
    noise
        The squared misfit of a sample that noise leaves, where that is more than `NOISE`.
    aside
        Share of the recordings that did not count, for what is on could not be led through them.
    moved
        Numbers that nothing left out has moved too far, and by how many sigmas; None: they were not
        led to the noise.
    beside
        Numbers that others have moved too far: see `released_beside`.
    settled
        The system does not ring: what hypotheses leave is of where they stay (`settled`), and is
        held against what nothing leaves.
    """
    noise = max(noise, NOISE)
    scores = np.array([_plausible_score(one) for one in fitted])
    nothing = max(
        (score for score, one in zip(scores, fitted, strict=True) if not one.hypothesis.parts),
        default=-np.inf,
    )
    shown = {name for one in fitted for name in one.hypothesis.names if candidates[name].shown}
    shown = shown if lost else set()
    lacking = [not shown <= set(one.hypothesis.names) for one in fitted]
    scores[_idle(fitted, scores, candidates) | np.array(lacking)] = -np.inf
    null = next(one for one in fitted if not one.hypothesis.parts)
    if settled:
        unsure = [any(within_sigma(one, name) for name in one.hypothesis.names) for one in fitted]
        hardly = [hardly_explains(one, null) for one in fitted]
        scores[np.logical_or(unsure, hardly)] = -np.inf
    nothing = nothing if np.isfinite(nothing) else scores.max()
    scores = _moved(scores, fitted, candidates, moved or {}, nothing)
    weights = weights_of(scores, fitted, candidates, nothing, noise, settled=settled)
    weights = raised(weights, fitted, candidates, beside or {})
    absent = sum(
        float(w) for one, w in zip(fitted, weights, strict=True) if not one.hypothesis.parts
    )
    chosen = fitted[_likeliest(fitted, weights)]
    if absent > 0.5 or not chosen.hypothesis.parts:
        # Parameters alone follow a ring from which nothing was left out.
        verdict = "unexplained" if lost else "none"
        return Judgement(verdict, (), null, tuple(float(w) for w in weights))
    causes: tuple[Cause, ...] = ()
    for _ in range(len(chosen.hypothesis.parts)):
        every = (
            cause_of(name, chosen, fitted, weights, candidates) for name in chosen.hypothesis.names
        )
        causes = tuple(sorted(every, key=lambda one: -one.present))
        kept = {causes[0].name, *(one.name for one in causes[1:] if one.present > SECOND)}
        fewer = [one for one in fitted if set(one.hypothesis.names) == kept]
        if len(kept) == len(causes) or not fewer:
            break
        # What is not sure enough is left out, and the others are as they are without it.
        chosen = max(fewer, key=lambda one: one.log_score)
    doubt = doubt_of(chosen, candidates, lost=lost, noise=noise, alone=null.left)
    if settled:
        doubt = doubt_beside(chosen, null, candidates, noise)
    doubt += (1.0 - doubt) * DOUBT_ASIDE * aside
    sure = (causes[0], *(one for one in causes[1:] if one.present > SECOND))
    doubts = {
        one.name: doubt + (1.0 - doubt) * _by_itself(one, chosen, candidates[one.name])
        for one in sure
        if one.name not in shown
    }
    verdict = "unexplained"
    if doubt < 0.5 or shown:
        verdict = _verdict([doubted(one, doubts.get(one.name, 0.0)) for one in sure], candidates)
    causes = tuple(
        doubted(one, max(doubts[one.name], UNKNOWN)) if one.name in doubts else one for one in sure
    )
    return Judgement(
        verdict, causes, chosen, tuple(float(w) for w in weights), doubt, shown=bool(shown)
    )


def _likeliest(fitted: Sequence[Fitted], weights: Array) -> int:
    """Which fit is the likeliest of the causes that are, wherever each is and in whatever form."""
    names = [one.hypothesis.names for one in fitted]
    whole: dict[tuple[str, ...], float] = defaultdict(float)
    for key, weight in zip(names, weights, strict=True):
        whole[key] += float(weight)
    return max(range(len(fitted)), key=lambda i: (whole[names[i]], weights[i]))


def _moved(
    scores: Array,
    fitted: Sequence[Fitted],
    candidates: Mapping[str, Candidate],
    moved: Mapping[str, float],
    nothing: float,
) -> Array:
    """Scores, numbers that nothing has moved too far as likely as that says.

    As likely as that something is there is not that it is this: other causes that keep the number
    where it is known to be are as far behind it, or ahead, as they were.
    """
    names = [one.hypothesis.names for one in fitted]
    far = {i: moved[one[0]] for i, one in enumerate(names) if len(one) == 1 and one[0] in moved}
    raised_to = {
        i: nothing + rise_of(sigmas, temper_of(candidates[names[i][0]].form_share))
        for i, sigmas in far.items()
    }
    found = scores.copy()
    for i, score in raised_to.items():
        found[i] = max(scores[i], score)
    if far:
        first = max(far, key=lambda i: found[i])
        # What is so small that it is none has no evidence of its own.
        rise = found[first] - (scores[first] if np.isfinite(scores[first]) else nothing)
        strain = np.array([one.strain for one in fitted])
        null = max(strain[i] for i, one in enumerate(names) if not one)
        for i, one in enumerate(names):
            keeps = null - strain[i] >= KEEPS * (null - strain[first])
            if one and i not in far and keeps:
                found[i] += rise
    return found


def _by_itself(cause: Cause, chosen: Fitted, candidate: Candidate) -> float:
    """The probability that a cause was chosen for what it can take up, and not for being there."""
    free = len(chosen.hypothesis.parts[candidate.name].groups(candidate))
    any_would_do = candidate.chosen_terms and free > MANY
    return max(ELSE if any_would_do else 0.0, ON_EDGE if cause.at_limit else 0.0)


def _idle(
    fitted: Sequence[Fitted], scores: Array, candidates: Mapping[str, Candidate]
) -> NDArray[np.bool_]:
    """Hypotheses with a candidate that is no cause of its own.

    It is so small, and explains so little, that it is none; or it came to where it is another one,
    with which the hypothesis is as likely.
    """
    found = np.zeros(len(fitted), dtype=bool)
    best: dict[tuple[str, ...], float] = defaultdict(lambda: -np.inf)
    for one, score in zip(fitted, scores, strict=True):
        best[one.hypothesis.names] = max(best[one.hypothesis.names], float(score))
    for i, one in enumerate(fitted):
        for name in negligible(one, candidates):
            without = best[one.hypothesis.without(name).names]
            found[i] |= bool(scores[i] < without + STANDS_OUT)
        others = one.hypothesis.also(candidates)
        found[i] |= any(best[names] >= scores[i] for names in others)
    return found


def negligible(fitted: Fitted, candidates: Mapping[str, Candidate]) -> tuple[str, ...]:
    """Candidates of a hypothesis that are far below their usual size."""
    found = []
    for name, part in fitted.hypothesis.parts.items():
        if candidates[name].shown:
            continue
        steps = {term.name: term.step for term in candidates[name].terms}
        if all(abs(fitted.values[name, t]) < NEGLIGIBLE * abs(steps[t]) for t in part.terms):
            found.append(name)
    return tuple(found)


def _plausible_score(fitted: Fitted) -> float:
    """A better fit with an implausible number counts for less."""
    return fitted.log_score - IMPLAUSIBLE * len(fitted.at_limit)


def _verdict(causes: Sequence[Cause], candidates: Mapping[str, Candidate]) -> str:
    if any(one.rivals or one.present < CERTAIN for one in causes):
        return "ambiguous"
    if all(candidates[one.name].side == "parameter" for one in causes):
        return "parameter"
    return "explained"
