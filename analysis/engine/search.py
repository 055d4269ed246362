"""The search: from the null hypothesis to those that explain, one candidate more at a time."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analysis.engine.calibrate import Calibrated, calibrate
from analysis.engine.faint import faint
from analysis.engine.faint_search import faint_search, followed_search, ring_promises
from analysis.engine.lens import Lens
from analysis.engine.refine import Fitted, Refiner
from analysis.engine.ring_fit import FAINT, LOST, Followed, follow_ring
from analysis.engine.screen import Scored, Screen
from analysis.engine.sensitivity import Columns, term_columns
from analysis.engine.system import Array, Candidate, System

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

FOLLOWED, FOLLOWED_OF_MANY = 3, 2
"""Of what the ring promises, and of what is likely without it, so many are led to its phase; fewer
of several recordings, which take their time and leave less open."""

UNLIKELY = 6.0
"""What is this far behind nothing, without the ring, is not likely."""

PROMISING = 3.0
"""What is led to the ring's phase leaves, without the ring, no more than this of the squared misfit
of a feature."""

PARENTS = 3
"""Hypotheses from which one more is looked for."""


@dataclass(frozen=True)
class Search:
    """Everything that was found out.

    Attributes
    ----------
    system, lens, data
        What was looked at; data are its features, shape (f,).
    calibrated
        The system at its likeliest parameters.
    terms
        What every candidate would do there.
    screened
        Single candidates to first order, the best first.
    null
        Nothing left out, parameters fitted.
    fitted
        Hypotheses fitted in earnest, the best first; the null among them.
    refiner
        Fits more.
    faint
        Whether parameters alone lead to the noise, so that scores are those of the followed ring.
    """

    system: System
    lens: Lens
    data: Array
    calibrated: Calibrated
    terms: Columns
    screened: tuple[Scored, ...]
    null: Fitted
    fitted: tuple[Fitted, ...]
    refiner: Refiner
    faint: bool = False


class Promised(NamedTuple):
    """What screening promises of a hypothesis, and which candidate it has more than its parent."""

    added: str
    scored: Scored


class Look(NamedTuple):
    """The system at its likeliest parameters, and what every candidate would do to it."""

    lens: Lens
    data: Array
    calibrated: Calibrated
    terms: Columns


def look(system: System, tell: Tell | None = None, *, terms: bool = True) -> Look:
    """Fit the parameters, and, where asked for, simulate what every candidate would do."""
    lens = Lens(list(system.bundles))
    data = lens.of_data()

    def parameters(done: int, total: int) -> None:
        if tell is not None:
            tell("fitting parameters", done, total)

    def causes(done: int, total: int) -> None:
        if tell is not None:
            tell("simulating what each cause would do", done, total)

    found = calibrate(system, lens, data, parameters)
    columns: Columns = {}
    if terms:
        columns = term_columns(system, lens, system.candidates, found.at, found.columns, causes)
    return Look(lens, data, found, columns)


def search(
    system: System, tell: Tell | None = None, *, anew: bool = False, most_causes: int = 3
) -> Search:
    """Look for what explains the recording.

    Parameters
    ----------
    system
        What was recorded and how it is simulated.
    tell
        Told of progress.
    anew
        Beside each hypothesis, simulate anew what nuisances and candidates do: for a system in
        which one thing changes what another does, and that is quickly simulated.
    most_causes
        Of a hypothesis.
    """
    lens, data, calibrated, terms = look(system, tell)
    candidates = {one.name: one for one in system.candidates}
    refiner = Refiner(system, lens, data, calibrated, anew=anew)
    finder = _Finder(refiner, candidates, terms, tell)
    null = refiner.fit(Screen(calibrated.problem, candidates, terms).null())

    def following(done: int, total: int) -> None:
        if tell is not None:
            tell("following the ring", done, total)

    many = len({bundle.record for bundle in system.bundles}) > 1
    most_followed = FOLLOWED_OF_MANY if many else FOLLOWED
    nothing = _nothing(system, calibrated)
    promises: list[Fitted] = []
    if nothing is not None and nothing.left < LOST:
        chosen = [one for one in system.candidates if not one.fixed]
        about = faint(system, nothing, chosen, following)
        if nothing.left < FAINT:
            screened, faintly = faint_search(about, refiner, candidates)
            return Search(
                system, lens, data, calibrated, terms, tuple(screened), null, tuple(faintly),
                refiner, faint=True,
            )  # fmt: skip
        promises = ring_promises(about, refiner)[:most_followed]
    promised = finder.screen(null)
    singles = [one for _, one in promised]
    finder.keep(null)
    finder.fit_best(promised, SINGLES, "fitting single causes", HOPELESS)
    if not anew:
        finder.widen(null, WIDENED)
    for size in range(1, most_causes):
        stage, most = f"fitting sets of {size + 1}", PAIRS if size == 1 else TRIPLES
        parents = [one for one in finder.ranked() if len(one.hypothesis.parts) == size][:PARENTS]
        best = finder.ranked()[0].log_score
        parents = [one for one in parents if one.log_score > best - WORTH or size == 1 or anew]
        if not parents:
            break
        found: list[Promised] = []
        for parent in parents:
            least = -np.inf if anew else parent.log_score + ASKS
            found += [one for one in finder.screen(parent) if one.scored.log_score > least]
        if not found:
            break
        finder.fit_best(found, most, stage, HOPELESS_MORE)
        if finder.ranked()[0].hypothesis.parts.keys() == parents[0].hypothesis.parts.keys():
            break
    ranked = finder.ranked()
    least = null.log_score - UNLIKELY
    likely = [one for one in ranked if one.hypothesis.parts and one.log_score > least]
    likely = likely[:most_followed]
    if rings(system) and (nothing is not None or _near(ranked[0])):
        kin = {candidates[n].family for one in (*promises, *likely) for n in one.hypothesis.names}
        related = [
            one
            for one in ranked
            if len(one.hypothesis.parts) == 1
            and candidates[one.hypothesis.names[0]].family in kin - {""}
        ]
        tried: dict[tuple[str, ...], Fitted] = {}
        for one in (*likely, *related, *promises):
            tried.setdefault(one.hypothesis.names, one)
        nothing = nothing or follow_ring(system, calibrated.at, everything=True)
        rung = followed_search(refiner, list(tried.values()), nothing, most_causes, following)
        if rung is not None:
            return Search(
                system, lens, data, calibrated, terms, tuple(singles), null, tuple(rung), refiner,
                faint=True,
            )  # fmt: skip
    return Search(
        system, lens, data, calibrated, terms, tuple(singles), null, tuple(ranked), refiner
    )


def rings(system: System) -> bool:
    """Whether the system has tones of its own."""
    return any(bundle.tones_hz for bundle in system.bundles)


def _nothing(system: System, calibrated: Calibrated) -> Followed | None:
    """How far parameters alone lead to the ring's phase; None where they do not fit without it."""
    problem = calibrated.problem
    misfit = float(np.mean((problem.residual**2 / problem.base)[problem.used]))
    if misfit > PROMISING or not rings(system):
        return None
    return follow_ring(system, calibrated.at, everything=True)


def _near(fitted: Fitted) -> bool:
    """Whether a hypothesis fits without the ring, so that it may be led to it."""
    problem = fitted.problem
    left = problem.residual - problem.nuisance @ (fitted.weighed.nuisance - problem.at)
    return float(np.mean((left**2 / fitted.weighed.variance)[problem.used])) < PROMISING


class _Finder:
    """Keeps what was fitted."""

    def __init__(
        self,
        refiner: Refiner,
        candidates: Mapping[str, Candidate],
        terms: Columns,
        tell: Tell | None,
    ) -> None:
        self._refiner = refiner
        self._candidates = candidates
        self._terms = terms
        self._tell = tell
        self._fitted: dict[tuple[object, ...], Fitted] = {}

    def keep(self, fitted: Fitted) -> None:
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
                if candidate.shareable and len(every) > 1 and (part.shared or part.terms != every):
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
        ordered = sorted(promised, key=lambda one: -one.scored.log_score)
        chosen: list[Scored] = []
        sets: set[tuple[str, ...]] = set()
        families: set[str] = set()
        anew = self._refiner.anew
        most = MORE_ANEW * most if anew else most
        for added, one in ordered:
            far = one.log_score < ordered[0].scored.log_score - _reach(one) and len(chosen) >= 3
            if one.hypothesis.names in sets:
                continue
            # Laws of one thing are all fitted, or none: to first order they are hard to rank.
            family = self._candidates[added].family
            if family not in families and ((far and not anew) or len(chosen) >= most):
                continue
            families |= {family} - {""}
            sets.add(one.hypothesis.names)
            chosen.append(one)
        for i, one in enumerate(chosen):
            if one.hypothesis.key not in self._fitted:
                best = max(done.log_score for done in self._fitted.values())
                if anew:
                    self.keep(self._refiner.fit_from(self._starts(one), STARTS))
                else:
                    self.keep(self._refiner.fit(one, at_least=best - hopeless))
            if self._tell is not None:
                self._tell(stage, i + 1, len(chosen))


def _reach(scored: Scored) -> float:
    """How far behind the best a screened hypothesis may be and still turn out better.

    To first order scores are as wrong as what is explained is large.
    """
    return WORTH + 0.3 * float(scored.weighed.chi2)
