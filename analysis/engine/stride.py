"""Causes at their usual size, all places alike at once: what a little of them does not foretell.

A little of a damping lets a ring fade a little faster, by the more the longer it rings; much of it
ends the ring, and changes no more than its beginning. Where parameters alone came to the noise in
its stead, as with a camera that is late by what damping delays, a little of it is the wrong way,
and straight lines say so, while all of it explains more than anything they promise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, own_nuisances

SIZES = (1.0, 0.2)
"""Of its step, at which each cause is looked at."""

FEW = 2
"""Of more numbers there is no usual size together."""

LOOKS = 2
"""With so many of its shapes."""

SEEN, LOST = 16.0, 1e4
"""By how much straight lines say that it changes the samples, squared, that parameters do not take
back: by less, and there is nothing to see; by more, and it is not hidden in parameters."""


@dataclass(frozen=True)
class Stride:
    """A cause at some size.

    Attributes
    ----------
    candidate, part
        It, and its places.
    size
        Of the step of each term.
    """

    candidate: Candidate
    part: Part
    size: float

    @property
    def look(self) -> int:
        """Which variant of its shapes."""
        return list(self.candidate.variants()).index(dict(self.part.shapes))

    def state(self, times: float, candidates: Mapping[str, Candidate]) -> State:
        """So many times that much of it, within what is plausible."""
        name, size = self.candidate.name, times * self.size
        values = {(name, one.name): size * one.step for one in self.candidate.terms}
        return State.at(Hypothesis({name: self.part}), values, candidates)

    def point(self, nuisance: Array) -> Point:
        """What is to be simulated."""
        name = self.candidate.name
        effects = self.state(1.0, {name: self.candidate}).point(nuisance).effects
        return Point(nuisance, effects, "as_is")


def strides_of(
    candidates: Sequence[Candidate], nuisances: Sequence[Nuisance]
) -> tuple[Stride, ...]:
    """Causes of which straight lines alone would tell, each at its usual size and at less.

    Not those that are nuisances as well: these are led as such.

    Parameters
    ----------
    candidates, nuisances
        Of a system.
    """
    same = own_nuisances(nuisances)
    found = []
    for one in candidates:
        terms = tuple(term.name for term in one.terms)
        several = len(one.groups(terms, one.spreads)) > FEW
        known = any((one.name, term) in same for term in terms)
        if not (one.fixed or one.together or several or known):
            found += [
                Stride(one, Part(terms, one.spreads, shapes), size)
                for shapes in one.variants()[:LOOKS]
                for size in SIZES
            ]
    return tuple(found)
