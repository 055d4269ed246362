"""What all samples say of hypotheses that were led to the ring's phase."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.evidence import FORM_SIZES, FORM_WEIGHTS
from analysis.engine.fitted import Causes, Fitted, by_cause
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.judge import NOISE
from analysis.engine.part import has_several
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.span import FORMS, UNEXPLAINED, inexact
from analysis.engine.state import State
from analysis.engine.sure import as_sure
from analysis.engine.system import System
from analysis.engine.way import LEAVES, STRAIN
from analysis.engine.whiten import noise_expected, noise_leaves

DOUBT = 2.0
"""Standard deviations by which the misfit of all samples may hide an error of form."""

CONTENDS, NO_BETTER = 100.0, 10.0
"""What is no farther behind the best, in squared misfit, is led through with differences of its
own, unless what is on there without one of its causes is as good to within this."""

AS_LIKELY = 3.0
"""The same causes in other places are told of where they are no farther behind: one in twenty."""

WORTH_IT = 30.0
"""Less than this, in squared misfit, is no reason to ask anything again."""

HALFWAY = 0.5
"""What is led once more from elsewhere starts so far from the likeliest parameters."""


def noise_of(system: System) -> float:
    """What noise may leave of a squared sample, on average, and the simulator's own error."""
    return max(noise_leaves(system.bundles), NOISE)


def elsewhere_than(led: Followed) -> Array:
    """Parameters from which to lead once more, shape (p,): not those to which a hollow led."""
    return HALFWAY * led.nuisance


def led_through(system: System, led: Sequence[Followed]) -> list[Followed]:
    """Hypotheses, those that may be the best led on with what nuisances do about themselves.

    Parameters
    ----------
    system
        What is simulated.
    led
        To all samples.
    """
    found = list(led)
    for _ in found:
        least = min(cost_of(one) for one in found) + CONTENDS
        asked = [k for k, one in enumerate(found) if one.borrowed and cost_of(one) < least]
        asked = [k for k in asked if not any(_says_more(found[k], one) for one in found)]
        if not asked:
            break
        place = min(asked, key=lambda k: cost_of(found[k]))
        best = min(found, key=cost_of)
        # What came from another law's parameters may have come to a hollow beside its valley.
        anew = not has_several(system) and _kinds(found[place]) != _kinds(best)
        found[place] = through(system, found[place], anew=anew)
    return found


def through(system: System, one: Followed, *, anew: bool = False) -> Followed:
    """A hypothesis led with what nuisances do about itself, where that was lent.

    Parameters
    ----------
    system
        What is simulated.
    one
        The hypothesis.
    anew
        By growing windows, from the likeliest parameters; else from where it is.
    """
    if not one.borrowed:
        return one
    start = np.zeros_like(one.nuisance) if anew else one.nuisance
    led = follow_ring(system, start, one.state, everything=True, near=not anew)
    return replace(led if cost_of(led) < cost_of(one) else one, borrowed=False)


def shown_the_way(
    system: System, led: Sequence[Followed], before: Sequence[Followed]
) -> list[Followed]:
    """Hypotheses, their rivals led again from the parameters of one that found a better valley.

    Parameters
    ----------
    system
        What is simulated.
    led
        To all samples, and through.
    before
        The same as they were led at first: what contended then may only not have found the way.
    """
    best, least = min(led, key=cost_of), min(map(cost_of, before))
    if cost_of(best) > least - WORTH_IT or has_several(system):
        return list(led)
    found, asked = list(led), {best.names}
    for one in sorted(before, key=cost_of):
        contends = cost_of(one) < least + CONTENDS and one.state is not None
        if not contends or one.names in asked or any(_says_more(one, other) for other in before):
            continue
        asked.add(one.names)
        again = follow_ring(
            system, best.nuisance, one.state, everything=True, near=True, ahead=best.costs,
            lent=best.lends,
        )  # fmt: skip
        found.append(again if cost_of(again) > cost_of(best) + CONTENDS else through(system, again))
    return found


def _kinds(one: Followed) -> list[str]:
    """Families of what is on."""
    if one.state is None:
        return []
    known = one.state.candidates
    return sorted(known[name].kind for name in one.names)


def nothing_again(system: System, nothing: Followed, led: Sequence[Followed]) -> Followed:
    """Nothing on, led once more from where hypotheses have come: one may have found a way.

    Parameters
    ----------
    system
        What is simulated.
    nothing
        How far parameters alone led.
    led
        From where.

    Returns
    -------
    Followed
        The closest.
    """
    found = [nothing]
    contends = min(map(cost_of, led), default=0.0) + CONTENDS
    for one in led:
        if one.to_end:
            start = parameters_of(system, one, one.names)
            # What nuisances do there, not where parameters alone had come to.
            lent = one.lends or nothing.lends
            alone = follow_ring(
                system, start, everything=True, near=True, ahead=one.costs, lent=lent
            )
            found.append(through(system, alone) if cost_of(alone) < contends else alone)
    return min(found, key=cost_of)


def _says_more(one: Followed, other: Followed) -> bool:
    """Whether a hypothesis has a cause more than another, and is hardly closer."""
    return set(other.names) < set(one.names) and cost_of(other) < cost_of(one) + NO_BETTER


def all_samples_say(
    refiner: Refiner, led: Sequence[Followed], nothing: Followed, count: int
) -> list[Fitted]:
    """Hypotheses with the evidence of all samples, the best first.

    What the best explains it explains but for its error of form, and so does every other: how
    large that is, is not known, but no larger than what the best leaves may hide. And of what
    nothing explains, and noise does not allow, a share may lie where causes are looked for.

    Parameters
    ----------
    refiner
        Makes fitted hypotheses of them.
    led
        With causes; of one set in several places, or to several ends, the likeliest counts.
    nothing
        Without any.
    count
        Samples.
    """
    best = min(led, key=cost_of, default=nothing)
    forms = forms_of(refiner, best, nothing, count)
    _, likeliest = max(forms)
    scored: dict[tuple[str, ...], list[tuple[float, State, Followed]]] = {}
    for one in (*led, nothing):
        state = one.state or State(Hypothesis(), refiner.candidates, (), np.zeros(0))
        logs = []
        for likely, noise in forms:
            logs.append(likely - 0.5 * (one.misfit - best.misfit) / noise)
        # No error of form makes parameters likelier that are far from what is known of them.
        strain = 0.5 * float(one.nuisance @ one.nuisance)
        prior = state.hypothesis.log_prior(refiner.candidates)
        score = float(np.logaddexp.reduce(logs)) - strain + prior
        scored.setdefault(one.names, []).append((score, state, one))
    fitted = []
    for same in scored.values():
        same.sort(key=lambda each: -each[0])
        score, state, one = same[0]
        there = refiner.at(state, refiner.directions_of(one.nuisance))
        as_likely = [other for behind, other, _ in same[1:] if behind > score - AS_LIKELY]
        there = as_sure(refiner, there, one, likeliest)
        fitted.append(replace(
            there, log_score=score, point=one.point, left=one.misfit / count,
            elsewhere=_places(as_likely, state),
        ))  # fmt: skip
    return sorted(fitted, key=lambda one: -one.log_score)


def _places(others: Sequence[State], state: State) -> tuple[Causes, ...]:
    """The causes of states that have other places on than one has, each set of places once."""
    seen = {state.hypothesis.key}
    found = []
    for one in others:
        if one.hypothesis.key not in seen:
            seen.add(one.hypothesis.key)
            found.append(by_cause(one.hypothesis.names, one.term_values()))
    return tuple(found)


def forms_of(
    refiner: Refiner, best: Followed, nothing: Followed, count: int
) -> list[tuple[float, float]]:
    """Sizes of the error of form: how likely each is, as a logarithm, and the noise with it.

    Parameters
    ----------
    refiner
        Of the system.
    best, nothing, count
        As for `all_samples_say`.

    Returns
    -------
    list of (float, float)
        Noise is the variance along each direction in which causes are looked for.
    """
    form = max((refiner.candidates[one].form_share for one in best.names), default=0.0)
    explained = cost_of(nothing) - min(cost_of(best), cost_of(nothing))
    # How much of what the best leaves is noise, what is rough of it tells, as far as is expected:
    # strings and jitter are rough as well.
    most = noise_expected(refiner.system.bundles)
    beyond = best.misfit - count * float(np.clip(best.roughness, 1.0, most))
    hidden = max(beyond, 0.0) + DOUBT * np.sqrt(2.0 * count)
    # A hollow beside the valley leaves so much as well: what explains less of it may be its turn.
    hollow = beyond - DOUBT * np.sqrt(2.0 * count)
    allowed = count * noise_of(refiner.system)
    left = min(best.misfit, nothing.misfit) - allowed
    unexplained = UNEXPLAINED * max(left, hollow, 0.0)
    found = []
    for size, weight in zip(FORM_SIZES, FORM_WEIGHTS, strict=True):
        off = min((size * form) ** 2 * explained, hidden) + unexplained
        noise = 1.0 + off / FORMS + inexact(count)
        unlikely = 0.5 * FORMS * np.log(noise) + 0.5 * beyond / noise
        found.append((float(np.log(weight) - unlikely), float(noise)))
    return found


def rise_beside_form(
    refiner: Refiner, best: Followed, nothing: Followed, count: int, explains: float
) -> float:
    """By how much the score would rise, explained the best so much more of the squared misfit.

    Parameters
    ----------
    refiner, best, nothing, count
        As for `forms_of`.
    explains
        Of the squared misfit.
    """
    after = replace(best, misfit=best.misfit - explains)
    _, noise = max(forms_of(refiner, after, nothing, count))
    return 0.5 * explains / noise


def cost_of(led: Followed) -> float:
    """Squared misfit of all samples and of the parameters to their prior."""
    return led.misfit + float(led.nuisance @ led.nuisance)


def misfit_at(samples: Samples, nuisance: Array, state: State) -> float:
    """Squared misfit of all samples at a state, ring and all."""
    (found,) = samples.residuals([Followed(nuisance, state).point])
    return float(found @ found)


def tells_more(best: Followed, nothing: Followed, shares: Array) -> bool:
    """Whether what was led explains to the noise the stretch that parameters alone do not.

    It may not be led farther since what is left out beside it shows in a few samples.

    Parameters
    ----------
    best
        What was led farthest.
    nothing
        How far parameters alone led.
    shares
        Of the time, at which samples lie, shape (n,).
    """
    share, alone = nothing.reached
    count = int((shares <= share).sum())
    most = count + LEAVES * float(np.sqrt(2.0 * count)) + STRAIN
    return best.costs.get(share, np.inf) < most < alone


def farthest_first(led: Followed) -> tuple[float, float]:
    """Least for what was led farthest, and there is closest."""
    share, cost = led.reached
    return -share, cost


def parameters_of(system: System, led: Followed, names: Sequence[str]) -> Array:
    """Nuisances where causes are not on: those that are a cause's own stand for it, as far as led.

    Parameters
    ----------
    system
        What is simulated.
    led
        With the causes on.
    names
        Of the causes.

    Returns
    -------
    Array
        In sigmas, shape (p,).
    """
    nuisance = led.nuisance.copy()
    if led.state is not None:
        values = led.state.term_values()
        for i, one in enumerate(system.nuisances):
            if one.cause is not None and one.cause in names:
                nuisance[i] += values.get((one.cause, one.term or ""), 0.0) / one.sigma
    return nuisance
