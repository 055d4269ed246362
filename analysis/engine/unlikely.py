"""What is recorded or simulated and is seldom meant: a dead channel, another unit, rounding.

None of it is an error by itself, and each makes a diagnosis of something else: so it is said.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate
from analysis.engine.recorded import looked_at, name_of
from analysis.engine.system import Prediction, System
from analysis.engine.whiten import sigmas_of

LEAST_SAMPLES = 10
"""Of fewer nothing is said."""

OTHER_UNIT = 100.0
"""What is recorded varies so many times as much as what is simulated, or as little."""

VARIES = 10.0
"""Standard deviations of the noise, by which one of the two varies there."""

STILL = 1e-6
"""What is simulated to vary by less, in its noise, is rounding: it is simulated not to move."""

FAR_OFF = 10.0
"""So many times what either varies by, recorded and simulated are hardly of the same zero."""

COARSE = 0.1
"""Rounding to more than this share of the noise is felt."""

DECIMALS = range(-2, 7)
"""To so many places numbers are rounded."""


def unlikely(bundles: Sequence[Bundle], nominal: Prediction) -> tuple[str, ...]:
    """What is hardly meant, a sentence for each.

    Parameters
    ----------
    bundles
        What was recorded.
    nominal
        What is simulated, nothing left out.
    """
    return _said(bundles, nominal, _odd)


def _said(
    bundles: Sequence[Bundle], nominal: Prediction, odd: Callable[["_Channel"], Iterator[str]]
) -> tuple[str, ...]:
    """What is said of each channel of which enough is recorded, and in which bundle it is."""
    found = []
    for i, (bundle, seen) in enumerate(zip(bundles, nominal, strict=True)):
        inside = looked_at(bundle)
        sigmas = np.median(sigmas_of(bundle)[inside], axis=0) if inside.any() else ()
        for k, sigma in enumerate(sigmas):
            recorded, simulated = bundle.value[inside, k], np.asarray(seen)[inside, k]
            one = _Channel(
                bundle.names[k], bundle.units[k], recorded[np.isfinite(recorded)], simulated,
                float(sigma),
            )  # fmt: skip
            if int(inside.sum()) >= LEAST_SAMPLES and len(one.recorded):
                found += [f"{name_of(bundle, i)}: {what}" for what in odd(one)]
    return tuple(found)


class _Channel(NamedTuple):
    """What was recorded and simulated of one channel, and its noise."""

    name: str
    unit: str
    recorded: Array
    simulated: Array
    sigma: float


def _odd(one: _Channel) -> Iterator[str]:
    if np.ptp(one.recorded) == 0.0:
        yield (
            f"{one.name!r} is {one.recorded[0]:g} {one.unit} in all of {len(one.recorded)} "
            f"samples, though its noise is stated as {one.sigma:.2g} {one.unit}. A channel that is "
            "dead names causes: leave it out"
        )
        return
    spread, expected = float(np.std(one.recorded)), float(np.std(one.simulated))
    varies = max(spread, expected) > VARIES * one.sigma and expected > STILL * one.sigma
    if varies and not 1.0 / OTHER_UNIT < spread / expected < OTHER_UNIT:
        yield (
            f"{one.name!r} varies by {spread:.2g} {one.unit} as recorded, and by {expected:.2g} "
            f"{one.unit} as simulated. Both are taken to be in the unit that is stated"
        )


def elsewhere(bundles: Sequence[Bundle], nominal: Prediction) -> tuple[str, ...]:
    """Channels that are recorded far from where they are simulated, a sentence for each.

    Parameters
    ----------
    bundles
        What was recorded.
    nominal
        What is simulated, nothing left out.
    """
    return _said(bundles, nominal, _away)


def _away(one: _Channel) -> Iterator[str]:
    off = float(np.median(one.recorded) - np.median(one.simulated))
    spread = max(float(np.std(one.recorded)), float(np.std(one.simulated)))
    varies = max(spread, VARIES * one.sigma)
    if abs(off) > FAR_OFF * varies:
        yield (
            f"{one.name!r} is {off:+.3g} {one.unit} from what is simulated, "
            f"{abs(off) / varies:.0f} times what either varies by. Both are taken to be in the "
            "unit that is stated, from the same zero"
        )


def missing_of(system: System) -> tuple[str, ...]:
    """What a system states nothing of, a sentence for each: candidates, data to be held out."""
    found = []
    if not len(system.candidates):
        found.append("the list of candidates is empty: whatever differs, nothing can be named")
    held = [(bundle, one) for bundle in system.bundles for one in bundle.segments if one.held_out]
    if held and not any(one.holds(bundle.t_s).any() for bundle, one in held):
        bundle, one = held[0]
        found.append(
            f"nothing is held out: segment {one.name!r}, from {one.start_s:g} to {one.end_s:g} s, "
            f"holds none of the samples from {bundle.t_s[0]:g} to {bundle.t_s[-1]:g} s"
        )
    return tuple(found)


def unknown_kin(candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Names in `akin` that are no candidate's, a sentence for each."""
    names = {one.name for one in candidates}
    return tuple(
        f"candidate {one.name!r}: akin names {other!r}, of which there is none in the list"
        for one in candidates
        for other in one.akin
        if other not in names
    )


def rounded(bundles: Sequence[Bundle], simulated: Sequence[Prediction]) -> tuple[str, ...]:
    """Channels that a simulator rounds, a sentence for each.

    Parameters
    ----------
    bundles
        What was recorded.
    simulated
        Several points: one alone may be a round number by its nature.
    """
    found = []
    for i, bundle in enumerate(bundles):
        inside = looked_at(bundle)
        if int(inside.sum()) < LEAST_SAMPLES:
            continue
        sigmas = np.median(sigmas_of(bundle)[inside], axis=0)
        for k, (name, unit) in enumerate(zip(bundle.names, bundle.units, strict=True)):
            step = min(_rounded_to(one[i][inside, k]) for one in simulated)
            if step > COARSE * sigmas[k]:
                found.append(
                    f"{name_of(bundle, i)}: {name!r} is simulated in steps of {step:g} {unit}, "
                    f"beside a noise of {sigmas[k]:.2g} {unit}. Small changes are lost in that: "
                    "round nothing"
                )
    return tuple(found)


def _rounded_to(values: Array) -> float:
    """The step of a decimal place to which all of it is rounded; 0: none."""
    for places in DECIMALS:
        there, step = np.round(values, places), 10.0**-places
        # What is far smaller than a step rounds to nothing, and was not rounded to it.
        if np.ptp(there) > 0.0 and np.allclose(values, there, rtol=1e-14, atol=step * 1e-6):
            return float(step)
    return 0.0
