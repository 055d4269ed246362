"""How large a cause would have to be not to go unnoticed, where nothing was left out.

About parameters that lead to the noise, everything is in proportion: what one unit of a term does,
less what parameters absorb of it, tells from which size on it would be likelier than nothing. That
something would be named then, and not that it would be this: near its limit many a law does the
same.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.evidence import Frame
from analysis.engine.faint import Faint
from analysis.engine.hypothesis import LOG_ODDS, Part, part_log_prior
from analysis.engine.screen import limits as bounds
from analysis.engine.screen import magnitude
from analysis.engine.weights import temper_of


@dataclass(frozen=True)
class Limit:
    """From which size on a number of a candidate would not go unnoticed.

    Attributes
    ----------
    candidate, parameter, unit
        What it is.
    everywhere
        In all places alike, or where there is no choice of places. Infinity: at no plausible size.
    in_one
        In any one place; None: there is no choice.
    """

    candidate: str
    parameter: str
    unit: str
    everywhere: float
    in_one: float | None = None


def limits_of(found: Faint, candidates: Mapping[str, Candidate]) -> tuple[Limit, ...]:
    """Limits of all candidates that are not there or not as a whole, in their order.

    Parameters
    ----------
    found
        Everything about where parameters alone came to the noise.
    candidates
        By name.
    """
    told = []
    frame = Frame(found.problem, found.problem.base)
    for candidate in candidates.values():
        if candidate.fixed or (candidate.name, 0) not in found.terms:
            continue
        names = [one.name for one in candidate.terms]
        looks = [frame.normal(one)[0] for one in _looks(found, candidate)]
        for group in candidate.groups(names, True):
            first = next(one for one in candidate.terms if one.name == group[0])
            placed = len(group) > 1 and not candidate.together
            told.append(
                Limit(
                    candidate.name,
                    first.parameter,
                    first.unit,
                    _size(candidate, looks, group),
                    max(_size(candidate, looks, (one,)) for one in group) if placed else None,
                )
            )
    return tuple(told)


def _size(candidate: Candidate, looks: Sequence[Array], group: tuple[str, ...]) -> float:
    """From which size on terms of one value would be noticed, whatever their shapes.

    What one unit of each tells beside parameters, squared, in sigmas: a matrix for each look.
    """
    cost = -part_log_prior(candidate, Part(group, len(group) > 1), moved=False)
    temper = temper_of(candidate.form_share)
    sigmas = float(np.sqrt(2.0 * (cost - LOG_ODDS * (temper - 1.0))))
    pick = [k for k, one in enumerate(candidate.terms) if one.name in group]
    least = min(float(one[np.ix_(pick, pick)].sum()) for one in looks)
    if not least > 0.0:
        return np.inf
    size = abs(magnitude(candidate, group, sigmas / float(np.sqrt(least))))
    low, high = bounds(candidate, group)
    return size if size <= max(abs(low), abs(high)) else np.inf


def _looks(found: Faint, candidate: Candidate) -> list[Array]:
    """What each variant of a candidate's shapes does; the last look at each counts.

    Of what bends a little tells less than the whole of its step.
    """
    count = len(candidate.variants())
    places = [(candidate.name, v) for v in range(2 * count)]
    return [found.terms[one] for one in places if one in found.terms][-count:]
