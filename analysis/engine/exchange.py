"""Rivals by exchange: what else explains about as well what a cause does.

About a hypothesis, differences tell what each other candidate does. What a cause that is on does is
given back to what is left to explain, and each other candidate is asked for it, parameters as free
as they are: no simulation is needed. A cause that parameters had to be bent for is so told from one
that they need not be.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.all_samples import WORTH_IT, cost_of, noise_of
from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.faint import Faint
from analysis.engine.faint_search import nuisances_of
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Part
from analysis.engine.instead import begun_instead, instead
from analysis.engine.kin import lead_from
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import Scored, Screen
from analysis.engine.state import State
from analysis.engine.system import System

BEHIND = 15.0
"""What promises to stay this far behind the cause that it stands for is no rival of it,"""

NEARLY = 0.9
"""unless it explains this share of what that does: the more there is, the less straight lines are
to be trusted."""

CLOSE = 60.0
"""What came as near as this to the best of all, in squared misfit, is in the right places."""

MOST = 3
"""So many rivals are led from one hypothesis."""


class Exchange(NamedTuple):
    """A hypothesis with another cause in the place of one that is on.

    Attributes
    ----------
    ahead
        By how much its score is promised to lie above that of the cause it stands for.
    scored
        The hypothesis.
    """

    ahead: float
    scored: Scored


def exchanged(found: Faint, candidates: Mapping[str, Candidate]) -> list[Exchange]:
    """Hypotheses with another cause in the place of one that is on, the best first.

    Parameters
    ----------
    found
        About a hypothesis that was led to the end, at its end; of what is not there in `terms`
        nothing is asked.
    candidates
        By name.
    """
    state = found.followed.state
    promised: dict[tuple[str, ...], Exchange] = {}
    on = () if state is None else state.hypothesis.names
    for name in on:
        if candidates[name].fixed:
            continue
        # Its own kin is led from where it came to.
        family, screen = candidates[name].family, without(found, candidates, name)
        itself, nothing = _itself(found, candidates, name), screen.null()
        explains = itself.log_score - nothing.log_score
        if explains < BEHIND:
            continue
        least = itself.log_score - max(BEHIND, (1.0 - NEARLY) * explains)
        for other in dict.fromkeys(one for one, _ in found.terms):
            if other in on or (family and candidates[other].family == family):
                continue
            one = screen.best_of(other)
            if one is not None and one.log_score > least:
                ahead = one.log_score - itself.log_score
                known = promised.get(one.hypothesis.names)
                if known is None or ahead > known.ahead:
                    promised[one.hypothesis.names] = Exchange(ahead, one)
    return sorted(promised.values(), key=lambda one: -one.ahead)


def fresh(promised: Sequence[Exchange], led: Sequence[Followed]) -> list[Exchange]:
    """Those to lead, the best first: not what came near to the best of all, nor to the end there.

    What stays far behind may have been in other places than those where it is promised now.
    """
    ends = [one for one in led if one.to_end]
    least = min((cost_of(one) for one in ends), default=0.0)
    close = {one.names for one in ends if cost_of(one) < least + CLOSE}
    there = {one.state.hypothesis.key for one in ends if one.state is not None}
    left = (one for one in promised if one.scored.hypothesis.names not in close)
    return [one for one in left if one.scored.hypothesis.key not in there][:MOST]


def rivals(
    system: System,
    found: Faint,
    candidates: Mapping[str, Candidate],
    promised: Sequence[Exchange],
) -> Iterator[Followed]:
    """Lead what promises about as much as a cause that is on, from where straight lines say.

    Parameters
    ----------
    system
        What is simulated.
    found, candidates
        As for `exchanged`.
    promised
        What to lead.
    """
    for _, one in promised:
        state, law = State.of(one, candidates), found.followed
        led = lead_from(system, law, state, nuisances_of(found, one))
        if not (led.to_end and led.left < noise_of(system)):
            # Straight lines go far along what tells little, and may miss the valley.
            closer = _as_strong(system, law, state, same=True)
            start, again = closer or state, closer is None
            other = lead_from(system, law, start, law.nuisance, again=again)
            led = min(led, other, key=cost_of)
        if led.left < noise_of(system) and cost_of(led) > cost_of(law) + WORTH_IT:
            # In few places by straight lines, and parameters make up for the others.
            there = _as_strong(system, law, state, same=False)
            if there is not None:
                anew = follow_ring(system, np.zeros_like(law.nuisance), there, everything=True)
                led = min(led, anew, key=cost_of)
        yield led
        # What stands for a cause that is in no place is as likely to be in all of its own.
        alike = state if led.state is None else led.state.alike()
        if led.left < noise_of(system) and alike is not led.state and not _has_places(law, one):
            yield lead_from(system, led, alike)


def _has_places(law: Followed, rival: Scored) -> bool:
    """Whether the cause that a rival stands for may be in some of several places."""
    assert law.state is not None
    (known,) = {*law.names} - {*rival.hypothesis.names}
    return law.state.candidates[known].spreads


def _as_strong(system: System, law: Followed, state: State, *, same: bool) -> State | None:
    """A rival in the places of the cause that it stands for, as strong as that.

    Nor has it more than one number in a place: how those share what it does, straight lines tell.

    Parameters
    ----------
    system, law
        With that cause.
    state
        With the rival, in the places that straight lines say.
    same
        Whether these are the same; None: they are not, or are.
    """
    on = state.hypothesis.names
    (known,), (other,) = ({*law.names} - {*on}, {*on} - {*law.names})
    candidate = state.candidates[other]
    one_each = len({one.place for one in candidate.terms}) == len(candidate.terms)
    if candidate.fixed or not one_each:
        return None
    assert law.state is not None
    there = instead(law.state, known, other)
    if there is None or (there.hypothesis.key == state.hypothesis.key) is not same:
        return None
    return begun_instead(Samples(system, everything=True), law, known, other)


def plainest(
    led: Sequence[Followed], most: float, candidates: Mapping[str, Candidate]
) -> Followed | None:
    """What has the fewest causes, of what came to the end and costs less than so much.

    None: that has none that could be exchanged.
    """
    found = [one for one in led if one.names and one.to_end and cost_of(one) < most]
    plain = min(found, key=lambda one: (len(one.names), cost_of(one)), default=None)
    asks = plain is not None and any(not candidates[name].fixed for name in plain.names)
    return plain if asks else None


def without(
    found: Faint, candidates: Mapping[str, Candidate], name: str, itself: Array | None = None
) -> Screen:
    """What is to be explained where a cause is taken off and what it does is given back.

    Parameters
    ----------
    found, candidates
        As for `exchanged`.
    name
        The cause.
    itself
        Columns of its terms, to be asked for what it does itself, shape (f, k).
    """
    state = found.followed.state
    assert state is not None
    magnitudes, values = _magnitudes(state, name)
    residual = found.problem.residual + found.own[name][:, magnitudes] @ values
    on = state.hypothesis.without(name)
    return Screen(
        replace(found.problem, residual=residual),
        candidates,
        found.terms if itself is None else {(name, 0): itself},
        on=on,
        done={one: np.zeros(len(residual)) for one in on.names},
        own={one: columns for one, columns in found.own.items() if one != name},
        state=state.without(name) if on.parts else None,
    )


def _itself(found: Faint, candidates: Mapping[str, Candidate], name: str) -> Scored:
    """The cause, asked as the others are."""
    state = found.followed.state
    assert state is not None
    magnitudes, _ = _magnitudes(state, name)
    terms = [one.name for one in candidates[name].terms]
    part = state.hypothesis.parts[name]
    columns = np.zeros((len(found.problem.residual), len(terms)))
    for group, place in zip(part.groups(candidates[name]), magnitudes, strict=True):
        columns[:, terms.index(group[0])] = found.own[name][:, place]
    asked = Part(part.terms, part.shared, candidates[name].variants()[0])
    return without(found, candidates, name, columns).with_part(name, asked)


def _magnitudes(state: State, name: str) -> tuple[list[int], Array]:
    """Which of a cause's free numbers are magnitudes, and their values, shape (k,)."""
    places = [state.free[k] for k in state.places(name)]
    found = [k for k, i in enumerate(places) if state.numbers[i].shape is None]
    return found, state.values[[places[k] for k in found]]
