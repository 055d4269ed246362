"""Faint causes: told by every sample, ring and all, in straight lines about the followed ring.

Where parameters alone lead a simulation to within little more than the noise of every sample, what
was left out can only be small: everything is then in proportion, and a ring is no nuisance but the
best witness, for it tells stiffness, mass and damping far closer than the driven motion does. All
that recording, parameters and candidates span is brought into some hundred orthonormal directions;
white noise stays white in them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.engine.calibrate import Calibrated
from analysis.engine.evidence import Problem, directions
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.lens import Labels
from analysis.engine.refine import Fitted, Refiner
from analysis.engine.ring_fit import LOST, Followed, follow_ring, residuals, seen
from analysis.engine.screen import Scored, Screen, grouped, groups
from analysis.engine.sensitivity import BATCH, Columns, Progress
from analysis.engine.state import State
from analysis.engine.system import Array, Candidate, Point, Prediction, Setting, System
from analysis.engine.variance import SPREAD

PROMISING = 3.0
"""Without the ring, parameters must leave no more than this of the squared misfit, a feature."""

FAINT = 1.5
"""With it, no more than this, a sample; more is not faint, and not in straight lines."""

SMALL = 0.03
"""Of the size that a term is screened at, what tells how it changes the samples."""

UNEXPLAINED = 0.2
"""Of what nothing explains, this share may lie where candidates are looked for."""

RESTARTS = 3
"""Nothing is led to the phase once more from where so many hypotheses have come: one may have found
a way that nothing missed."""

FARTHEST = 1e12
"""A change larger than this, in units of noise for one unit of a term, is none."""

FORMS = 20
"""An error of form lies in few directions, and in which is not known: in each it may be as large as
if there were so many."""

INDEPENDENT = 1e-9
"""Directions that hold less than this share of the strongest one's power are rounding."""

SINGLES, PARENTS, PAIRS = 8, 3, 6
"""So many hypotheses are kept, and so many looked beside."""


@dataclass(frozen=True)
class Faint:
    """Everything about the followed ring, in orthonormal directions.

    Attributes
    ----------
    followed
        Parameters that ring in the recording's phase.
    problem
        What is left to explain there.
    terms
        (candidate, variant) -> what one unit of each term does, shape (f, k).
    rotation
        Nuisances of directions, shape (nuisances, p).
    left
        Squared misfit of a sample, on average.
    """

    followed: Followed
    problem: Problem
    terms: Columns
    rotation: Array
    left: float


def faint(system: System, calibrated: Calibrated, progress: Progress | None = None) -> Faint | None:
    """Follow the ring with nothing on; None where there is none, or its phase is lost.

    Parameters
    ----------
    system
        What is simulated.
    calibrated
        Its likeliest parameters.
    progress
        Told of it.
    """
    problem = calibrated.problem
    misfit = float(np.mean((problem.residual**2 / problem.base)[problem.used]))
    if misfit > PROMISING or not any(bundle.tones_hz for bundle in system.bundles):
        return None
    followed = follow_ring(system, calibrated.at, everything=True)
    mask = [seen(bundle, everything=True) for bundle in system.bundles]

    def residual(prediction: Prediction) -> Array:
        return residuals(system.bundles, prediction, mask)

    (here,) = system.simulate([followed.point], residual)
    left = float(np.mean(here**2))
    if left > LOST:
        return None
    points, steps = followed.neighbours()
    places: list[tuple[str, int, int]] = []
    scales = list(steps)
    same = {(one.cause, one.term): i for i, one in enumerate(system.nuisances)}
    candidates = [one for one in system.candidates if not one.fixed]
    for candidate in candidates:
        for v, shapes in enumerate(candidate.variants()):
            for k, term in enumerate(candidate.terms):
                if (candidate.name, term.name) not in same:
                    setting = Setting({term.name: SMALL * term.step}, shapes)
                    points.append(Point(followed.nuisance, {candidate.name: setting}, "as_is"))
                    places.append((candidate.name, v, k))
                    scales.append(SMALL * term.step)
    rows: list[Array] = []
    for first in range(0, len(points), BATCH):
        rows += [here - one for one in system.simulate(points[first : first + BATCH], residual)]
        if progress is not None:
            progress(len(rows), len(points))
    # A simulation that came to nothing tells nothing.
    changes = np.stack(rows) / np.array(scales)[:, None]
    changes[~(np.abs(changes).max(axis=1) < FARTHEST)] = 0.0
    inside, residual_inside, noise = _compressed(changes, here)
    count, size = len(steps), len(residual_inside)
    nuisance = inside[:, :count]
    terms = _terms(candidates, nuisance / [one.sigma for one in system.nuisances], same)
    for place, (name, v, k) in enumerate(places):
        terms[name, v][:, k] = inside[:, count + place]
    used, base = np.ones(size, dtype=bool), np.full(size, noise)
    rotation = directions(nuisance, base, used)
    problem = Problem(
        residual=residual_inside,
        nuisance=nuisance @ rotation,
        at=rotation.T @ followed.nuisance,
        base=base,
        labels=_labels(size),
        used=used,
    )
    return Faint(followed, problem, terms, rotation, left)


def _terms(
    candidates: Sequence[Candidate],
    numbers: Array,
    same: Mapping[tuple[str | None, str | None], int],
) -> Columns:
    """Columns of terms that are parameters; zeros for the others."""
    terms: Columns = {}
    for candidate in candidates:
        for v in range(len(candidate.variants())):
            columns = np.zeros((len(numbers), len(candidate.terms)))
            for k, term in enumerate(candidate.terms):
                i = same.get((candidate.name, term.name))
                if i is not None:
                    columns[:, k] = numbers[:, i]
            terms[candidate.name, v] = columns
    return terms


def _compressed(changes: Array, residual: Array) -> tuple[Array, Array, float]:
    """Changes and residual, shapes (k, n) and (n,), in the directions that the changes span.

    Returns
    -------
    Array, Array, float
        Shapes (f, k) and (f,), and the variance of noise there: more than one where the residual
        holds what nothing spans.
    """
    norms = np.linalg.norm(changes, axis=1)
    norms[norms == 0.0] = 1.0
    values, vectors = np.linalg.eigh((changes @ changes.T) / np.outer(norms, norms))
    kept = values > INDEPENDENT * values[-1]
    roots, vectors = np.sqrt(values[kept]), vectors[:, kept]
    inside = (roots[:, None] * vectors.T) * norms
    residual_inside = (vectors.T @ (changes @ residual / norms)) / roots
    free = max(len(residual) - len(roots), 1)
    left = float(residual @ residual - residual_inside @ residual_inside) / free
    spread = UNEXPLAINED * max(left - 1.0, 0.0) * len(residual) / len(roots)
    return inside, residual_inside, 1.0 + spread


def _labels(size: int) -> Labels:
    """One group of numbers that are all alike: an error of form may lie in any direction."""
    zeros, flags = np.zeros(size, dtype=np.int64), np.zeros(size, dtype=bool)
    return Labels(
        bundle=zeros,
        channel=zeros,
        segment=zeros,
        line=np.ones(size),
        ringing=flags,
        growth=np.ones(size),
        quadrature=zeros,
        order=zeros,
        held_out=flags,
        group=zeros,
        stretch=zeros,
        samples=np.full(size, round(SPREAD * FORMS)),
        free=~flags,
        every=~flags,
        sealed=flags,
    )


def faint_search(
    found: Faint, refiner: Refiner, candidates: Mapping[str, Candidate]
) -> tuple[list[Scored], list[Fitted]]:
    """Single candidates and pairs about the followed ring.

    Parameters
    ----------
    found
        See there.
    refiner
        Makes fitted hypotheses of them.
    candidates
        By name.

    Returns
    -------
    list of Scored, list of Fitted
        Single ones, the best first; and the best of all, the null among them.
    """
    chosen = {name: one for name, one in candidates.items() if not one.fixed}
    screen = Screen(found.problem, chosen, found.terms)
    null = screen.null()
    singles = _best(screen, chosen, null)
    pairs: dict[tuple[str, ...], Scored] = {}
    for parent in singles[:PARENTS]:
        if parent.log_score < null.log_score:
            break
        for one in _best(_beside(found, parent, chosen), chosen, parent):
            known = pairs.get(one.hypothesis.names)
            if known is None or one.log_score > known.log_score:
                pairs[one.hypothesis.names] = one
    best = sorted(pairs.values(), key=lambda one: -one.log_score)[:PAIRS]
    kept = singles[:SINGLES]
    kin = {chosen[name].family for one in kept for name in one.hypothesis.names} - {""}
    # Laws of one thing stand side by side, however far apart a ring puts them.
    kept += [
        one
        for one in singles[SINGLES:]
        if any(chosen[name].family in kin for name in one.hypothesis.names)
    ]
    fitted = [_fitted(found, refiner, one) for one in (null, *kept, *best)]
    return singles, sorted(fitted, key=lambda one: -one.log_score)


def followed_each(
    found: Faint, refiner: Refiner, hypotheses: Sequence[Fitted]
) -> list[Fitted] | None:
    """Hypotheses led to the ring's phase, each for itself; None where none comes to the noise.

    Parameters
    ----------
    found
        The same with nothing on.
    refiner
        Made the hypotheses.
    hypotheses
        Those to try, the null not among them.

    Returns
    -------
    list of Fitted or None
        Their scores are those of all samples, the best first.
    """
    system = refiner.system
    mask = [seen(bundle, everything=True) for bundle in system.bundles]

    def residual(prediction: Prediction) -> Array:
        return residuals(system.bundles, prediction, mask)

    fitted: list[Fitted] = []
    misfits: list[float] = []
    least = np.inf
    led = [
        follow_ring(system, one.point.nuisance, one.state, everything=True) for one in hypotheses
    ]
    nothing = [found.followed, *(follow_ring(system, _parameters_of(system, one), everything=True,
                                             near=True) for one in led[:RESTARTS])]  # fmt: skip
    for one in (*led, *nothing):
        (left,) = system.simulate([one.point], residual)
        least = min(least, float(np.mean(left**2)))
        state = one.state or State(Hypothesis(), refiner.candidates, (), np.zeros(0))
        fitted.append(refiner.at(state, refiner.directions_of(one.nuisance)))
        misfits.append(float(left @ left + one.nuisance @ one.nuisance))
    if least > FAINT:
        return None
    names = fitted[int(np.argmin(misfits))].hypothesis.names
    form = max((refiner.candidates[name].form_share for name in names), default=0.0)
    # What the best explains it explains but for its error of form, and so does every other.
    least_nothing = min(misfits[len(led) :])
    noise = 1.0 + form**2 * (least_nothing - min(misfits)) / FORMS
    scored = [
        replace(one, log_score=one.hypothesis.log_prior(refiner.candidates) - 0.5 * misfit / noise)
        for one, misfit in zip(fitted, misfits, strict=True)
    ]
    ordered = sorted(scored, key=lambda one: -one.log_score)
    nulls = [one for one in ordered if not one.hypothesis.parts]
    return [one for one in ordered if one not in nulls[1:]]


def _parameters_of(system: System, led: Followed) -> Array:
    """Nuisances that stand for the parameters among what is on, and for nothing else of it."""
    nuisance = led.nuisance.copy()
    if led.state is not None:
        values = led.state.term_values()
        for i, one in enumerate(system.nuisances):
            nuisance[i] += values.get((one.cause or "", one.term or ""), 0.0) / one.sigma
    return nuisance


def _best(screen: Screen, candidates: Mapping[str, Candidate], parent: Scored) -> list[Scored]:
    families = {candidates[name].family for name in parent.hypothesis.names} - {""}
    scored = [
        screen.best_of(name)
        for name, one in candidates.items()
        if name not in parent.hypothesis.parts and one.family not in families
    ]
    return sorted((one for one in scored if one is not None), key=lambda one: -one.log_score)


def _beside(found: Faint, parent: Scored, candidates: Mapping[str, Candidate]) -> Screen:
    """What is left beside a parent, which may still move."""
    state = State.of(parent, candidates)
    (name,) = parent.hypothesis.names
    part = parent.hypothesis.parts[name]
    variant = [dict(one) for one in candidates[name].variants()].index(dict(part.shapes))
    columns = grouped(candidates[name], found.terms[name, variant], part)
    does = columns @ np.array([parent.values[name, group[0]] for group in groups(part)])
    # Numbers of shape do nothing to first order about little.
    own = np.hstack([columns, np.zeros((len(does), len(state.free) - columns.shape[1]))])
    problem = replace(found.problem, residual=found.problem.residual - does)
    return Screen(
        problem,
        candidates,
        found.terms,
        on=parent.hypothesis,
        done={name: does},
        own={name: own},
        state=state,
    )


def _fitted(found: Faint, refiner: Refiner, scored: Scored) -> Fitted:
    """The hypothesis as others are, with the score that the ring gives it."""
    moved = found.rotation @ (scored.weighed.nuisance - found.problem.at)
    nuisance = refiner.directions_of(found.followed.nuisance + moved)
    fitted = refiner.at(State.of(scored, refiner.candidates), nuisance)
    return replace(fitted, log_score=scored.log_score)
