"""Strong causes: from the null hypothesis to those that explain, one candidate more at a time."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.fitted import Fitted
from analysis.engine.refine import Refiner
from analysis.engine.screen import Scored, Screen
from analysis.engine.sensitivity import Columns, term_columns

Tell = Callable[[str, int, int], None]
"""Told what is being done, how much of it is done, and of how much."""

SINGLES, PAIRS, TRIPLES = 7, 6, 3
"""Hypotheses fitted in earnest at each stage, at most."""

MORE_ANEW = 2
"""Where everything is simulated anew, so many times as many, however little screening promises:
what something does beside nothing tells little of what it does beside another."""

STARTS, SMALL = 2, 0.1
"""From so many starts each is then fitted; one start is with little of the new candidate, as a
share of the size it is screened at."""

WORTH = 12.0
"""A screened hypothesis this far behind the best is not fitted."""

WIDENED = 3
"""So many of the best are fitted once more with every place free."""

HOPELESS = 60.0
"""A hypothesis that promises to stay this far behind is not fitted to the end."""

HOPELESS_MORE = 20.0
"""Nor one of more causes that promises to stay this far behind those of fewer."""

ASKS = 4.0
"""One candidate more is looked for where screening promises this rise of the score."""

PARENTS = 3
"""Hypotheses from which one more is looked for."""


class Promised(NamedTuple):
    """What screening promises of a hypothesis, and which candidate it has more than its parent."""

    added: str
    scored: Scored


class Finder:
    """Looks for what explains, one candidate more at a time, and keeps what was fitted.

    Parameters
    ----------
    refiner
        Fits.
    terms
        What every candidate would do.
    tell
        Told of progress.
    """

    def __init__(
        self,
        refiner: Refiner,
        terms: Columns,
        tell: Tell | None,
    ) -> None:
        self._refiner = refiner
        self._candidates = refiner.candidates
        self._terms = terms
        self._tell = tell
        self._fitted: dict[tuple[object, ...], Fitted] = {}

    def singles(self, null: Fitted) -> list[Scored]:
        """Single causes, the best of them fitted; all of them to first order, the best first."""
        promised = self.screen(null)
        self.keep(null)
        self.fit_best(promised, SINGLES, "fitting single causes", HOPELESS)
        if not self._refiner.anew:
            self.widen(null, WIDENED)
        return [one for _, one in promised]

    def sets(self, most_causes: int) -> None:
        """Pairs and more, beside the single causes that were fitted."""
        anew = self._refiner.anew
        for size in range(1, most_causes):
            parents = self._parents(size)
            found: list[Promised] = []
            for parent in parents:
                least = -np.inf if anew else parent.log_score + ASKS
                found += [one for one in self.screen(parent) if one.scored.log_score > least]
            if not found:
                break
            most = PAIRS if size == 1 else TRIPLES
            self.fit_best(found, most, f"fitting sets of {size + 1}", HOPELESS_MORE)
            if self.ranked()[0].hypothesis.parts.keys() == parents[0].hypothesis.parts.keys():
                break

    def _parents(self, size: int) -> list[Fitted]:
        """The best of so many candidates, beside which one more is looked for."""
        best = self.ranked()[0].log_score
        parents = [one for one in self.ranked() if len(one.hypothesis.parts) == size][:PARENTS]
        every = size == 1 or self._refiner.anew
        return [one for one in parents if every or one.log_score > best - WORTH]

    def keep(self, fitted: Fitted) -> None:
        """Keep a fitted hypothesis, in the place of one with the same terms."""
        self._fitted[fitted.hypothesis.key] = fitted

    def ranked(self) -> list[Fitted]:
        """The best first."""
        return sorted(self._fitted.values(), key=lambda one: -one.log_score)

    def _screen(self, parent: Fitted) -> Screen:
        return Screen(
            parent.problem,
            self._candidates,
            self._terms_beside(parent),
            on=parent.hypothesis,
            done=parent.done,
            own=parent.columns,
            state=parent.state,
        )

    def screen(self, parent: Fitted) -> list[Promised]:
        """One candidate more than a fitted hypothesis has, to first order; the best first."""
        screen = self._screen(parent)
        found = []
        for i, name in enumerate(self._candidates):
            if name not in parent.hypothesis.parts and not self._doubled(parent, name):
                best = screen.best_of(name)
                if best is not None:
                    found.append(Promised(name, best))
            if self._tell is not None:
                beside = " and ".join(parent.hypothesis.names) or "nothing"
                self._tell(f"screening beside {beside}", i + 1, len(self._candidates))
        return sorted(found, key=lambda one: -one.scored.log_score)

    def _terms_beside(self, parent: Fitted) -> Columns:
        if not self._refiner.anew or not parent.hypothesis.parts:
            return self._terms
        others = [
            one for name, one in self._candidates.items() if name not in parent.hypothesis.parts
        ]
        return term_columns(
            self._refiner.system,
            self._refiner.lens,
            others,
            parent.point.nuisance,
            parent.problem.nuisance,
            effects=parent.point.effects,
        )

    def _starts(self, scored: Scored) -> list[Scored]:
        """Where screening says, and where hypotheses of one candidate less were fitted."""
        starts = [scored]
        for done in self._fitted.values():
            new = set(scored.hypothesis.names) - set(done.hypothesis.names)
            if len(new) != 1 or len(done.hypothesis.parts) + 1 != len(scored.hypothesis.parts):
                continue
            (name,) = new
            part = scored.hypothesis.parts[name]
            said = {key: value for key, value in scored.values.items() if key[0] == name}
            small = {(name, t.name): SMALL * t.step for t in self._candidates[name].terms}
            small = {key: small[key] for key in said}
            weighed = replace(scored.weighed, nuisance=done.problem.at)
            for shapes in self._candidates[name].variants():
                hypothesis = done.hypothesis.plus(name, replace(part, shapes=shapes))
                starts += [
                    Scored(hypothesis, scored.log_score, weighed, {**done.values, **own})
                    for own in (said, small)
                ]
        return starts

    def widen(self, parent: Fitted, most: int) -> None:
        """Fit the best once more with every place free: to first order a few may seem enough."""
        screen = self._screen(parent)
        for one in self.ranked()[:most]:
            for name, part in one.hypothesis.parts.items():
                candidate = self._candidates[name]
                every = tuple(term.name for term in candidate.terms)
                if candidate.spreads and (part.shared or part.terms != every):
                    wide = screen.with_terms(name, every)
                    self.keep(self._refiner.fit(wide))

    def _doubled(self, parent: Fitted, name: str) -> bool:
        """Whether a law of its family is on already: two laws of one thing are neither."""
        family = self._candidates[name].family
        return bool(family) and any(
            self._candidates[one].family == family for one in parent.hypothesis.parts
        )

    def fit_best(
        self, promised: Iterable[Promised], most: int, stage: str, hopeless: float
    ) -> None:
        """Fit the best in earnest, each set of candidates once for each choice of terms."""
        anew = self._refiner.anew
        chosen = worth_fitting(promised, MORE_ANEW * most if anew else most, self._candidates, anew)
        for i, one in enumerate(chosen):
            if one.hypothesis.key not in self._fitted:
                best = max(done.log_score for done in self._fitted.values())
                if anew:
                    self.keep(self._refiner.fit_from(self._starts(one), STARTS))
                else:
                    self.keep(self._refiner.fit(one, at_least=best - hopeless))
            if self._tell is not None:
                self._tell(stage, i + 1, len(chosen))


def worth_fitting(
    promised: Iterable[Promised], most: int, candidates: Mapping[str, Candidate], anew: bool = False
) -> list[Scored]:
    """What is worth fitting in earnest, the most promising first, each set of candidates once.

    Parameters
    ----------
    promised
        What screening promises.
    most
        So many at most; laws of one thing beside them.
    candidates
        By name.
    anew
        Whether however far behind: screening tells little.
    """
    ordered = sorted(promised, key=lambda one: -one.scored.log_score)
    chosen: list[Scored] = []
    sets: set[tuple[str, ...]] = set()
    families: set[str] = set()
    # A law that may be far off explains less of what it leaves, and is no closer for it.
    reach = max((_reach(one) for _, one in ordered[:1]), default=0.0)
    for added, one in ordered:
        behind = ordered[0].scored.log_score - one.log_score
        far = behind > max(reach, _reach(one)) and len(chosen) >= 3
        if one.hypothesis.names in sets:
            continue
        # Laws of one thing are all fitted, or none: to first order they are hard to rank.
        family = candidates[added].family
        if family not in families and ((far and not anew) or len(chosen) >= most):
            continue
        families |= {family} - {""}
        sets.add(one.hypothesis.names)
        chosen.append(one)
    return chosen


def _reach(scored: Scored) -> float:
    """How far behind the best a screened hypothesis may be and still turn out better.

    To first order scores are as wrong as what is explained is large.
    """
    return WORTH + 0.3 * float(scored.weighed.chi2)
