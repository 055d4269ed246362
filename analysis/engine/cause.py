"""A cause of the mismatch: which it is, what could stand in for it, and how large it is."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate
from analysis.engine.fitted import Fitted

COVERED = 0.95
"""A set of indistinguishable causes holds this much of the probability."""

LEAST_SHARE = 0.02
"""A rival less likely than this, beside the named cause, is not in its set."""


@dataclass(frozen=True)
class Rival:
    """A cause that could stand in for another."""

    name: str
    probability: float
    fitted: Fitted = field(repr=False)


@dataclass(frozen=True)
class Cause:
    """One cause of the mismatch.

    Attributes
    ----------
    name
        The likeliest candidate.
    probability
        That it is this one, and that there is one at all.
    present
        That there is a cause here, whichever it is.
    rivals
        Others that these data do not tell from it, the likeliest first.
    values, sigmas
        Term -> magnitude and standard deviation, for the terms that are on: the mean over the laws
        of one family that are in the set, as likely as they are, and what they differ by counts.
    own
        Term -> magnitude by its law alone, which goes with
    shapes, shape_sigmas
        its other numbers.
    at_limit
        Numbers at the edge of their plausible range: a better fit with an implausible number.
    elsewhere
        Term -> magnitude in other places that are about as likely, the likeliest first.
    """

    name: str
    probability: float
    present: float
    rivals: tuple[Rival, ...]
    values: Mapping[str, float]
    sigmas: Mapping[str, float]
    own: Mapping[str, float]
    shapes: Mapping[str, float]
    shape_sigmas: Mapping[str, float]
    at_limit: tuple[str, ...]
    elsewhere: tuple[Mapping[str, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The cause and its rivals."""
        return (self.name, *(one.name for one in self.rivals))


def cause_of(
    name: str,
    chosen: Fitted,
    fitted: Sequence[Fitted],
    weights: Array,
    candidates: Mapping[str, Candidate],
) -> Cause:
    """The cause that stands, in the likeliest hypothesis, where a candidate is on.

    Parameters
    ----------
    name
        The candidate.
    chosen
        The likeliest hypothesis.
    fitted, weights
        All of them, and how likely each is.
    candidates
        By name.
    """
    others = set(chosen.hypothesis.names) - {name}
    slot: dict[str, float] = defaultdict(float)
    best: dict[str, Fitted] = {}
    nobody = 0.0
    for one, weight in zip(fitted, weights, strict=True):
        names = set(one.hypothesis.names)
        if not others <= names:
            continue
        extra = names - others
        if not extra:
            nobody += float(weight)
        elif len(extra) == 1 or name in extra:
            key = name if name in extra else next(iter(extra))
            slot[key] += float(weight)
            if key not in best or one.log_score > best[key].log_score:
                best[key] = one
    whole = sum(slot.values())
    everything = whole + nobody
    ordered = sorted(slot, key=lambda key: -slot[key])
    head = ordered[0]
    rivals, covered = [], slot[head] / whole
    for key in ordered[1:]:
        if covered >= COVERED or slot[key] < LEAST_SHARE * slot[head]:
            break
        rivals.append(Rival(key, slot[key] / everything, best[key]))
        covered += slot[key] / whole
    source = chosen if head == name else best[head]
    part = source.hypothesis.parts[head]
    family = candidates[head].family
    laws = [Rival(head, slot[head] / everything, source)]
    laws += [one for one in rivals if family and candidates[one.name].family == family]
    means = {term: _mean(term, laws) for term in part.terms}
    return Cause(
        name=head,
        probability=slot[head] / everything,
        present=whole / everything,
        rivals=tuple(rivals),
        values={term: value for term, (value, _) in means.items()},
        sigmas={term: sigma for term, (_, sigma) in means.items()},
        own={term: source.values[head, term] for term in part.terms},
        shapes=dict(part.shapes),
        shape_sigmas={k[1]: v for k, v in source.shape_sigmas.items() if k[0] == head},
        at_limit=tuple(what for who, what in source.at_limit if who == head),
        elsewhere=tuple(one[head] for one in source.elsewhere if set(one[head]) != set(part.terms)),
    )


def within_sigma(fitted: Fitted, name: str) -> bool:
    """Whether a candidate of a hypothesis is no larger than its standard deviation, all of it."""
    terms = [(name, term) for term in fitted.hypothesis.parts[name].terms]
    return all(
        one in fitted.sigmas and abs(fitted.values[one]) < fitted.sigmas[one] for one in terms
    )


def _mean(term: str, laws: Sequence[Rival]) -> tuple[float, float]:
    """Mean and standard deviation of a magnitude over laws that have it."""
    have = [one for one in laws if (one.name, term) in one.fitted.values]
    weight = np.array([one.probability for one in have])
    weight = weight / weight.sum()
    value = np.array([one.fitted.values[one.name, term] for one in have])
    sigma = np.array([one.fitted.sigmas.get((one.name, term), 0.0) for one in have])
    mean = float(weight @ value)
    return mean, float(np.sqrt(weight @ (sigma**2 + (value - mean) ** 2)))


def doubted(cause: Cause, doubt: float) -> Cause:
    """A cause that is as much less likely, and so are its rivals."""
    rivals = tuple(
        replace(one, probability=one.probability * (1.0 - doubt)) for one in cause.rivals
    )
    return replace(
        cause,
        probability=cause.probability * (1.0 - doubt),
        present=cause.present * (1.0 - doubt),
        rivals=rivals,
    )
