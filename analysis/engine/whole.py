"""What is there or not there as a whole, near the noise.

Straight lines about the followed ring tell what a faint cause would do, and what parameters would
do beside it. What is there as a whole, like two cells plugged into each other's channels, need not
be faint where its trace is: parameters that stand where they hide it are far from where they are
without, and do another thing beside it. So each form of it is simulated where straight lines put
the parameters. Where it does as they say, they have told of it already; where it does something
else, and is not lost, parameters are led to where they belong beside it.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from analysis.engine.all_samples import WORTH_IT, cost_of
from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.faint import Faint
from analysis.engine.faint_search import nuisances_of, screen_about
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import Scored, Screen
from analysis.engine.state import State
from analysis.engine.system import System
from analysis.engine.way import LOST

ELSEWHERE, SHARE = 100.0, 0.3
"""Straight lines do not hold where the squared misfit is so much more, or less, than they say, and
by this share of what they say it changes."""

FORMS = 4
"""So many forms of a candidate are led at most, those of which straight lines say most."""

ASKS, POOR = 8.0, 0.2
"""What is said to explain so much beside what is on, squared, is led as it is promised; and what is
said to leave so much more of a sample hides nowhere near."""

ONWARD, EXPLAINS = 0.2, 0.5
"""Of the time: so much farther than parameters alone lead is what is there as a whole from then on
looked for; and there it leaves no more than this share of the squared misfit."""


def whole_guesses(system: System, candidates: Mapping[str, Candidate], found: Faint) -> list[Guess]:
    """Candidates that are there or not, from where they leave least, the best first.

    Parameters
    ----------
    system
        What is simulated.
    candidates
        By name.
    found
        Everything about where parameters alone came, what such candidates do there among it.
    """
    nothing = found.followed
    screen = Screen(found.problem, candidates, found.terms)
    alone = screen.null().log_score
    guesses = []
    for candidate in candidates.values():
        if candidate.fixed:
            does = (found.terms[candidate.name, v] for v in range(len(candidate.variants())))
            forms = [
                (one, _said(found, one, columns[:, 0] * candidate.terms[0].step))
                for one, columns in zip(_forms(screen, candidate), does, strict=True)
            ]
            led = [
                _led(system, one, nothing)
                for one in _bent(system, candidates, candidate, found, forms)
            ]
            best = min((one for one in led if one.to_end), key=cost_of, default=None)
            if best is not None and cost_of(best) < cost_of(nothing) - WORTH_IT:
                assert best.state is not None
                rises = 0.5 * (cost_of(nothing) - cost_of(best))
                guesses.append(Guess(best.state, best.nuisance, alone + rises))
    return sorted(guesses, key=lambda one: -one.log_score)


def whole_onward(
    system: System, candidates: Mapping[str, Candidate], nothing: Followed
) -> list[Guess]:
    """What is there as a whole from where parameters alone foretell nothing more, the best first.

    What begins only then does nothing to what was led so far, and straight lines about it are
    silent. So each form is simulated as it stands, and looked at a little farther.

    Parameters
    ----------
    system
        What is simulated.
    candidates
        By name.
    nothing
        How far parameters alone led.
    """
    share, _ = nothing.reached
    if not 0.0 < share < 1.0:
        return []
    at = nothing.about or nothing
    none = State.at(Hypothesis(), {}, candidates)
    states = [
        none.plus(one.name, Part(terms, False, shapes), {t.name: t.step for t in one.terms})
        for one in candidates.values()
        if one.fixed
        for terms in [tuple(t.name for t in one.terms)]
        for shapes in one.variants()
    ]
    starts = [Followed(at.nuisance, state) for state in (None, *states)]
    samples = Samples(system, everything=True, share=min(share + ONWARD, 1.0))
    alone, *left = [float(one @ one) for one in samples.residuals([one.point for one in starts])]
    guesses = [
        Guess(state, at.nuisance, 0.5 * (alone - one))
        for state, one in zip(states, left, strict=True)
        if one < EXPLAINS * alone
    ]
    return sorted(guesses, key=lambda one: -one.log_score)


def whole_beside(
    system: System, candidates: Mapping[str, Candidate], found: Faint
) -> Iterator[Followed]:
    """What is there or not, led beside what is on, where straight lines do not promise it.

    Parameters
    ----------
    system, candidates
        As for `whole_guesses`.
    found
        Everything about where a hypothesis came to the end, what such candidates do there among it.
    """
    screen = screen_about(found, candidates)
    nothing, noise = screen.null(), float(found.problem.base.mean())
    most = POOR * len(found.seen.residual)
    for candidate in candidates.values():
        if not candidate.fixed or (candidate.name, 0) not in found.terms:
            continue
        said = [
            (one, 2.0 * noise * (nothing.log_score - one.log_score))
            for one in _forms(screen, candidate)
        ]
        near = [(one, rise) for one, rise in said if -ASKS < rise < most]
        for start in _bent(system, candidates, candidate, found, near):
            yield _led(system, start, found.followed)


def _led(system: System, start: Followed, beside: Followed) -> Followed:
    """Parameters led to where they belong beside it, while it may catch up with what was there."""
    return follow_ring(
        system, start.nuisance, start.state, everything=True, near=True, ahead=beside.costs
    )


def _bent(
    system: System,
    candidates: Mapping[str, Candidate],
    candidate: Candidate,
    found: Faint,
    forms: Sequence[tuple[Scored, float]],
) -> list[Followed]:
    """Forms of a candidate that do another thing than straight lines say, and are not lost.

    Each comes with what these say of it: by how much the squared misfit rises.
    """
    samples = Samples(system, everything=True)
    starts = [_with(found.followed, candidate, one, candidates) for one, _ in forms]
    moved = [Followed(nuisances_of(found, one), State.of(one, candidates)) for one, _ in forms]
    here = samples.residuals([one.point for one in starts])
    there = samples.residuals([one.point for one in moved])
    bent = []
    for v, (scored, said) in enumerate(forms):
        really = float(there[v] @ there[v]) - found.followed.misfit
        # What is lost there is no number.
        holds = abs(really - said) <= ELSEWHERE + SHARE * abs(said)
        if not holds and float(np.mean(here[v] ** 2)) < LOST:
            bent.append((scored.log_score, starts[v]))
    bent.sort(key=lambda one: -one[0])
    return [start for _, start in bent[:FORMS]]


def _with(
    about: Followed, candidate: Candidate, scored: Scored, candidates: Mapping[str, Candidate]
) -> Followed:
    """What is on, as it is, and a candidate as a whole, in the form that was weighed."""
    on = about.state or State.at(Hypothesis(), {}, candidates)
    steps = {term.name: term.step for term in candidate.terms}
    part = scored.hypothesis.parts[candidate.name]
    return Followed(about.nuisance, on.plus(candidate.name, part, steps))


def _said(found: Faint, scored: Scored, does: Array) -> float:
    """By how much the squared misfit rises, by straight lines."""
    problem = found.problem
    left = problem.residual - does
    left = left - problem.nuisance @ (scored.weighed.nuisance - problem.at)
    return float(left @ left - problem.residual @ problem.residual)


def _forms(screen: Screen, candidate: Candidate) -> Iterator[Scored]:
    """A candidate in each of its forms."""
    terms = tuple(one.name for one in candidate.terms)
    for shapes in candidate.variants():
        yield screen.with_part(candidate.name, Part(terms, False, shapes))
