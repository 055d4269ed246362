"""A hypothesis: which candidates are on, and which of their terms."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import comb, log

from analysis.engine.candidate import Candidate

LOG_ODDS = -5.0
"""Prior odds of one candidate being there, as a logarithm: about one in a hundred and fifty."""

LOG_COST = 3.0
"""What a free number costs: half the logarithm of some four hundred features."""

LOG_COST_SHAPE = 1.5
"""What a shape costs, which its range confines."""


LOG_COST_FAMILY = 8.0
"""What a second law of one family costs."""


@dataclass(frozen=True)
class Part:
    """One candidate of a hypothesis.

    Parameters
    ----------
    terms
        Names of the terms that are on.
    shared
        Whether those of one parameter have one value.
    shapes
        The shapes' values, by name.
    """

    terms: tuple[str, ...]
    shared: bool = False
    shapes: Mapping[str, float] = field(default_factory=dict)

    def groups(self, candidate: Candidate) -> tuple[tuple[str, ...], ...]:
        """Terms that have one value, each group a free magnitude."""
        return candidate.groups(self.terms, self.shared)


@dataclass(frozen=True)
class Hypothesis:
    """Candidates that are on, in the order of their names; none is the null hypothesis."""

    parts: Mapping[str, Part] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """The candidates."""
        return tuple(sorted(self.parts))

    def plus(self, name: str, part: Part) -> "Hypothesis":
        """With one more."""
        return Hypothesis({**self.parts, name: part})

    def without(self, name: str) -> "Hypothesis":
        """With one less."""
        return Hypothesis({key: one for key, one in self.parts.items() if key != name})

    @property
    def key(self) -> tuple[object, ...]:
        """What tells it from others, shapes aside."""
        return tuple(
            (name, tuple(sorted(self.parts[name].terms)), self.parts[name].shared)
            for name in self.names
        )

    def also(self, candidates: Mapping[str, Candidate]) -> Iterator[tuple[str, ...]]:
        """Names of hypotheses that it is: each with the candidate that one of its laws came to be.

        Parameters
        ----------
        candidates
            By name.
        """
        for name, part in self.parts.items():
            for shape in candidates[name].shapes:
                if shape.low_is and shape.is_low(part.shapes.get(shape.name, shape.default)):
                    yield tuple(sorted({*self.parts, shape.low_is} - {name}))

    def log_prior(self, candidates: Mapping[str, Candidate], *, moved: bool = True) -> float:
        """Prior odds, the choice of terms and what their free numbers cost.

        Parameters
        ----------
        candidates, moved
            As for `part_log_prior`.
        """
        families = [candidates[name].family for name in self.parts if candidates[name].family]
        doubled = len(families) - len(set(families))
        parts = self.parts.items()
        whole = sum(part_log_prior(candidates[name], one, moved=moved) for name, one in parts)
        return whole - LOG_COST_FAMILY * doubled


def part_log_prior(candidate: Candidate, part: Part, *, moved: bool = True) -> float:
    """What one candidate, with these terms, costs.

    Parameters
    ----------
    candidate, part
        It, and what of it is on.
    moved
        Whether its shapes are moved to where they fit best. Where they are only looked at, the best
        of so many looks costs as much as that is a choice; what no look tells from another is as
        likely whatever its shapes are.
    """
    total = LOG_ODDS + log(candidate.prior)
    if not candidate.together and len(candidate.terms) > 1:
        total -= _log_choices(candidate, part)
    free = 0 if candidate.fixed else len(part.groups(candidate))
    if not moved:
        return total - LOG_COST * free - log(len(candidate.variants()))
    fitted = [shape for shape in candidate.shapes_of(part.terms) if not shape.whole]
    # Where a place begins in each of several recordings is told by each or costs nothing.
    shapes = sum(not shape.term for shape in fitted) + len({shape.term for shape in fitted} - {""})
    tried = 1
    for shape in candidate.shapes:
        tried *= len(shape.grid) if shape.whole and shape.grid else 1
    return total - LOG_COST * free - LOG_COST_SHAPE * shapes - log(tried)


def _log_choices(candidate: Candidate, part: Part) -> float:
    """What the choice of its terms costs: every place is as likely as all other sets together."""
    of, on = len(candidate.terms), len(part.terms)
    wholes = {frozenset(one) for one in candidate.combinations}
    every = frozenset(one.name for one in candidate.terms)
    if frozenset(part.terms) not in wholes:
        return log(2.0 * of * comb(of, on))
    others = len(wholes - {every})
    if every not in wholes or not others:
        return log(2.0 * len(wholes))
    return log(4.0) if on == of else log(4.0 * others)
