"""What lines tell, the ring left out; of what rings, led to the ring's phase from there."""

from collections.abc import Sequence

import numpy as np

from analysis.engine.finder import Finder, Tell
from analysis.engine.fitted import Fitted
from analysis.engine.found import Found, Led
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.more_leader import FAR_BEHIND
from analysis.engine.refine import Refiner
from analysis.engine.sensitivity import Columns, term_columns
from analysis.engine.state import State
from analysis.engine.survey import bends, sticks

FOLLOWED = 2
"""Of what the ring promises, and of what is likely without it, so many are led to its phase."""

UNLIKELY, SEEN = 6.0, 8.0
"""What is this far behind nothing, without the ring, is not likely; and what is so far before that,
is seen without it."""

AS_LIKELY, MOST_AS_LIKELY = 0.01, 3
"""Of the laws of what is likeliest by lines so many are led that are this share of what it explains
behind it."""

LITTLE = 1e-3
"""Of its step: a cable that hangs slack may have no length to spare."""


def by_lines(
    refiner: Refiner, null: Fitted, most_causes: int, tell: Tell | None, led: Led | None
) -> Found:
    """By lines, the ring left out; what is found there is led to the phase of the ring, if any.

    Parameters
    ----------
    refiner
        Fits hypotheses.
    null
        Nothing left out, parameters fitted.
    most_causes
        Of a hypothesis.
    tell
        Told of progress.
    led
        What was led to the ring's phase before; None: the ring is not asked. Where something is
        enough, there are no hypotheses.
    """
    finder = Finder(refiner, _terms(refiner, tell), tell)
    singles = finder.singles(null)
    shown = _shown(refiner)
    if led is not None and shown is not None:
        # What samples show, and could not be followed with that either, lines tell no better.
        ranked = [shown, *finder.ranked()]
        return Found(singles, ranked, faint=False, foretells=led.search.foretells)
    alone = _guesses(finder.ranked())
    if led is not None:
        likely = _to_follow(refiner, null, led.single, alone)
        # Lines may tell nothing of what the first moments of a motion tell.
        told = [*(likely or led.single[:FOLLOWED]), *_as_likely(refiner, null, alone)]
        led.search.follow(told, [*alone, *led.single], seen=True)
        if led.search.ended:
            return Found(singles, (), faint=True)
        bent = [one for one in alone if bends(one.state) and sticks(one.state)]
        if likely and bent and _is_nowhere(led):
            # What bends with its size, and lines and a short ring tell badly, is led by a survey.
            led.search.follow(bent, [], seen=True)
        poor = not led.search.arrived or led.search.is_poor
        if poor and led.search.foretells is None:
            led.search.follow(_both(refiner, null, led.single, alone), [], seen=True)
        if led.search.foretells is not None:
            ranked = finder.ranked()
            return Found(singles, ranked, faint=False, foretells=led.search.foretells)
    if led is None or not led.search.arrived:
        finder.sets(most_causes)
    ranked = finder.ranked()
    if led is None:
        return Found(singles, ranked, faint=False)
    if not led.search.arrived:
        led.search.follow(_to_follow(refiner, null, (), _guesses(ranked)), alone, seen=True)
        if ranked[0].log_score > null.log_score + SEEN:
            led.search.follow_beside(ranked[0].hypothesis.names)
    rung = led.search.fitted()
    return Found(singles, rung or ranked, faint=rung is not None)


def _is_nowhere(led: Led) -> bool:
    """Whether nothing leads to the end, nor foretells a part of the time."""
    return not led.search.arrived and led.search.foretells is None


def _shown(refiner: Refiner) -> Fitted | None:
    """What samples show by themselves, as little of it as there can be; None: nothing.

    Parameters are where they are likeliest beforehand: what could not be followed tells none.
    """
    parts: dict[str, Part] = {}
    values: dict[tuple[str, str], float] = {}
    for name, one in refiner.candidates.items():
        if one.shown:
            parts[name] = Part(one.shown, shapes={each.name: each.default for each in one.shapes})
            values |= {(name, each.name): LITTLE * each.step for each in one.terms}
    if not parts:
        return None
    state = State.at(Hypothesis(parts), values, refiner.candidates)
    likeliest = np.zeros(len(refiner.system.nuisances))
    return refiner.at(state, refiner.directions_of(likeliest))


def _guesses(ranked: Sequence[Fitted]) -> list[Guess]:
    return [Guess.of(one) for one in ranked if one.hypothesis.parts]


def _terms(refiner: Refiner, tell: Tell | None) -> Columns:
    """What every candidate would do to the lines."""

    def causes(done: int, total: int) -> None:
        if tell is not None:
            tell("simulating what each cause would do", done, total)

    found, system = refiner.calibrated, refiner.system
    return term_columns(system, refiner.lens, system.candidates, found.at, found.columns, causes)


def _to_follow(
    refiner: Refiner,
    null: Fitted,
    promises: Sequence[Guess],
    ranked: Sequence[Guess],
) -> list[Guess]:
    """Hypotheses worth leading to the ring's phase, one for each set of candidates.

    What the ring promises, and what is likely without it: of laws of one thing the likeliest.
    """
    least = null.log_score - UNLIKELY
    kinds: dict[frozenset[str], Guess] = {}
    for one in ranked:
        if one.log_score > least:
            kinds.setdefault(_kind(refiner, one), one)
    likely = list(kinds.values())[:FOLLOWED]
    # Which places are on, lines tell better, where they tell anything.
    seen = {one.hypothesis.names: one for one in reversed(ranked) if one.log_score > least + SEEN}
    most = max((one.log_score for one in promises), default=0.0) - FAR_BEHIND
    told = [one for one in promises[:FOLLOWED] if one.log_score > most]
    known = (*(seen.get(one.hypothesis.names, one) for one in told), *likely)
    tried: dict[tuple[str, ...], Guess] = {}
    for one in known:
        tried.setdefault(one.hypothesis.names, one)
    return list(tried.values())


def _as_likely(refiner: Refiner, null: Fitted, ranked: Sequence[Guess]) -> list[Guess]:
    """Laws of what is likeliest that lines do not tell from it: one for each, the likeliest first.

    A law's error of form is a share of what it explains, so much are the others not behind.
    """
    if not ranked:
        return []
    first = ranked[0]
    behind = AS_LIKELY * (first.log_score - null.log_score)
    kin: dict[tuple[str, ...], Guess] = {}
    for one in ranked:
        if (
            _kind(refiner, one) == _kind(refiner, first)
            and one.log_score > first.log_score - behind
        ):
            kin.setdefault(one.hypothesis.names, one)
    return list(kin.values())[:MOST_AS_LIKELY]


def _both(
    refiner: Refiner, null: Fitted, promises: Sequence[Guess], alone: Sequence[Guess]
) -> list[Guess]:
    """What the ring promises beside what lines tell, where these are two kinds of thing.

    Over a short stretch a ring tells nothing of a camera, and lines tell little of a ring: where
    neither of two causes comes to the end alone, both may together.
    """
    kinds: dict[frozenset[str], Guess] = {}
    for one in promises:
        kinds.setdefault(_kind(refiner, one), one)
    rung = list(kinds.items())[:FOLLOWED]
    seen: dict[frozenset[str], Guess] = {}
    for one in alone:
        if one.log_score > null.log_score + SEEN:
            seen.setdefault(_kind(refiner, one), one)
    told = list(seen.items())[:FOLLOWED]
    found = []
    for kind, line in told:
        for other, ring in rung:
            if not kind & other and len(line.hypothesis.parts) == 1:
                hypothesis = ring.hypothesis.plus(*next(iter(line.hypothesis.parts.items())))
                values = ring.state.term_values() | line.state.term_values()
                state = State.at(hypothesis, values, refiner.candidates)
                found.append(Guess(state, ring.nuisance))
    return found


def _kind(refiner: Refiner, guess: Guess) -> frozenset[str]:
    """Of what its causes are laws."""
    names = guess.hypothesis.names
    return frozenset(refiner.candidates[name].kind for name in names)
