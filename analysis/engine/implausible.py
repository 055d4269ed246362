"""Better fits with implausible numbers: said, and named by nobody.

A law that is not there may be asked to take back what another does too much, as a leak that fills a
tank. So for numbers that may be fitted beyond their plausible range, the best hypothesis is fitted
once more with them let out of it, and what is gained by leaving it is told apart from the verdict.
"""

from copy import copy
from dataclasses import dataclass, replace

from analysis.engine.candidate import Candidate
from analysis.engine.finder import ASKS, SMALL, STARTS
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import Part
from analysis.engine.part import rings
from analysis.engine.screen import Scored
from analysis.engine.search import Search
from analysis.engine.settled import counted, polished, rested


@dataclass(frozen=True)
class Implausible:
    """A better fit that is not believed.

    Attributes
    ----------
    candidate, term
        What leaves its range.
    value, sigma, unit
        Where it goes.
    low, high
        Its plausible range.
    gain
        By how much the logarithm of the odds would rise if it were believed.
    fitted
        The hypothesis.
    """

    candidate: str
    term: str
    value: float
    sigma: float
    unit: str
    low: float
    high: float
    gain: float
    fitted: Fitted


def implausible(searched: Search, chosen: Fitted) -> tuple[Implausible, ...]:
    """Fits that are better than the chosen one by a number outside of its plausible range.

    Parameters
    ----------
    searched
        What was found.
    chosen
        The likeliest hypothesis.
    """
    found = []
    for candidate in searched.system.candidates:
        wide = _let_out(candidate)
        if wide != candidate:
            found += _beyond(searched, chosen, candidate, wide)
    return tuple(sorted(found, key=lambda one: -one.gain))


def _let_out(candidate: Candidate) -> Candidate:
    """The candidate with its terms as free as they may be."""
    terms = tuple(
        replace(
            term,
            low=term.low if term.least is None else term.least,
            high=term.high if term.most is None else term.most,
        )
        for term in candidate.terms
    )
    return replace(candidate, terms=terms)


def _beyond(
    searched: Search, chosen: Fitted, candidate: Candidate, wide: Candidate
) -> list[Implausible]:
    refiner = copy(searched.refiner)
    refiner.candidates = {**refiner.candidates, candidate.name: wide}
    hypothesis = chosen.hypothesis
    if candidate.name not in hypothesis.parts:
        hypothesis = hypothesis.plus(
            candidate.name, Part(tuple(term.name for term in candidate.terms))
        )
    terms = [t for t in wide.terms if t.name in hypothesis.parts[candidate.name].terms]
    weighed = replace(chosen.weighed, nuisance=chosen.problem.at)
    starts = []
    for share in (-1.0, -SMALL, SMALL, 1.0):
        begun = {(candidate.name, t.name): share * t.step for t in terms}
        starts.append(Scored(hypothesis, 0.0, weighed, {**begun, **chosen.values}))
        if candidate.name in chosen.hypothesis.parts:
            break
    if rings(searched.system):
        fitted = refiner.fit_from(starts, STARTS)
    else:
        # As the chosen one was: to where it stays.
        fitted = rested(refiner, refiner.fit_from(starts, len(starts)))
        fitted = polished(refiner.finely(), counted(refiner, fitted, fitted))
    gain = fitted.log_score - chosen.log_score
    plausible = {term.name: term for term in candidate.terms}
    found = []
    for term in terms:
        value = fitted.values[candidate.name, term.name]
        low, high = plausible[term.name].low, plausible[term.name].high
        if gain > ASKS and not low <= value <= high:
            sigma = fitted.sigmas[candidate.name, term.name]
            found.append(
                Implausible(
                    candidate.name, term.name, value, sigma, term.unit, low, high, gain, fitted
                )
            )
    return found
