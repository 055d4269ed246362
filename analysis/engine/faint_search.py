"""Which faint causes: singles and pairs about the followed ring, and those led to its phase."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.faint import FAINT, FORMS, Faint
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.refine import Fitted, Refiner
from analysis.engine.ring_fit import Followed, follow_ring, residuals, seen
from analysis.engine.screen import Scored, Screen, grouped, groups
from analysis.engine.state import State
from analysis.engine.system import Array, Candidate, Prediction, System

SINGLES, PARENTS, PAIRS = 8, 3, 6
"""So many hypotheses are kept, and so many looked beside."""

RESTARTS = 3
"""Nothing is led to the phase once more from where so many hypotheses have come: one may have found
a way that nothing missed."""


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
    singles = _best(screen, chosen, null)
    pairs: dict[tuple[str, ...], Scored] = {}
    for parent in singles[:PARENTS]:
        if parent.log_score < null.log_score:
            break
        for one in _best(_beside(found, parent, chosen), chosen, parent):
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


def followed_each(
    found: Faint, refiner: Refiner, hypotheses: Sequence[Fitted]
) -> list[Fitted] | None:
    """Hypotheses led to the ring's phase, each for itself; None where none comes to the noise.

    Parameters
    ----------
    found
        The same with nothing on.
    refiner
        Made the hypotheses.
    hypotheses
        Those to try, the null not among them.

    Returns
    -------
    list of Fitted or None
        Their scores are those of all samples, the best first.
    """
    system = refiner.system
    mask = [seen(bundle, everything=True) for bundle in system.bundles]

    def residual(prediction: Prediction) -> Array:
        return residuals(system.bundles, prediction, mask)

    fitted: list[Fitted] = []
    misfits: list[float] = []
    least = np.inf
    led = [
        follow_ring(system, one.point.nuisance, one.state, everything=True) for one in hypotheses
    ]
    nothing = [found.followed, *(follow_ring(system, _parameters_of(system, one), everything=True,
                                             near=True) for one in led[:RESTARTS])]  # fmt: skip
    for one in (*led, *nothing):
        (left,) = system.simulate([one.point], residual)
        least = min(least, float(np.mean(left**2)))
        state = one.state or State(Hypothesis(), refiner.candidates, (), np.zeros(0))
        fitted.append(refiner.at(state, refiner.directions_of(one.nuisance)))
        misfits.append(float(left @ left + one.nuisance @ one.nuisance))
    if least > FAINT:
        return None
    names = fitted[int(np.argmin(misfits))].hypothesis.names
    form = max((refiner.candidates[name].form_share for name in names), default=0.0)
    # What the best explains it explains but for its error of form, and so does every other.
    least_nothing = min(misfits[len(led) :])
    noise = 1.0 + form**2 * (least_nothing - min(misfits)) / FORMS
    scored = [
        replace(one, log_score=one.hypothesis.log_prior(refiner.candidates) - 0.5 * misfit / noise)
        for one, misfit in zip(fitted, misfits, strict=True)
    ]
    ordered = sorted(scored, key=lambda one: -one.log_score)
    nulls = [one for one in ordered if not one.hypothesis.parts]
    return [one for one in ordered if one not in nulls[1:]]


def _parameters_of(system: System, led: Followed) -> Array:
    """Nuisances that stand for the parameters among what is on, and for nothing else of it."""
    nuisance = led.nuisance.copy()
    if led.state is not None:
        values = led.state.term_values()
        for i, one in enumerate(system.nuisances):
            nuisance[i] += values.get((one.cause or "", one.term or ""), 0.0) / one.sigma
    return nuisance


def _best(screen: Screen, candidates: Mapping[str, Candidate], parent: Scored) -> list[Scored]:
    families = {candidates[name].family for name in parent.hypothesis.names} - {""}
    scored = [
        screen.best_of(name)
        for name, one in candidates.items()
        if name not in parent.hypothesis.parts and one.family not in families
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
    moved = found.rotation @ (scored.weighed.nuisance - found.problem.at)
    nuisance = refiner.directions_of(found.followed.nuisance + moved)
    fitted = refiner.at(State.of(scored, refiner.candidates), nuisance)
    return replace(fitted, log_score=scored.log_score)
