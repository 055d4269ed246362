"""The library's effects as candidates: their magnitudes as terms, their other numbers as shapes."""

from collections.abc import Sequence
from itertools import chain

import numpy as np

from analysis.diagnosis.policies import (
    AKIN,
    BETWEEN,
    FAMILIES,
    GROWING,
    LAW,
    LINEAR,
    LOW_IS,
    NUMBER,
    POLICIES,
    WHOLE,
    Policy,
)
from analysis.engine.candidate import Candidate, Shape, Term
from model.library.discovery import library
from model.library.effect import Effect, Parameter

CABLE_NUMBERS = tuple(range(1, 9))

PAIRS = tuple((i, k) for i in CABLE_NUMBERS for k in CABLE_NUMBERS if i < k)

SATURATION_STEP_N = 0.3

RUN_CODE = 1000.0
"""Moments are seconds of a run's clock and this many times the run's number; after the last run's
number comes that of all of them."""


def candidates(
    names: Sequence[str] | None, times_s: Sequence[tuple[float, float]], frame_hz: float
) -> tuple[Candidate, ...]:
    """Candidates of the library.

    Parameters
    ----------
    names
        Those to look at; None: all.
    times_s
        Start and end of the motion of each run.
    frame_hz
        Of the camera.
    """
    chosen = library() if names is None else {name: library()[name] for name in names}
    found = []
    for name, effect in chosen.items():
        if name == "drive_harmonic":
            found.append(_harmonic(effect))
        elif name == "cell_swapped":
            found.append(_swapped(effect))
        elif name == "cell_saturation":
            found.append(_saturation(effect))
        elif name == "frames_dropped":
            found.append(_dropped(effect, times_s, frame_hz))
        else:
            found.append(_plain(effect, POLICIES.get(name, Policy()), len(times_s)))
    return tuple(found)


def _plain(effect: Effect, policy: Policy, records: int) -> Candidate:
    magnitudes = [
        one for one in effect.parameters if one.magnitude and one.name not in policy.aside
    ]
    terms = []
    for one in magnitudes:
        step = policy.steps.get(one.name, one.default) or 0.2 * one.high
        if effect.name == "geometry":
            step = 0.003
        if one.per_cable:
            terms += [_term(one, step, str(cable)) for cable in CABLE_NUMBERS]
        else:
            terms.append(_term(one, step, ""))
    shapes = tuple(
        Shape(one.name, one.unit, one.default, one.low, one.high,
              policy.shapes[one.name], logarithmic=one.low > 0.0, whole=one.name in WHOLE,
              between=one.name in BETWEEN, low_is=LOW_IS.get(one.name, ""))
        for one in effect.parameters
        if one.name in policy.shapes
    )  # fmt: skip
    shapes += tuple(
        Shape(begun_name(one.name, cable, record, records), one.unit, one.default, one.low,
              one.high, logarithmic=False, term=f"{magnitudes[0].name}@{cable}")
        for one in effect.parameters
        if one.name in policy.begins
        for record in range(records)
        for cable in CABLE_NUMBERS
    )  # fmt: skip
    exact = effect.acts.side in ("parameter", "cell", "camera", "clock", "drive")
    form = policy.form_share if policy.form_share is not None else NUMBER if exact else LAW
    wholes: tuple[tuple[str, ...], ...] = ()
    if effect.name == "geometry":
        wholes = _shifted(magnitudes)
    elif len(magnitudes) == 1 and magnitudes[0].per_cable:
        wholes = _wholes(magnitudes[0])
    return Candidate(
        name=effect.name,
        title=effect.title,
        side=effect.acts.side,
        terms=tuple(terms),
        shapes=shapes,
        form_share=form,
        together=policy.together,
        shareable=len(magnitudes) == 1 or effect.name == "geometry",
        combinations=wholes,
        akin=AKIN.get(effect.name, ()),
        chosen_terms=12 if effect.name == "geometry" else 0,
        family=FAMILIES.get(effect.name, ""),
        grows=effect.name in GROWING,
        bends=policy.bends,
    )


def begun_name(parameter: str, cable: int, record: int, records: int) -> str:
    """What a number of the state is called in which a cable begins a run."""
    return f"{parameter}@{cable}" + (f" in run {record + 1}" if records > 1 else "")


def _term(parameter: Parameter, step: float, place: str) -> Term:
    name = f"{parameter.name}@{place}" if place else parameter.name
    return Term(name, parameter.name, parameter.unit, place, parameter.low, parameter.high, step)


def _wholes(parameter: Parameter) -> tuple[tuple[str, ...], ...]:
    """All cables, the upper and the lower four: sets that often share their fate."""
    sets = (CABLE_NUMBERS, CABLE_NUMBERS[:4], CABLE_NUMBERS[4:])
    return tuple(tuple(f"{parameter.name}@{cable}" for cable in one) for one in sets)


def _shifted(parameters: Sequence[Parameter]) -> tuple[tuple[str, ...], ...]:
    """Posts or plates that were measured as one: all points of a kind, along one axis or any."""
    bases = [one for one in parameters if one.name.startswith("base")]
    anchors = [one for one in parameters if one.name.startswith("anchor")]
    kinds = [bases, anchors, *([one] for one in parameters)]
    return tuple(
        tuple(chain.from_iterable(sets))
        for kind in kinds
        for sets in zip(*map(_wholes, kind), strict=True)
    )


def _harmonic(effect: Effect) -> Candidate:
    limit = next(one.high for one in effect.parameters if one.name == "harmonic_share")
    terms = tuple(
        Term(name, "harmonic_share", "1", "", -limit, limit, 0.01) for name in ("sine", "cosine")
    )
    order = Shape("order", "1", 2.0, 2.0, 5.0, (2.0, 3.0, 4.0, 5.0), whole=True)
    return Candidate(effect.name, effect.title, effect.acts.side, terms, (order,), LINEAR,
                     together=True, shareable=False)  # fmt: skip


def _swapped(effect: Effect) -> Candidate:
    term = Term("swapped", "swapped", "1", "", 0.0, 1.0, 1.0)
    pair = Shape(
        "pair", "1", 0.0, 0.0, len(PAIRS) - 1.0, tuple(float(i) for i in range(len(PAIRS))),
        logarithmic=False, whole=True,
    )  # fmt: skip
    return Candidate(effect.name, effect.title, effect.acts.side, (term,), (pair,), NUMBER,
                     fixed=True)  # fmt: skip


def _saturation(effect: Effect) -> Candidate:
    terms = tuple(
        Term(f"clipped_n@{cable}", "clipped_n", "N", str(cable), 0.0, 30.0, SATURATION_STEP_N)
        for cable in CABLE_NUMBERS
    )
    # Over how much of what is cut off it bends: what cuts off nothing then does nothing.
    knee = Shape("knee_share", "1", 0.5, 0.002, 5.0, (0.1, 1.0))
    return Candidate(effect.name, effect.title, effect.acts.side, terms, (knee,), 0.1,
                     shareable=False, grows=True)  # fmt: skip


def _dropped(effect: Effect, times_s: Sequence[tuple[float, float]], frame_hz: float) -> Candidate:
    term = Term("frames", "frames", "1", "", 0.0, 3.0, 1.0)
    count = Shape("count", "1", 1.0, 1.0, 3.0, (1.0, 2.0, 3.0), logarithmic=False, whole=True)
    moments: list[float] = []
    spacing = 0.25 if len(times_s) == 1 else 0.5
    spans = list(times_s)
    if len(spans) > 1:
        # A program that loses them may do so in every run, and at the same time.
        spans.append((min(start for start, _ in spans), min(end for _, end in spans)))
    for i, (start, end) in enumerate(spans):
        moments += [RUN_CODE * i + at for at in np.arange(start + 0.25, end - 0.1, spacing)]
    when = Shape(
        "moment", "s", moments[0], 0.0, 1e5, tuple(moments),
        logarithmic=False, whole=True, finest=0.5 / frame_hz,
    )  # fmt: skip
    again = tuple(
        Shape(one.name, one.unit, one.default, one.low, one.high, logarithmic=False, whole=True)
        for one in effect.parameters
        if one.name.startswith("again_")
    )
    return Candidate(effect.name, effect.title, effect.acts.side, (term,), (count, when, *again),
                     NUMBER, fixed=True)  # fmt: skip
