"""Numbers of a machine that parameters alone moved farther than what is known of them allows.

A number that explains by itself costs, in the score, its prior odds and the choice among all
numbers that there are: four to six sigmas would be nothing. But it is not one law of forty that may
be left out: it is there, uncertain, and the fit has moved it. Where it moved by three sigmas it is
as likely off as not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit
from scipy.stats import chi2, norm

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import LOG_ODDS, Hypothesis, Part
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.state import State
from analysis.engine.sure import as_sure
from analysis.engine.system import Nuisance, Point, System
from analysis.engine.weights import temper_of

Beside = Mapping[tuple[str, ...], tuple[str, float]]
"""Names of a hypothesis -> which of its causes is a number of the machine that the others moved too
far, and by how many sigmas."""

STANDS_OUT = 2.0
"""Of its numbers those that moved by more than this are released, or the one that moved most."""

EFFORT = 400.0
"""Whole simulations to lead it from there: some three times all differences."""

EVEN = 3.0
"""A number that has moved by so many sigmas is as likely off as not (design, section 6, step 2)."""

CONTENDERS, NEARLY = 4, 0.2
"""Beside so many of the likeliest, that leave no more of a sample, squared, beyond noise."""


def moved_far(nuisances: Sequence[Nuisance], at: Array) -> dict[str, float]:
    """Candidates whose numbers moved by more than `EVEN` sigmas, and by how many.

    Parameters
    ----------
    nuisances
        Of a system.
    at
        Where they are likeliest with nothing left out, in sigmas, shape (nuisances,).

    Returns
    -------
    dict
        Candidate -> sigmas: of the number that moved farthest, or of all of its numbers together,
        as a normal number as unlikely.
    """
    of: dict[str, list[float]] = {}
    for one, sigmas in zip(nuisances, at, strict=True):
        if one.cause is not None:
            of.setdefault(one.cause, []).append(float(sigmas))
    found: dict[str, float] = {}
    for cause, moved in of.items():
        together = float(np.square(moved).sum())
        unlikely = max(float(chi2.sf(together, len(moved))), np.finfo(float).tiny)
        sigmas = max(float(np.abs(moved).max()), float(norm.isf(0.5 * unlikely)))
        if sigmas > EVEN:
            found[cause] = sigmas
    return found


def rise_of(sigmas: float, temper: float) -> float:
    """By how much the score of a number that moved so far is above that of nothing.

    Parameters
    ----------
    sigmas
        By how many sigmas it moved.
    temper
        By which factor scores count for less: one cause more is no likelier for that.
    """
    return 0.5 * (sigmas**2 - EVEN**2) - LOG_ODDS * (temper - 1.0)


def freed(
    system: System, candidates: Mapping[str, Candidate], at: Followed, cause: str
) -> Followed:
    """The same place, with what a cause's numbers have moved by as a cause that is on.

    Parameters
    ----------
    system, candidates
        What is simulated, and its candidates by name.
    at
        Where; the cause is not on there.
    cause
        A candidate whose numbers are nuisances, and have moved.
    """
    nuisance = at.nuisance.copy()
    own = [i for i, one in enumerate(system.nuisances) if one.cause == cause and one.term]
    far = [i for i in own if abs(nuisance[i]) > STANDS_OUT]
    far = far or [max(own, key=lambda i: abs(nuisance[i]))]
    known = {i: system.nuisances[i] for i in far}
    values = {(cause, one.term or ""): float(nuisance[i] * one.sigma) for i, one in known.items()}
    hypothesis = Hypothesis() if at.state is None else at.state.hypothesis
    hypothesis = hypothesis.plus(cause, Part(tuple(one.term or "" for one in known.values())))
    nuisance[far] = 0.0
    on = {} if at.state is None else at.state.term_values()
    return Followed(nuisance, State.at(hypothesis, on | values, candidates))


def released(refiner: Refiner, base: Fitted, cause: str, *, lead: bool = True) -> Fitted:
    """The hypothesis that a cause's numbers are off, led from where they had moved by themselves.

    Its score is that of what was on before, or, where that is more, by what they cost less: how
    likely it is, is told by how far they had moved.

    Parameters
    ----------
    refiner
        Makes it.
    base
        Nothing left out, or what is on beside it, led to the noise.
    cause
        A candidate whose numbers are nuisances, and have moved; it is not on.
    lead
        Whether it is led on from there: what was known of the numbers holds them back no more.
    """
    system = refiner.system
    on = base.state if base.hypothesis.parts else None
    start = freed(system, refiner.candidates, Followed(base.point.nuisance, on), cause)
    led = replace(start, left=base.left)
    if lead:
        led = follow_ring(
            system, start.nuisance, start.state, everything=True, near=True, most=EFFORT
        )
    assert led.state is not None
    there = as_sure(refiner, refiner.standing(led.state, led.nuisance), led, max(base.left, 1.0))
    known = refiner.candidates
    rises = there.hypothesis.log_prior(known) - base.hypothesis.log_prior(known)
    rises += 0.5 * (base.strain - led.strain)
    score = base.log_score + max(rises, 0.0)
    return replace(there, log_score=score, left=min(led.left, base.left))


def released_beside(
    refiner: Refiner, fitted: Sequence[Fitted], noise: float, most_causes: int
) -> tuple[list[Fitted], Beside]:
    """Beside the likeliest hypothesis, and what contends with it, a number that it moved too far.

    Parameters
    ----------
    refiner
        Makes them.
    fitted
        Hypotheses, nothing left out among them.
    noise
        The squared misfit of a sample that noise leaves: what leaves more may be a wrong law, for
        which parameters make up.
    most_causes
        Of a hypothesis.

    Returns
    -------
    list, dict
        Hypotheses that are new, and which of them, old and new, are of that kind.
    """
    nuisances, known = refiner.system.nuisances, refiner.candidates
    likeliest = sorted(fitted, key=lambda one: -one.log_score)
    best = likeliest[0]
    if not (best.hypothesis.parts and best.left < noise):
        return [], {}
    on = [one for one in likeliest if one.hypothesis.parts]
    beside = _led_beside(nuisances, on, noise)
    if len(best.hypothesis.parts) >= most_causes:
        return [], beside
    named = {one.hypothesis.names for one in fitted}
    far = moved_far(nuisances, best.point.nuisance)
    free = far.keys() & known.keys() - set(best.hypothesis.names)
    cause = max(free, key=lambda one: far[one], default="")
    new: list[Fitted] = []
    for one in on[:CONTENDERS] if cause else ():
        fewer = one.hypothesis.names
        sigmas = _moved(nuisances, one.point, cause)
        both = tuple(sorted({*fewer, cause}))
        if both in beside or not (sigmas and one.left < noise + NEARLY and cause not in fewer):
            continue
        beside[both] = cause, sigmas
        if both not in named:
            new.append(released(refiner, one, cause, lead=one is best))
    return new, beside


def _led_beside(
    nuisances: Sequence[Nuisance], likeliest: Sequence[Fitted], noise: float
) -> dict[tuple[str, ...], tuple[str, float]]:
    """Which of the likeliest were led with such a number as one cause more, and still move it."""
    without: dict[tuple[str, ...], Fitted] = {}
    for one in likeliest:
        if one.left < noise + NEARLY:
            without.setdefault(one.hypothesis.names, one)
    found: dict[tuple[str, ...], tuple[str, float]] = {}
    for one in likeliest[:CONTENDERS]:
        both = one.hypothesis.names
        for cause in both:
            fewer = without.get(tuple(name for name in both if name != cause))
            if fewer is not None:
                sigmas = min(_moved(nuisances, led.point, cause) for led in (one, fewer))
                if sigmas > found.get(both, ("", 0.0))[1]:
                    found[both] = cause, sigmas
    return found


def _moved(nuisances: Sequence[Nuisance], at: Point, cause: str) -> float:
    """By how many sigmas a cause's numbers are off, by whatever name; zero: not far."""
    on = at.effects.get(cause)
    moved = at.nuisance.copy()
    for i, one in enumerate(nuisances):
        if on is not None and one.cause == cause and one.term:
            moved[i] += on.values.get(one.term, 0.0) / one.sigma
    return moved_far(nuisances, moved).get(cause, 0.0)


def raised(
    weights: Array,
    fitted: Sequence[Fitted],
    candidates: Mapping[str, Candidate],
    beside: Beside,
) -> Array:
    """Probabilities, a number that moved too far beside others as likely as that says.

    Together with it and without it they are as likely as they were.

    Parameters
    ----------
    weights
        Of each hypothesis, shape (h,).
    fitted, candidates
        The hypotheses, and candidates by name.
    beside
        See `released_beside`.
    """
    found = weights.copy()
    names = [one.hypothesis.names for one in fitted]
    for both, (cause, sigmas) in beside.items():
        fewer = tuple(one for one in both if one != cause)
        on = np.array([one == both for one in names])
        off = np.array([one == fewer for one in names])
        whole = float(found[on | off].sum())
        if not on.any() or whole == 0.0:
            continue
        temper = temper_of(max(candidates[one].form_share for one in fewer))
        share = float(expit(0.5 * (sigmas**2 - EVEN**2) / temper))
        had = float(found[on].sum())
        if had < share * whole:
            found[off] *= (1.0 - share) * whole / (whole - had)
            best = max(np.flatnonzero(on), key=lambda i: fitted[int(i)].log_score)
            found[best] += share * whole - had
    return found
