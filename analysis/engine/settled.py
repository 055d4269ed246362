"""Hypotheses brought to where they stay, all by one measure, before they are compared.

What parameters do is known about the nominal simulation. At forty decibels of signal over noise a
parameter that is one standard deviation off bends it more than the noise: a hypothesis weighed by
what parameters did elsewhere is not at its best, and loses against any law that takes back a little
of what that misses, nothing above all. So the likeliest, and nothing, are fitted once more with
everything simulated anew, and what they leave is counted in noise alone.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.cause import within_sigma
from analysis.engine.doubt import squares_of
from analysis.engine.finder import SMALL
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.judge import NOISE
from analysis.engine.moved import freed, moved_far
from analysis.engine.refine import FAR_SIGMAS, SETTLED, Refiner
from analysis.engine.state import State
from analysis.engine.variance import base_variance

MOST = 10
"""So many of the likeliest hypotheses are brought to where they stay, beside nothing."""

FAR_BEHIND = 60.0
"""And what may still come before them: it is no farther behind the best than this, the most that a
screened hypothesis may be behind to be fitted to the end."""

AT_MOST = 20
"""But no more than this in all: a simulation takes its time."""

PASSES = 2
"""Of holding hypotheses against those of one cause less."""

WORTH = 12.0
"""What is so far behind the best, as screening has it, may be what the best is made of."""

RUNG = 3.0
"""Sizes of a law that are tried differ by this."""

EXACT = 5
"""So many of the likeliest are tried as if their laws were exact."""

TURNS = 3
"""A fit that ends at another place than it began is begun there again, so often."""

Key = tuple[object, ...]


def settled(
    refiner: Refiner, null: Fitted, fitted: Sequence[Fitted], *, as_they_are: bool = False
) -> list[Fitted]:
    """Nothing and the likeliest hypotheses where they stay, the best first.

    Parameters
    ----------
    refiner
        Fits with everything simulated anew.
    null
        Nothing on.
    fitted
        Hypotheses, the best first.
    as_they_are
        They were fitted with everything simulated anew: they stay where they are.
    """
    waiting = [one for one in fitted if one.hypothesis.parts]
    done = {null.hypothesis.key: _at_rest(refiner, null, -np.inf)}
    while waiting and len(done) <= AT_MOST:
        best = max(one.log_score for one in done.values())
        if len(done) > MOST and waiting[0].log_score < best - FAR_BEHIND:
            break
        one = waiting.pop(0)
        stays = one if as_they_are else _at_rest(refiner, one, best - FAR_BEHIND)
        done[one.hypothesis.key] = stays
    held: set[Key] = set()
    for _ in range(PASSES):
        if not _nested(refiner, done, held):
            break
    known = {one.hypothesis.names for one in done.values()}
    found = [counted(refiner, one, refiner.settle(one)) for one in done.values()]
    found.sort(key=lambda one: -one.log_score)
    for one in _freed(refiner, found[:EXACT], known):
        found.append(counted(refiner, one, refiner.settle(one)))
    found.sort(key=lambda one: -one.log_score)
    fine = refiner.finely()
    nothing = next(k for k, one in enumerate(found) if not one.hypothesis.parts)
    for k in {*range(min(EXACT, len(found))), nothing}:
        found[k] = polished(fine, found[k])
    found.sort(key=lambda one: -one.log_score)
    found = [*found, *_without_idle(fine, found[:EXACT], found)]
    found.sort(key=lambda one: -one.log_score)
    found[:EXACT] = [_exactly(fine, one) for one in found[:EXACT]]
    # What was fitted with older columns, and is far behind, is counted where it is.
    found += [counted(refiner, one, one) for one in waiting if one.hypothesis.names not in known]
    return sorted(found, key=lambda one: -one.log_score)


def _freed(
    refiner: Refiner, fitted: Sequence[Fitted], known: set[tuple[str, ...]]
) -> Iterator[Fitted]:
    """Hypotheses with what moved too far in others as a cause of its own, where none has that.

    Nothing is searched for it: the simulation is the same, and what it costs is not.
    """
    for one in fitted:
        at = Followed(one.point.nuisance, one.state)
        for cause in moved_far(refiner.system.nuisances, at.nuisance):
            names = tuple(sorted({*one.hypothesis.names, cause}))
            if cause in refiner.candidates and names not in known:
                known.add(names)
                start = freed(refiner.system, refiner.candidates, at, cause)
                assert start.state is not None
                there = refiner.at(start.state, refiner.directions_of(start.nuisance))
                yield rested(refiner, there)


def rested(refiner: Refiner, start: Fitted, at_least: float = -np.inf) -> Fitted:
    """A hypothesis where it stays.

    Parameters
    ----------
    refiner
        Fits with everything simulated anew.
    start
        From where.
    at_least
        As for `Refiner.fit`.
    """
    best = start
    for _ in range(TURNS):
        found = refiner.settle(refiner.again(best, best.problem.used, at_least))
        if not found.log_score > best.log_score + SETTLED:
            # What fits better as it stands may be less likely, its form forgiven.
            return found if found.log_score > best.log_score - SETTLED else best
        best = found
        if best.log_score < at_least:
            break
    return best


def _nested(refiner: Refiner, done: dict[Key, Fitted], held: set[Key]) -> bool:
    """Whether any hypothesis came farther from where one with a cause less, or more, has come.

    What is there at next to no size explains nothing: where it makes a hypothesis likelier all the
    same, the one without has not come to where it is likeliest. Nor has a hypothesis that explains
    less than one without one of its causes.
    """
    better = False
    best = max(one.log_score for one in done.values())
    for larger in list(done.values()):
        for name in larger.hypothesis.names:
            rest = larger.hypothesis.without(name).names
            fewer = [one for one in done.values() if one.hypothesis.names == rest]
            smaller = max(fewer, key=lambda one: one.log_score, default=None)
            starts = []
            # The likeliest is held against what it is without each of its causes.
            contends = (
                larger.log_score > best - WORTH and (larger.hypothesis.names, rest) not in held
            )
            if within_sigma(larger, name) or contends:
                held.add((larger.hypothesis.names, rest))
                starts.append(refiner.at(larger.state.without(name), larger.problem.at))
            if smaller is not None and _evidence(refiner, larger) < (
                _evidence(refiner, smaller) - SETTLED
            ):
                starts += _with_a_little(refiner, smaller, larger, name)
            for start in starts:
                before = done.get(start.hypothesis.key)
                least = -np.inf if before is None else before.log_score + SETTLED
                tried = rested(refiner, start, least)
                if tried.log_score > least:
                    done[tried.hypothesis.key] = tried
                    better = True
    return better


def _with_a_little(refiner: Refiner, smaller: Fitted, larger: Fitted, name: str) -> list[Fitted]:
    """A hypothesis begun where one without one of its causes is, with a little of that."""
    part = larger.hypothesis.parts[name]
    hypothesis = smaller.hypothesis.plus(name, part)
    found = []
    for share in (SMALL, -SMALL):
        size = {(name, t.name): share * t.step for t in refiner.candidates[name].terms}
        own = {one: value for one, value in size.items() if one[1] in part.terms}
        state = State.at(hypothesis, {**smaller.values, **own}, refiner.candidates)
        found.append(refiner.at(state, smaller.problem.at))
    return found[:1] if np.array_equal(found[0].state.values, found[1].state.values) else found


def _evidence(refiner: Refiner, fitted: Fitted) -> float:
    """What the data say alone."""
    return fitted.log_score - fitted.hypothesis.log_prior(refiner.candidates)


def _at_rest(refiner: Refiner, fitted: Fitted, at_least: float) -> Fitted:
    """From where it stands, and where parameters were dragged far, from the likeliest as well."""
    nuisance = fitted.point.nuisance
    starts = [nuisance]
    if np.abs(nuisance).max(initial=0.0) > FAR_SIGMAS or not fitted.hypothesis.parts:
        starts.append(np.zeros_like(nuisance))
    states = [fitted.state for _ in starts]
    rung = _on_ladder(refiner, fitted)
    if rung is not None:
        states.append(rung)
        starts.append(np.zeros_like(nuisance))
    other = _of_other_shape(refiner, fitted)
    if other is not None:
        states.append(other)
        starts.append(nuisance)
    begun = (
        refiner.at(state, refiner.directions_of(one))
        for state, one in zip(states, starts, strict=True)
    )
    found = [rested(refiner, one, at_least) for one in begun]
    return max(found, key=lambda one: one.log_score)


def _on_ladder(refiner: Refiner, fitted: Fitted) -> State | None:
    """A size at which one cause alone, parameters at their likeliest, fits better than where it is.

    Screening knows what a little of a law does. Of one that bends what is simulated by a thousand
    times the noise, a fit from there ends in a hollow: sizes from that of screening to the largest
    are tried.
    """
    if len(fitted.hypothesis.parts) != 1:
        return None
    (name,) = fitted.hypothesis.parts
    candidate = refiner.candidates[name]
    if candidate.fixed:
        return None
    known = refiner.directions_of(np.zeros_like(fitted.point.nuisance))
    best, least = None, refiner.score_at(fitted.state, refiner.directions_of(fitted.point.nuisance))
    on = [one for one in candidate.terms if one.name in fitted.hypothesis.parts[name].terms]
    for sign in (1.0, -1.0):
        size = sign
        while any(one.low <= size * one.step <= one.high for one in on):
            values = {(name, one.name): size * one.step for one in on}
            state = State.at(fitted.hypothesis, values, refiner.candidates)
            score = refiner.score_at(state, known)
            if score > least:
                best, least = state, score
            size *= RUNG
    return best


def _of_other_shape(refiner: Refiner, fitted: Fitted) -> State | None:
    """Another of the values at which a shape is screened, where that fits better as it stands.

    A moment that was screened at a wrong one, beside what was not on yet, stays in a hollow there:
    what is simulated changes between the two alone.
    """
    at = refiner.directions_of(fitted.point.nuisance)
    state = best = fitted.state
    least = refiner.score_at(state, at)
    for name, part in state.hypothesis.parts.items():
        for shape in refiner.candidates[name].shapes_of(part.terms):
            for value in () if shape.whole else shape.grid:
                formed = replace(part, shapes={**part.shapes, shape.name: value})
                tried = State.at(
                    state.hypothesis.plus(name, formed), state.term_values(), refiner.candidates
                )
                score = refiner.score_at(tried, at)
                if score > least:
                    best, least = tried, score
    return None if best is state else best


def _without_idle(
    fine: Refiner, polished: Sequence[Fitted], known: Sequence[Fitted]
) -> Iterator[Fitted]:
    """What was polished to where one of its causes is next to nothing, without that.

    The others may have come there beside it alone.
    """
    for one in polished:
        for name in one.hypothesis.names:
            if len(one.hypothesis.parts) > 1 and within_sigma(one, name):
                rest = one.hypothesis.without(name).names
                same = [other.log_score for other in known if other.hypothesis.names == rest]
                there = rested(fine, fine.at(one.state.without(name), one.problem.at))
                if there.log_score > max(same, default=-np.inf) + SETTLED:
                    yield counted(fine, there, there)


def _exactly(refiner: Refiner, fitted: Fitted) -> Fitted:
    """Where it stays if its laws are exact, where that leaves no more than noise; else as it is.

    Beside an error of form the recording counts for little, and parameters stay where they are
    likeliest beforehand: with what a law leaves there it would be doubted. One that leaves no more
    than noise anywhere has no such error.
    """
    forms = [refiner.candidates[name].form_share for name in fitted.hypothesis.names]
    if fitted.left < NOISE or not max(forms, default=0.0):
        return fitted
    exact = refiner.exact()
    there = rested(exact, exact.at(fitted.state, fitted.problem.at))
    found = refiner.at(there.state, there.problem.at)
    found = counted(refiner, found, found)
    if not found.left < NOISE:
        return fitted
    return replace(found, log_score=max(found.log_score, fitted.log_score))


def polished(fine: Refiner, fitted: Fitted) -> Fitted:
    """Where it stays by fine differences, if it is likelier there, or as likely and leaves less.

    What leaves no more than noise may is there.
    """
    if fitted.left < NOISE:
        return fitted
    there = rested(fine, fine.at(fitted.state, fitted.problem.at))
    found = counted(fine, there, there)
    ahead = found.log_score - fitted.log_score
    less = squares_of(found) < squares_of(fitted) - SETTLED
    return found if ahead > SETTLED or (less and ahead > -SETTLED) else fitted


def counted(refiner: Refiner, fitted: Fitted, there: Fitted) -> Fitted:
    """Where its nuisances are likeliest, with what it leaves there.

    That is of a feature, squared, in noise and the simulator's own error.
    """
    used = there.problem.used
    variance = base_variance(refiner.lens, there.features, refiner.data)
    left = float(np.mean(there.problem.residual[used] ** 2 / variance[used]))
    if not np.isfinite(fitted.log_score):
        return replace(fitted, left=np.inf)
    return replace(there, log_score=fitted.log_score, left=left)
