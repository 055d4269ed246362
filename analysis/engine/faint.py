"""Faint causes: told by every sample, ring and all, in straight lines about the followed ring.

Where a simulation has been led to within little more than the noise of every sample, over all of
the time or the first part of it, what is left out there can only be small: everything is then in
proportion, and a ring is no nuisance but the best witness, for it tells stiffness, mass and damping
far closer than the driven motion does. All that recording, parameters and candidates span is
brought into some hundred orthonormal directions; white noise stays white in them.
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate, Setting
from analysis.engine.differences import differences
from analysis.engine.evidence import Problem, directions
from analysis.engine.followed import Followed
from analysis.engine.ring_samples import Samples
from analysis.engine.sensitivity import BATCH, Columns, Progress
from analysis.engine.span import all_alike, compressed
from analysis.engine.stride import LOST, SEEN, Stride
from analysis.engine.system import Point, System, own_nuisances
from analysis.engine.whiten import noise_leaves

SMALL = 0.03
"""Of the size that a term is screened at, what tells how it changes the samples."""

FARTHEST = 1e12
"""A change larger than this, in units of noise for one unit of a term, is none."""

CLOSE = 0.05
"""Where two simulations differ by no more than this, squared, of a sample's noise, on average, what
a candidate does beside the one is what it does beside the other."""

KEPT = 6e7
"""What all candidates do to all samples is kept where it is no more numbers than this: 480 MB."""


Place = tuple[str, int, int]
"""Of a term: candidate, look, and which of its terms."""


@dataclass(frozen=True)
class _Seen:
    """What is left about some numbers, shape (n,), and what one unit of each does there, (k, n).

    And one of each term that was asked about, shape (n,).
    """

    telling: float
    residual: Array
    numbers: Array
    changes: Mapping[Place, Array]

    def forgotten(self) -> "_Seen":
        """Without what may be much."""
        return replace(self, numbers=np.zeros((0, len(self.residual))), changes={})


@dataclass(frozen=True)
class Faint:
    """Everything about the followed ring, in orthonormal directions.

    Attributes
    ----------
    followed
        Numbers that ring in the recording's phase.
    problem
        What is left to explain there.
    terms
        (candidate, look) -> what one unit of each term does, shape (f, k): a look for each variant
        of its shapes, and of what bends one more for each. One that is on has but one: its shapes
        as they are.
    own
        Candidate that is on -> what its free numbers do, shape (f, k).
    rotation
        Nuisances of directions, shape (nuisances, p).
    seen
        Of candidates that are not on, for what is near.
    here
        Of all that was asked, for more to be asked about just there.
    strides
        What causes do there as they usually are, shape (f,), as far as it was asked for.
    """

    followed: Followed
    problem: Problem
    terms: Columns
    own: Mapping[str, Array]
    rotation: Array
    seen: _Seen
    here: _Seen
    strides: tuple[tuple[Stride, Array], ...] = ()

    def is_about(self, led: Followed) -> bool:
        """Whether it is about just these numbers."""
        there, led = self.followed, led.about or led
        return there.nuisance is led.nuisance and there.state is led.state

    def to_lead_from(self) -> "Faint":
        """Without what is kept of all samples for what is near, which may be much."""
        return replace(self, seen=self.seen.forgotten(), here=self.here.forgotten())


def faint(
    system: System,
    followed: Followed,
    candidates: Sequence[Candidate],
    progress: Progress | None = None,
    near: Faint | None = None,
    strides: Sequence[Stride] = (),
) -> Faint:
    """What could still be there, as far as the ring was followed.

    Parameters
    ----------
    system
        What is simulated.
    followed
        About where; where its parameters made up for something, about those that had not begun to.
    candidates
        What to look for; of one that is on, each term beside what it is.
    progress
        Told of it.
    near
        The same about other numbers: where those come to the same, what candidates do beside them
        is not simulated again. About just these, with other candidates: nothing is that is known.
    strides
        Which causes to simulate there as they usually are, where straight lines do not say that
        there is nothing to see, or too much.
    """
    followed = followed.about or followed
    samples = Samples(system, everything=True, share=followed.telling)
    before = _just_here(near, followed)
    here, own = _numbers(samples, followed) if before is None else (before.residual, before.numbers)
    numbers, count = len(own), len(followed.nuisance)
    close = _kept(near, followed, here)
    kept = close if before is None else {**close, **before.changes}
    same = own_nuisances(system.nuisances)
    asked = _asked(candidates, followed.point, same)
    places = [place for place in asked if place not in kept]
    points = [asked[place][0] for place in places]
    sizes = np.array([asked[place][1] for place in places])
    rows: list[Array] = []
    for first in range(0, len(points), BATCH):
        rows += [here - one for one in samples.residuals(points[first : first + BATCH])]
        if progress is not None:
            progress(len(rows), len(points))
    does = np.array(rows).reshape(-1, len(here)) / sizes[:, None]
    changes = np.concatenate([own, does])
    new = dict(zip(places, changes[numbers:], strict=True))
    old = [place for place in asked if place in kept]
    if old:
        changes, places = np.concatenate([changes, [kept[one] for one in old]]), places + old
    if strides:
        does_of = dict(zip(places, changes[numbers:], strict=True))
        strides = _worth_asking(strides, changes[:count], does_of)
    if strides:
        whole = samples.residuals([one.point(followed.nuisance) for one in strides])
        changes = np.concatenate([changes, [here - one for one in whole]])
    # A simulation that came to nothing tells nothing.
    changes[~(np.abs(changes).max(axis=1) < FARTHEST)] = 0.0
    allowed = noise_leaves(system.bundles)
    inside, residual_inside, noise = compressed(changes, here, allowed)
    size = len(residual_inside)
    nuisance = inside[:, :count]
    numbers_do = nuisance / [one.sigma for one in system.nuisances]
    terms = _terms(candidates, followed.point, numbers_do, same)
    for place, (name, v, k) in enumerate(places):
        terms[name, v][:, k] = inside[:, numbers + place]
    on: dict[str, Array] = {}
    if followed.state is not None:
        for name in followed.state.hypothesis.names:
            on[name] = inside[:, [count + k for k in followed.state.places(name)]]
    used, base = np.ones(size, dtype=bool), np.full(size, noise)
    rotation = directions(nuisance, base, used)
    problem = Problem(
        residual=residual_inside,
        nuisance=nuisance @ rotation,
        at=rotation.T @ followed.nuisance,
        base=base,
        labels=all_alike(size),
        used=used,
    )
    about = _Seen(followed.telling, here, own, {**{one: kept[one] for one in old}, **new})
    if changes.size > KEPT:
        about = about.forgotten()
    walked = tuple(zip(strides, inside[:, len(changes) - len(strides) :].T, strict=True))
    seen = near.seen if near is not None and close else about
    return Faint(followed, problem, terms, on, rotation, seen, about, walked)


def _asked(
    candidates: Sequence[Candidate], at: Point, same: Container[tuple[str, str]]
) -> dict[Place, tuple[Point, float]]:
    """What is simulated for each term that is no nuisance, and how much of it is on there."""
    found: dict[Place, tuple[Point, float]] = {}
    for candidate in candidates:
        there = at.effects.get(candidate.name, Setting({}))
        for v, (shapes, small) in enumerate(_looks(candidate, at)):
            for k, term in enumerate(candidate.terms):
                if (candidate.name, term.name) not in same:
                    more = there.values.get(term.name, 0.0) + small * term.step
                    setting = Setting({**there.values, term.name: more}, shapes)
                    effects = {**at.effects, candidate.name: setting}
                    point = Point(at.nuisance, effects, "as_is")
                    found[candidate.name, v, k] = point, small * term.step
    return found


def _worth_asking(
    strides: Sequence[Stride], nuisances: Array, does: Mapping[Place, Array]
) -> list[Stride]:
    """Those of which straight lines say that something is to be seen, and not too much."""
    inside = np.eye(len(nuisances)) + nuisances @ nuisances.T
    found = []
    for one in strides:
        change = np.zeros(nuisances.shape[1])
        for k, term in enumerate(one.candidate.terms):
            change += one.size * term.step * does[one.candidate.name, one.look, k]
        back = nuisances @ change
        seen = float(change @ change - back @ np.linalg.solve(inside, back))
        if SEEN < seen < LOST:
            found.append(one)
    return found


def _numbers(samples: Samples, followed: Followed) -> tuple[Array, Array]:
    """What is left of all samples, shape (n,), and what one unit of each number does, (k, n)."""
    (here,) = samples.residuals([followed.point])
    # What nuisances do is known already, where they were led to just there, or near.
    known = np.zeros((0, len(here)))
    if followed.lends is not None and followed.fresh and followed.telling == 1.0:
        known = followed.lends.columns
    own, _ = differences(samples, followed, here, known=len(known))
    return here, np.concatenate([known, own])


def _just_here(near: Faint | None, followed: Followed) -> _Seen | None:
    """What was simulated about just these numbers; None: nothing was."""
    if near is None or len(near.here.numbers) == 0 or near.here.telling != followed.telling:
        return None
    return near.here if near.is_about(followed) else None


def _kept(near: Faint | None, followed: Followed, here: Array) -> dict[Place, Array]:
    """What terms do that are not on, as it is known from what comes to the same."""
    if near is None or near.seen.telling != followed.telling:
        return {}
    off = near.seen.residual - here
    if not float(off @ off) < CLOSE * len(here):
        return {}
    on = {*near.followed.point.effects, *followed.point.effects}
    return {place: row for place, row in near.seen.changes.items() if place[0] not in on}


def _looks(candidate: Candidate, at: Point) -> list[tuple[Mapping[str, float], float]]:
    """With which shapes it is looked at, and at which share of its step.

    Where it is on, with those that it has.
    """
    # What is there or not is there as a whole.
    small = 1.0 if candidate.grows or candidate.fixed else SMALL
    on = at.effects.get(candidate.name)
    if on is not None:
        return [(on.shapes, small)]
    shares = (small, 1.0) if candidate.bends else (small,)
    return [(shapes, share) for share in shares for shapes in candidate.variants()]


def _terms(
    candidates: Sequence[Candidate],
    at: Point,
    numbers: Array,
    same: Mapping[tuple[str, str], int],
) -> Columns:
    """Columns of terms that are parameters; zeros for the others."""
    terms: Columns = {}
    for candidate in candidates:
        for v in range(len(_looks(candidate, at))):
            columns = np.zeros((len(numbers), len(candidate.terms)))
            for k, term in enumerate(candidate.terms):
                i = same.get((candidate.name, term.name))
                if i is not None:
                    columns[:, k] = numbers[:, i]
            terms[candidate.name, v] = columns
    return terms
