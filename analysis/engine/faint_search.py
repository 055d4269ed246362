"""Which causes are told by the ring: singles and pairs about it, and those led to its phase."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.evidence import FORM_SIZES, FORM_WEIGHTS
from analysis.engine.faint import FORMS, Faint, faint
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import BEHIND, FAINT, LOST, Followed, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import Scored, Screen, grouped, groups
from analysis.engine.sensitivity import Progress
from analysis.engine.sharpen import sharpened
from analysis.engine.state import State
from analysis.engine.system import Array, Candidate, System

SINGLES, PARENTS, PAIRS = 8, 3, 6
"""So many hypotheses are kept, and so many looked beside."""

RESTARTS = 3
"""Nothing is led to the phase once more from where so many hypotheses have come: one may have found
a way that nothing missed."""

MORE, ASKS = 3, 4.0
"""Beside the best that was led to the phase, so many are tried with one cause more, where the ring
promises this rise of the score."""

FAR_BEHIND = 15.0
"""Near the ring's phase, other laws of one thing that promise to stay this far behind are not led
there."""

NEARLY = 0.9
"""All places alike are followed where they promise this share of what the best places do."""

DOUBT = 2.0
"""Standard deviations by which the misfit of all samples may hide an error of form."""


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
    screen = Screen(found.problem, chosen, found.terms)
    null = screen.null()
    singles = _best(screen, chosen, null.hypothesis)
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
    fitted = [_fitted(found, refiner, one) for one in (null, *kept, *best)]
    return singles, sorted(fitted, key=lambda one: -one.log_score)


def followed_search(
    refiner: Refiner,
    hypotheses: Sequence[Fitted],
    others: Sequence[Fitted],
    nothing: Followed,
    most_causes: int,
    progress: Progress | None = None,
    *,
    near: bool = False,
) -> list[Fitted] | None:
    """Hypotheses led to the ring's phase, each for itself, and with one cause more where it asks.

    Parameters
    ----------
    refiner
        Made the hypotheses.
    hypotheses
        Those to try, the null not among them.
    others
        Single causes, the best first: laws of the same things as what comes far are tried as well.
    nothing
        How far parameters alone lead.
    most_causes
        Of a hypothesis.
    progress
        Told of it.
    near
        All of them are near the ring's phase, and their scores tell what each can come to.

    Returns
    -------
    list of Fitted or None
        Their scores are those of all samples, the best first; None where none comes to the noise.
    """
    system = refiner.system
    samples = Samples(system, everything=True)
    count = len(samples.shares)
    led: list[Followed] = []

    def lead(nuisance: Array, state: State, *, near: bool) -> None:
        ahead = min(led, key=_farthest).costs if led else None
        found = follow_ring(system, nuisance, state, everything=True, ahead=ahead, near=near)
        if near and found.share < 1.0:
            found = follow_ring(system, nuisance, state, everything=True, ahead=ahead)
        if found.share < 1.0:
            sharper = sharpened(state, lambda there: -_misfit(samples, found.nuisance, there))
            if sharper is not state:
                found = follow_ring(system, found.nuisance, sharper, everything=True, ahead=ahead)
        led.append(found)
        if progress is not None:
            progress(len(led), max(len(hypotheses), len(led)))

    for one in hypotheses:
        lead(one.point.nuisance, one.state, near=near)
    least = max((one.log_score for one in hypotheses), default=0.0) - FAR_BEHIND
    for one in _kin(refiner, led, others):
        if not near or one.log_score > least:
            lead(one.point.nuisance, one.state, near=near)
    for _ in range(most_causes - 1):
        best = min(led, key=_farthest, default=nothing)
        if best.left > LOST or len(_names(best)) >= most_causes:
            break
        tried = {_names(one) for one in led}
        found = faint(system, best, _others(refiner, best))
        for scored in _more(found, refiner)[:MORE]:
            if scored.hypothesis.names not in tried:
                state = State.of(scored, refiner.candidates)
                lead(_nuisance(found, scored), state, near=best.share == 1.0)
        if min(led, key=_farthest, default=nothing) is best:
            break
    nulls = [nothing]
    for way in sorted(led, key=_farthest)[: RESTARTS if nothing.left < LOST else 0]:
        start = _parameters_of(system, way)
        nulls.append(follow_ring(system, start, everything=True, near=True))
    if min(one.misfit for one in (*led, *nulls)) > FAINT * count:
        return None
    return _weighed(refiner, led, min(nulls, key=_cost), count)


def ring_promises(found: Faint, refiner: Refiner) -> list[Fitted]:
    """Single causes that would explain what is left where the ring cannot be followed further."""
    return [_fitted(found, refiner, one) for one in _more(found, refiner)]


def _weighed(
    refiner: Refiner, led: Sequence[Followed], nothing: Followed, count: int
) -> list[Fitted]:
    """Hypotheses with the evidence of all samples, the best first.

    What the best explains it explains but for its error of form, and so does every other: how
    large that is, is not known, but no larger than what the best leaves may hide.
    """
    best = min(led, key=_cost, default=nothing)
    form = max((refiner.candidates[one].form_share for one in _names(best)), default=0.0)
    explained = _cost(nothing) - min(_cost(best), _cost(nothing))
    hidden = max(best.misfit - count, 0.0) + DOUBT * np.sqrt(2.0 * count)
    fitted = []
    for one in (*led, nothing):
        state = one.state or State(Hypothesis(), refiner.candidates, (), np.zeros(0))
        logs = []
        for size, weight in zip(FORM_SIZES, FORM_WEIGHTS, strict=True):
            noise = 1.0 + min((size * form) ** 2 * explained, hidden) / FORMS
            unlikely = 0.5 * FORMS * np.log(noise) + 0.5 * (best.misfit - count) / noise
            logs.append(np.log(weight) - unlikely - 0.5 * (one.misfit - best.misfit) / noise)
        # No error of form makes parameters likelier that are far from what is known of them.
        strain = 0.5 * float(one.nuisance @ one.nuisance)
        prior = state.hypothesis.log_prior(refiner.candidates)
        score = float(np.logaddexp.reduce(logs)) - strain + prior
        there = refiner.at(state, refiner.directions_of(one.nuisance))
        fitted.append(replace(there, log_score=score, point=one.point, left=one.misfit / count))
    return sorted(fitted, key=lambda one: -one.log_score)


def _misfit(samples: Samples, nuisance: Array, state: State) -> float:
    """Squared misfit of all samples at a state, ring and all."""
    (found,) = samples.residuals([Followed(nuisance, state).point])
    return float(found @ found)


def _cost(led: Followed) -> float:
    """Squared misfit of all samples and of the parameters to their prior."""
    return led.misfit + float(led.nuisance @ led.nuisance)


def _farthest(led: Followed) -> tuple[float, float]:
    """Least for what was followed farthest, and there is closest."""
    return -led.share, _cost(led) if led.share == 1.0 else led.left


def _kin(refiner: Refiner, led: Sequence[Followed], others: Sequence[Fitted]) -> list[Fitted]:
    """Other laws of the things that came as far as the best."""
    if not led:
        return []
    family = {name: one.family for name, one in refiner.candidates.items()}
    best = min(led, key=_farthest)
    far = [
        one
        for one in led
        if one.share == best.share and (one.share < 1.0 or _cost(one) < _cost(best) + BEHIND)
    ]
    known = {_names(one) for one in led}
    kin = {family[name] for one in far for name in _names(one)} - {""}
    found: dict[tuple[str, ...], Fitted] = {}
    for one in others:
        names = one.hypothesis.names
        if names not in known and family[names[0]] in kin:
            found.setdefault(names, one)
    return list(found.values())


def _names(led: Followed) -> tuple[str, ...]:
    return () if led.state is None else led.state.hypothesis.names


def _others(refiner: Refiner, led: Followed) -> list[Candidate]:
    """What may be there beside what is on: no second law of one thing."""
    on = [refiner.candidates[name] for name in _names(led)]
    families = {one.family for one in on} - {""}
    return [
        one
        for one in refiner.candidates.values()
        if not one.fixed and one not in on and one.family not in families
    ]


def _more(found: Faint, refiner: Refiner) -> list[Scored]:
    """One cause more than is on, where the ring promises something, the best first."""
    chosen = {one.name: one for one in _others(refiner, found.followed)}
    state = found.followed.state
    on = Hypothesis() if state is None else state.hypothesis
    screen = Screen(
        found.problem,
        refiner.candidates,
        found.terms,
        on=on,
        done={name: np.zeros(len(found.problem.residual)) for name in on.names},
        own=found.own,
        state=state,
    )
    nothing = screen.null().log_score
    best = [one for one in _best(screen, chosen, on) if one.log_score > nothing + ASKS]
    return [_simpler(screen, one, nothing) for one in best]


def _simpler(screen: Screen, scored: Scored, nothing: float) -> Scored:
    """The same in all places alike, where that promises nearly as much.

    Over a short stretch, and to first order, which places are on is no more than a guess.
    """
    (name,) = set(scored.hypothesis.names) - set(screen.on.names)
    candidate = screen.candidates[name]
    every = tuple(one.name for one in candidate.terms)
    if not candidate.shareable or len(every) < 2 or candidate.together:
        return scored
    part = Part(every, True, scored.hypothesis.parts[name].shapes)
    alike = screen.with_part(name, part)
    return alike if alike.log_score - nothing > NEARLY * (scored.log_score - nothing) else scored


def _nuisance(found: Faint, scored: Scored) -> Array:
    """Where the nuisances would be, in sigmas."""
    moved = found.rotation @ (scored.weighed.nuisance - found.problem.at)
    return np.asarray(found.followed.nuisance + moved)


def _parameters_of(system: System, led: Followed) -> Array:
    """Nuisances that stand for the parameters among what is on, and for nothing else of it."""
    nuisance = led.nuisance.copy()
    if led.state is not None:
        values = led.state.term_values()
        for i, one in enumerate(system.nuisances):
            nuisance[i] += values.get((one.cause or "", one.term or ""), 0.0) / one.sigma
    return nuisance


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
    variant = [dict(one) for one in candidates[name].variants()].index(dict(part.shapes))
    columns = grouped(candidates[name], found.terms[name, variant], part)
    does = columns @ np.array([parent.values[name, group[0]] for group in groups(part)])
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
    )


def _fitted(found: Faint, refiner: Refiner, scored: Scored) -> Fitted:
    """The hypothesis as others are, with the score that the ring gives it."""
    nuisance, state = _nuisance(found, scored), State.of(scored, refiner.candidates)
    fitted = refiner.at(state, refiner.directions_of(nuisance))
    return replace(
        fitted,
        log_score=scored.log_score,
        point=Followed(nuisance, state).point,
        left=found.followed.left,
    )
