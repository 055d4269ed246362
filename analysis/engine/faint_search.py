"""Which causes the ring tells, in straight lines about where it was followed to."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.evidence import Weighed
from analysis.engine.faint import Faint
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.refine import Refiner
from analysis.engine.screen import Scored, Screen, grouped
from analysis.engine.state import State

SINGLES, PARENTS, PAIRS = 8, 3, 6
"""So many hypotheses are kept, and so many looked beside."""

ASKS = 4.0
"""One cause more is worth a try where the ring promises this rise of the score."""

NEARLY, AHEAD = 0.9, 8.0
"""All places alike are followed where they promise this share of what the best places do; those as
well where they are so far ahead."""


def faint_search(
    found: Faint, refiner: Refiner, candidates: Mapping[str, Candidate]
) -> tuple[list[Scored], list[Fitted]]:
    """Single candidates and pairs about the followed ring.

    Parameters
    ----------
    found
        See there.
    refiner
        Makes fitted hypotheses of them.
    candidates
        By name.

    Returns
    -------
    list of Scored, list of Fitted
        Single ones, the best first; and the best of all, the null among them.
    """
    chosen = {name: one for name, one in candidates.items() if not one.fixed}
    screen = Screen(found.problem, chosen, found.terms, moved=False)
    null = screen.null()
    singles = singles_of(screen, chosen)
    pairs: dict[tuple[str, ...], Scored] = {}
    for parent in singles[:PARENTS]:
        if parent.log_score < null.log_score:
            break
        for one in _best(_beside(found, parent, chosen), chosen, parent.hypothesis):
            known = pairs.get(one.hypothesis.names)
            if known is None or one.log_score > known.log_score:
                pairs[one.hypothesis.names] = one
    best = sorted(pairs.values(), key=lambda one: -one.log_score)[:PAIRS]
    kept = singles[:SINGLES]
    kin = {chosen[name].family for one in kept for name in one.hypothesis.names} - {""}
    # Laws of one thing stand side by side, however far apart a ring puts them.
    kept += [
        one
        for one in singles[SINGLES:]
        if any(chosen[name].family in kin for name in one.hypothesis.names)
    ]
    fitted = [_fitted_there(found, refiner, one) for one in (null, *kept, *best)]
    return singles, sorted(fitted, key=lambda one: -one.log_score)


def singles_of(screen: Screen, candidates: Mapping[str, Candidate]) -> list[Scored]:
    """Single causes, each in the places that promise most, the best first."""
    return _best(screen, candidates, Hypothesis())


def others_beside(refiner: Refiner, led: Followed) -> list[Candidate]:
    """What may be there beside what is on: no second law of one thing."""
    on = [refiner.candidates[name] for name in led.names]
    families = {one.family for one in on} - {""}
    return [
        one for one in refiner.candidates.values() if one not in on and one.family not in families
    ]


def kin_beside(refiner: Refiner, led: Followed) -> list[Candidate]:
    """Second laws of one thing, beside what is on: what another cause on may stand for."""
    on = [refiner.candidates[name] for name in led.names]
    families = {one.family for one in on} - {""}
    kin = (one for one in refiner.candidates.values() if one.family in families)
    return [one for one in kin if one not in on]


def one_more(found: Faint, refiner: Refiner, explains: float = 0.0) -> list[Scored]:
    """One cause more than is on, where the ring promises something, the best first.

    Parameters
    ----------
    found, refiner
        As for `faint_search`.
    explains
        Share of what is left beyond noise, as the score counts it, that it must promise to explain.
    """
    _, best = _promises(found, refiner, explains)
    return best


def most_promised(found: Faint, refiner: Refiner) -> float:
    """By how much the score is promised to rise at most by one cause more."""
    nothing, best = _promises(found, refiner, 0.0)
    return max((one.log_score for one in best), default=-np.inf) - nothing


def promised_by(found: Faint, refiner: Refiner, scored: Scored) -> float:
    """By how much the squared misfit is promised to fall with one cause more than is on."""
    screen = screen_about(found, refiner.candidates)
    nothing, known = screen.null(), refiner.candidates
    before = nothing.log_score - screen.on.log_prior(known)
    after = scored.log_score - scored.hypothesis.log_prior(known)
    return 2.0 * float(found.problem.base.mean()) * (after - before)


def eased_by(found: Faint, refiner: Refiner, scored: Scored) -> float:
    """By how much less parameters are promised to cost with one cause more than with what is on.

    What is on may not have come to where they are likeliest: what they would cost less without any
    cause is none's.
    """
    on, more = (
        nuisances_of(found, one) for one in (screen_about(found, refiner.candidates).null(), scored)
    )
    return float(on @ on - more @ more)


def _promises(found: Faint, refiner: Refiner, explains: float) -> tuple[float, list[Scored]]:
    """The score of what is on, and `one_more`."""
    asked = {name for name, _ in found.terms}
    beside = others_beside(refiner, found.followed)
    chosen = {one.name: one for one in beside if one.name in asked}
    screen = screen_about(found, refiner.candidates)
    nothing = screen.null().log_score
    least = nothing + ASKS + explains * _beyond_noise(found)
    best = [one for one in _best(screen, chosen, screen.on) if one.log_score > least]
    if found.followed.telling < 1.0:
        both = (each for one in best for each in _simpler(screen, one, nothing))
        best = sorted(both, key=lambda one: -one.log_score)
    return nothing, best


def screen_about(found: Faint, candidates: Mapping[str, Candidate]) -> Screen:
    """What is on, which may still move, and what could be beside it."""
    state = found.followed.state
    on = Hypothesis() if state is None else state.hypothesis
    return Screen(
        found.problem,
        candidates,
        found.terms,
        on=on,
        done={name: np.zeros(len(found.problem.residual)) for name in on.names},
        own=found.own,
        state=state,
    )


def _beyond_noise(found: Faint) -> float:
    """What is left beyond noise where candidates could be, as a score counts it."""
    residual, base = found.problem.residual, found.problem.base
    return 0.5 * max(float(np.sum(residual**2 / base)) - len(residual), 0.0)


def _simpler(screen: Screen, scored: Scored, nothing: float) -> list[Scored]:
    """The same in all places alike, where that promises nearly as much; beside it, where not.

    Over a short stretch, and to first order, which places are on is no more than a guess: where it
    is worth something, both are to be led.
    """
    (name,) = set(scored.hypothesis.names) - set(screen.on.names)
    candidate = screen.candidates[name]
    every = tuple(one.name for one in candidate.terms)
    if not candidate.spreads or candidate.together:
        return [scored]
    part = Part(every, True, scored.hypothesis.parts[name].shapes)
    alike = screen.with_part(name, part, like=scored)
    if alike.log_score - nothing <= NEARLY * (scored.log_score - nothing):
        return [scored]
    return [scored, alike] if scored.log_score > alike.log_score + AHEAD else [alike]


def nuisances_of(found: Faint, scored: Scored) -> Array:
    """Where the nuisances would be, in sigmas."""
    return nuisances_by(found, scored.weighed)


def nuisances_by(found: Faint, weighed: Weighed) -> Array:
    """The same, by the evidence."""
    moved = found.rotation @ (weighed.nuisance - found.problem.at)
    return np.asarray(found.followed.nuisance + moved)


def _best(screen: Screen, candidates: Mapping[str, Candidate], parent: Hypothesis) -> list[Scored]:
    families = {candidates[name].family for name in parent.names if name in candidates} - {""}
    scored = [
        screen.best_of(name)
        for name, one in candidates.items()
        if name not in parent.parts and one.family not in families
    ]
    return sorted((one for one in scored if one is not None), key=lambda one: -one.log_score)


def _beside(found: Faint, parent: Scored, candidates: Mapping[str, Candidate]) -> Screen:
    """What is left beside a parent, which may still move."""
    state = State.of(parent, candidates)
    (name,) = parent.hypothesis.names
    part = parent.hypothesis.parts[name]
    columns = grouped(candidates[name], found.terms[name, parent.looked[name]], part)
    does = columns @ parent.weighed.estimate
    # Numbers of shape do nothing to first order about little.
    own = np.hstack([columns, np.zeros((len(does), len(state.free) - columns.shape[1]))])
    problem = replace(found.problem, residual=found.problem.residual - does)
    return Screen(
        problem,
        candidates,
        found.terms,
        on=parent.hypothesis,
        done={name: does},
        own={name: own},
        state=state,
        moved=False,
    )


def guessed(found: Faint, refiner: Refiner, scored: Scored) -> Guess:
    """A hypothesis where straight lines about the followed ring say, to be led from there."""
    state = State.of(scored, refiner.candidates)
    return Guess(state, nuisances_of(found, scored), scored.log_score)


def _fitted_there(found: Faint, refiner: Refiner, scored: Scored) -> Fitted:
    """A hypothesis as others are, with the score that the ring gives it."""
    there = guessed(found, refiner, scored)
    fitted = refiner.standing(there.state, there.nuisance)
    return replace(fitted, log_score=scored.log_score, left=found.followed.left)
