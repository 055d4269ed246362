"""The proof: fitted to one part of the data, judged on the part that was kept back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.known import Known
from analysis.engine.part import Part, records_of, rings
from analysis.engine.ring_fit import EFFORT, follow_ring
from analysis.engine.search import Search
from analysis.engine.sensitivity import nuisance_columns, simulate_features
from analysis.engine.state import State
from analysis.engine.system import Point, Ring, System
from analysis.engine.whiten import Whiten

RINGS: tuple[Ring, ...] = ("left_out", "as_is")

NEARLY = 1.2
"""From where all of the data led, the used part leads in a few steps: none is begun after so many
simulations for each free number, a little more than all differences take once."""

MOVED = 1.0
"""Parameters that have moved by no more than this, in sigmas, have done nothing by themselves."""

CERTAIN = 1e8
"""What stays where it is known to be is known ten thousand times better than is stated."""

MOST_STEPS = 30
"""Of parameters alone, to where they fit."""

LEAST_RECORDS = 3
"""From so many recordings on, one is kept back whole but for its rest, unless one is sealed."""


@dataclass(frozen=True)
class Confirmation:
    """How well simulations fit samples, in units of their noise (1 is noise alone).

    Attributes
    ----------
    before, after
        Nothing left out, parameters fitted within their priors, and numbers that the hypothesis
        names as they are known; and the chosen hypothesis, fitted to the used part: part of the
        data ("used", "held_out") -> kind of channel -> rms of the residual over the noise.
    held_record
        The recording that was kept back whole; "" where there are too few.
    held_values
        Kind of channel -> how many values are held out.
    """

    before: Mapping[str, Mapping[str, float]]
    after: Mapping[str, Mapping[str, float]]
    held_record: str
    held_values: Mapping[str, int]


def confirm(search: Search, chosen: Fitted) -> Confirmation:
    """Fit the chosen hypothesis to the used part, and judge it on the other.

    Recordings that stand aside are left out.

    Before is the system at its likeliest parameters. Those of one that rings have seen all of the
    data, which favours it, and what the hypothesis says to be off is where it was known to be:
    else they had done by themselves what it says. Those of another are fitted to the used part, as
    the hypothesis's are.

    Parameters
    ----------
    search
        What was found.
    chosen
        The hypothesis.
    """
    system, bundles = search.system, search.system.bundles
    records = [one for one in records_of(system) if one not in search.aside]
    part = Part(system, records) if search.aside else None
    sealed = any(segment.sealed for bundle in bundles for segment in bundle.segments)
    held = "" if sealed or len(records) < LEAST_RECORDS else _held(search.system, records)
    start = search.calibrated.at
    if search.faint:
        start = next(one.point.nuisance for one in search.fitted if not one.hypothesis.parts)
    if part is not None:
        system, start = part, part.own(start)
    named = _named(system, chosen)
    if not rings(system):
        alone = _parameters_alone(search, _used(search, held))
        before = after = _errors(system, alone, None, held, near=False)
    elif search.faint and named and np.abs(start[named]).max() > MOVED:
        alone, known = _as_known(start, named)
        before = after = _errors(system, alone, None, held, near=True, known=known)
    elif search.faint and chosen.hypothesis.parts:
        before = after = _least(system, _tried(start, None), held)
    else:
        # Where nothing is on, this is what is judged: the held-out part must not have been seen.
        before = after = _errors(system, start, None, held, near=search.faint)
    if chosen.hypothesis.parts:
        again = chosen
        if not search.faint:
            again = search.refiner.settle(search.refiner.again(chosen, _used(search, held)))
        nuisance = again.point.nuisance if part is None else part.own(again.point.nuisance)
        after = _errors(system, nuisance, again.state, held, near=search.faint)
    return Confirmation(before, after, held, _held_values(system.bundles, held))


def _named(system: System, chosen: Fitted) -> list[int]:
    """Nuisances that are numbers of a hypothesis."""
    parts = chosen.hypothesis.parts
    return [
        i
        for i, one in enumerate(system.nuisances)
        if (named := parts.get(one.cause or "")) and one.term in named.terms
    ]


def _as_known(at: Array, which: Sequence[int]) -> tuple[Array, Known]:
    """Parameters, some of them where they are known to be, shape (p,), and held there."""
    nuisance, certain = at.copy(), np.ones(len(at))
    nuisance[which], certain[which] = 0.0, CERTAIN
    return nuisance, Known(np.zeros(len(at)), np.diag(certain))


def _parameters_alone(search: Search, used: NDArray[np.bool_]) -> Array:
    """Parameters where they fit best within their priors, nothing left out, shape (nuisances,).

    Evidence leaves them where they were, where they do not explain what is left out; what is held
    against it is a fit.

    Parameters
    ----------
    search
        What was found.
    used
        Features that count, shape (f,).
    """
    system, lens, null = search.system, search.lens, search.null
    used = used & null.problem.used
    root = np.sqrt(null.problem.base[used])

    def left(at: Array) -> Array:
        (features,) = simulate_features(system, lens, [Point(at)])
        return np.concatenate([(search.data - features)[used] / root, at])

    def columns(at: Array) -> Array:
        does = nuisance_columns(system, lens, at)[used] / root[:, None]
        return np.concatenate([-does, np.eye(len(at))])

    start = null.point.nuisance
    if not len(start):
        return start
    if not np.isfinite(left(start)).all():
        start = np.zeros_like(start)
    return np.asarray(least_squares(left, start, columns, max_nfev=MOST_STEPS).x)


def _held(system: System, records: Sequence[str]) -> str:
    """The recording that is kept back whole, about the middle; "": there is none.

    Of a system that does not ring, one that has parameters of its own, such as where it starts, is
    not: nothing else tells those.
    """
    middle = len(records) // 2
    if rings(system):
        return records[middle]
    own = {one.record for one in system.nuisances}
    could = [one for one in records if one not in own]
    return min(could, key=lambda one: abs(records.index(one) - middle), default="")


def _errors(
    system: System,
    nuisance: Array,
    state: State | None,
    held: str,
    *,
    near: bool,
    known: Known | None = None,
) -> dict[str, dict[str, float]]:
    """Without the system's own ring, with it, or led to its phase: what fits the used part best."""
    tried = _tried(nuisance, state)
    if rings(system):
        most = NEARLY * len(Followed(nuisance, state).numbers) if near else EFFORT
        led = follow_ring(system, nuisance, state, held=held, near=near, most=most, known=known)
        if near and led.share < 1.0:
            led = follow_ring(system, nuisance, state, held=held, known=known)
        tried.append(led.point)
    return _least(system, tried, held)


def _tried(nuisance: Array, state: State | None) -> list[Point]:
    """Without the system's own ring, and with it."""
    start = Followed(nuisance, state)
    return [replace(start.point, ring=ring) for ring in RINGS]


def _least(system: System, tried: Sequence[Point], held: str) -> dict[str, dict[str, float]]:
    """The errors of what fits the used part best."""
    found = (sample_errors(system, one, held) for one in tried)
    return min(found, key=lambda errors: sum(one**2 for one in errors["used"].values()))


def _used(search: Search, held: str) -> NDArray[np.bool_]:
    labels, bundles = search.lens.labels, search.system.bundles
    whole = np.array([held != "" and bundle.record == held for bundle in bundles])[labels.bundle]
    resting = np.array(
        [
            bundles[b].segments[s].name == "rest"
            for b, s in zip(labels.bundle, labels.segment, strict=True)
        ]
    )
    return np.asarray(~labels.held_out & ~(whole & ~resting))


def sample_errors(system: System, point: Point, held: str = "") -> dict[str, dict[str, float]]:
    """Rms of the samples' residuals over their noise.

    Parameters
    ----------
    system, point
        What is simulated.
    held
        A recording that counts as kept back.

    Returns
    -------
    dict
        "used" and "held_out" -> kind of channel -> rms; a part without samples is left out.
    """
    (residuals,) = system.simulate([point], lambda p: whitened(system.bundles, p))
    sums: dict[str, dict[str, list[Array]]] = {"used": {}, "held_out": {}}
    for bundle, residual in zip(system.bundles, residuals, strict=True):
        for segment in bundle.segments:
            inside = segment.holds(bundle.t_s)
            if inside.any():
                part = sums["held_out" if _is_away(bundle, segment, held) else "used"]
                part.setdefault(bundle.kind, []).append(residual[inside].reshape(-1) ** 2)
    return {
        part: {kind: float(np.sqrt(np.concatenate(all_).mean())) for kind, all_ in kinds.items()}
        for part, kinds in sums.items()
    }


def _is_away(bundle: Bundle, segment: Segment, held: str) -> bool:
    """Whether what a segment holds was not fitted to."""
    kept_back = held != "" and bundle.record == held and segment.name != "rest"
    return segment.held_out or segment.sealed or kept_back


def _held_values(bundles: Sequence[Bundle], held: str) -> dict[str, int]:
    """Kind of channel -> how many values are held out."""
    found: dict[str, int] = {}
    for bundle in bundles:
        for segment in bundle.segments:
            if _is_away(bundle, segment, held):
                count = int(segment.holds(bundle.t_s).sum()) * bundle.value.shape[1]
                found[bundle.kind] = found.get(bundle.kind, 0) + count
    return found


def whitened(bundles: Sequence[Bundle], prediction: list[Array]) -> list[Array]:
    """Residuals of samples in units of their noise, for each bundle, shape (n, m)."""
    pairs = zip(bundles, prediction, strict=True)
    return [Whiten(bundle)(bundle.value - seen) for bundle, seen in pairs]
