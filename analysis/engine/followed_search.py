"""Hypotheses led to the ring's phase, each for itself, and what all samples then say of them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.evidence import FORM_SIZES, FORM_WEIGHTS
from analysis.engine.faint import FORMS, faint
from analysis.engine.faint_search import nuisances_of, one_more, others_beside
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import BEHIND, FAINT, LOST, follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.sensitivity import Progress
from analysis.engine.sharpen import sharpened
from analysis.engine.state import State
from analysis.engine.system import Array, System

RESTARTS = 3
"""Nothing is led to the phase once more from where so many hypotheses have come: one may have found
a way that nothing missed."""

MORE = 2
"""Beside the best that was led to the phase, so many are tried with one cause more."""

EFFORT = 4000.0
"""Whole simulations, after which nothing new is tried."""

EARLY = 0.15
"""Where none of the first that were tried can be led this far, as a share of the time, no ring can
be followed in this recording."""

FAR_BEHIND = 15.0
"""Near the ring's phase, other laws of one thing that promise to stay this far behind are not led
there."""

DOUBT = 2.0
"""Standard deviations by which the misfit of all samples may hide an error of form."""


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
    if led and min(led, key=_farthest).reached[0] < EARLY:
        return None
    least = max((one.log_score for one in hypotheses), default=0.0) - FAR_BEHIND
    for one in _kin(refiner, led, others):
        if (not near or one.log_score > least) and _spent(led) < EFFORT:
            lead(one.point.nuisance, one.state, near=near)
    for _ in range(most_causes - 1):
        best = min(led, key=_farthest, default=nothing)
        if best.left > LOST or len(best.names) >= most_causes or _spent(led) > EFFORT:
            break
        tried = {one.names for one in led}
        found = faint(system, best, others_beside(refiner, best))
        for scored in one_more(found, refiner)[:MORE]:
            if scored.hypothesis.names not in tried:
                state = State.of(scored, refiner.candidates)
                lead(nuisances_of(found, scored), state, near=best.reached[0] == 1.0)
        if min(led, key=_farthest, default=nothing) is best:
            break
    nulls = [nothing]
    for way in sorted(led, key=_farthest)[: RESTARTS if nothing.left < LOST else 0]:
        start = _parameters_of(system, way)
        nulls.append(follow_ring(system, start, everything=True, near=True))
    if min(one.misfit for one in (*led, *nulls)) > FAINT * count:
        return None
    return _weighed(refiner, led, min(nulls, key=_cost), count)


def _weighed(
    refiner: Refiner, led: Sequence[Followed], nothing: Followed, count: int
) -> list[Fitted]:
    """Hypotheses with the evidence of all samples, the best first.

    What the best explains it explains but for its error of form, and so does every other: how
    large that is, is not known, but no larger than what the best leaves may hide.
    """
    best = min(led, key=_cost, default=nothing)
    form = max((refiner.candidates[one].form_share for one in best.names), default=0.0)
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


def _spent(led: Sequence[Followed]) -> float:
    """Whole simulations that following took."""
    return sum(one.effort for one in led)


def _farthest(led: Followed) -> tuple[float, float]:
    """Least for what was led farthest, and there is closest."""
    share, cost = led.reached
    return -share, cost


def _kin(refiner: Refiner, led: Sequence[Followed], others: Sequence[Fitted]) -> list[Fitted]:
    """Other laws of the things that came as far as the best."""
    if not led:
        return []
    family = {name: one.family for name, one in refiner.candidates.items()}
    share, cost = min(led, key=_farthest).reached
    far = [one for one in led if one.reached[0] == share and one.reached[1] < cost + BEHIND]
    known = {one.names for one in led}
    kin = {family[name] for one in far for name in one.names} - {""}
    found: dict[tuple[str, ...], Fitted] = {}
    for one in others:
        names = one.hypothesis.names
        if names not in known and family[names[0]] in kin:
            found.setdefault(names, one)
    return list(found.values())


def _parameters_of(system: System, led: Followed) -> Array:
    """Nuisances that stand for the parameters among what is on, and for nothing else of it."""
    nuisance = led.nuisance.copy()
    if led.state is not None:
        values = led.state.term_values()
        for i, one in enumerate(system.nuisances):
            nuisance[i] += values.get((one.cause or "", one.term or ""), 0.0) / one.sigma
    return nuisance
