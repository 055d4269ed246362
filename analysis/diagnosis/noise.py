"""The noise of a run's samples: of values at rest, and of the instants that they are of."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.engine.bundle import Bundle
from analysis.noise_floor import floor_between_lines
from cdpr8.rigfile.excitation import Excitation

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

OUTLIER = 6.0
"""A sample farther from a line than so many typical distances is not counted."""

LEAST_REST = 20
"""Samples at rest that a noise level needs."""

SETTLES_S = 0.02
"""The last of the rest is not counted as rest."""

QUIET = 0.25
"""Share of a spectrum's bins that no line is expected to reach, however much rings."""

AGREES = 0.25
"""Share of the channels, by how much each tells, that instants are no surer than."""

ESTIMATED = 0.2
"""By which share the variance of instants that are told by the floor may be larger: in 15 runs at
0.24 ms they were told to be 0.20 to 0.27 ms."""

LEAST_SAMPLES = 50
"""That a floor needs."""

REGULAR = 1.5
"""A longer interval than so many usual ones is a gap."""

SURE, LEAST_INSTANT_S = 5.0, 1e-5
"""Instants are unsure where the floor tells it by so many standard deviations, and by this much."""


def at_rest(t_s: Array, excitation: Excitation, shift_s: float) -> NDArray[np.bool_]:
    """Which samples are of a platform that rests.

    Parameters
    ----------
    t_s
        Of the samples, shape (n,).
    excitation, shift_s
        What was commanded, and how much later than it says.
    """
    if excitation.rests:
        return np.ones(len(t_s), dtype=bool)
    return np.asarray(t_s < excitation.start_s + shift_s - SETTLES_S)


def about_line(t_s: Array, value: Array) -> float:
    """Standard deviation of samples about a straight line, those far off aside."""
    line = np.polynomial.Polynomial.fit(t_s, value, 1)(t_s)
    rest = value - line
    far = np.abs(rest - np.median(rest))
    typical = float(np.median(far)) / 0.6745
    # Half of the samples on one step of the electronics: then what is far off cannot be told.
    near = far <= OUTLIER * typical if typical > 0.0 else np.ones(len(rest), dtype=bool)
    return float(rest[near].std(ddof=min(2, int(near.sum()) - 1)))


def stated_covariance(seen: "pd.DataFrame") -> Array:
    """Median covariance of the poses as pose.csv states it, in m and deg, shape (6, 6)."""
    axes = ("x", "y", "z", "roll", "pitch", "yaw")
    units = ("m", "m", "m", "deg", "deg", "deg")
    sigma = np.array(
        [
            np.median(seen[f"sigma_{a}_{u}"].to_numpy(dtype=float))
            for a, u in zip(axes, units, strict=True)
        ]
    )
    correlation = np.eye(6)
    for i, a in enumerate(axes):
        for k in range(i + 1, 6):
            name = f"corr_{a}_{axes[k]}"
            if name in seen:
                value = float(np.median(np.nan_to_num(seen[name].to_numpy(dtype=float))))
                correlation[i, k] = correlation[k, i] = value
    # Medians of entries need not be a correlation: what is left of it is.
    values, vectors = np.linalg.eigh(correlation)
    correlation = vectors @ np.diag(np.maximum(values, 1e-3)) @ vectors.T
    scale = np.sqrt(np.diag(correlation))
    correlation /= np.outer(scale, scale)
    return np.asarray(correlation * np.outer(sigma, sigma))


def instants_s(bundles: Sequence[Bundle], excitation: Excitation, shift_s: float) -> float:
    """How unsure the instants of samples are, by what they add to the noise of what moves.

    A value that changes at rate v, and whose instant is off by s, is off by v s: other for each
    sample, so that it raises the floor of a spectrum between its lines. Drive and rings are lines;
    a step, as where a frame was lost, is in one half of the motion: the lowest counts.

    Parameters
    ----------
    bundles
        Whose samples have their instants from one clock, their noise known.
    excitation, shift_s
        What was commanded, and how much later than it says.

    Returns
    -------
    float
        Standard deviation, s; 0 where the floor is that of the rest.
    """
    start_s, end_s = excitation.start_s + shift_s, excitation.end_s + shift_s
    middle_s = 0.5 * (start_s + end_s)
    parts = ((start_s, end_s), (start_s, middle_s), (middle_s, end_s))
    told = [_told(bundles, excitation, shift_s, part) for part in parts]
    square = min(one.square_s2 for one in told)
    least = max(SURE * told[0].unsure_s2, LEAST_INSTANT_S**2)
    return float(np.sqrt(square)) if told[0].square_s2 > least and square > 0.0 else 0.0


class _Told(NamedTuple):
    """The variance of instants, and how unsure it is where they are known."""

    square_s2: float
    unsure_s2: float


def _told(
    bundles: Sequence[Bundle],
    excitation: Excitation,
    shift_s: float,
    within_s: tuple[float, float],
) -> _Told:
    """What a stretch of time tells; where it tells nothing, both are infinite."""
    excess, power, still = [], [], []
    for bundle in bundles:
        chosen = (bundle.t_s >= within_s[0]) & (bundle.t_s < within_s[1])
        piece = _without_gaps(bundle.t_s, np.flatnonzero(chosen))
        if len(piece) < LEAST_SAMPLES:
            continue
        t_s, value = bundle.t_s[piece], bundle.value[piece]
        noise = np.diag(bundle.covariance)
        rest = int(at_rest(bundle.t_s, excitation, shift_s).sum())
        spread = np.hypot(2.0 / np.sqrt(QUIET * len(piece)), np.sqrt(2.0 / max(rest, 1)))
        excess.append(floor_between_lines(t_s, value, excitation.frequency_hz, QUIET) - noise)
        power.append(np.mean(_rate(t_s, value) ** 2, axis=0))
        still.append(spread * noise)
    rate, above, spreads = (np.concatenate([np.zeros(0), *one]) for one in (power, excess, still))
    moves = rate > 0.0
    if not moves.any():
        return _Told(np.inf, np.inf)
    squares = above[moves] / rate[moves]
    known = (rate[moves] / spreads[moves]) ** 2
    # Unsure instants raise all floors alike; rings and what sticks some more than others.
    order = np.argsort(squares)
    upto = np.cumsum(known[order]) / known.sum()
    square = float(squares[order][np.searchsorted(upto, AGREES)])
    return _Told(square, 1.0 / float(np.sqrt(known.sum())))


def with_instants(
    bundle: Bundle, instant_s: float, *, unsure: float = 0.0, together_s: float = 0.0
) -> Bundle:
    """A bundle whose instants are known to a standard deviation, s.

    Parameters
    ----------
    bundle, instant_s
        And that of each by itself.
    unsure
        By which share of itself its square may be larger; 0: it was stated.
    together_s
        And that by which neighbours are off alike.
    """
    if not instant_s and not together_s:
        return replace(bundle, jitter=None, late=None)
    rate = _rate(bundle.t_s, bundle.value)
    return replace(
        bundle,
        jitter=instant_s * rate if instant_s else None,
        jitter_unsure=unsure,
        late=together_s * rate if together_s else None,
    )


def _rate(t_s: Array, value: Array) -> Array:
    """Of each column, at each sample; samples that bear one time tell none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = np.gradient(value, t_s, axis=0)
    return np.asarray(np.where(np.isfinite(rate), rate, 0.0))


def _without_gaps(t_s: Array, places: NDArray[np.int64]) -> NDArray[np.int64]:
    """The longest stretch of samples that follow each other at their usual interval."""
    if len(places) < 2:
        return places
    interval = np.diff(t_s[places])
    pieces = np.split(places, np.flatnonzero(interval > REGULAR * np.median(interval)) + 1)
    return max(pieces, key=len)
