"""What a system states of its recording, its parameters and its candidates: whether it can be."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from analysis.engine.part import records_of, rings
from analysis.engine.system import Bundle, Candidate, Nuisance, Segment, Shape, System, Term
from cdpr8.errors import DataError

LEAST_SAMPLES = 3
"""A stretch of fewer tells nothing, and is not looked at."""

UNEVEN = 0.01
"""Where every sample counts, they are evenly apart to this share of their distance."""


def name_of(bundle: Bundle, place: int) -> str:
    """Which bundle it is, in words."""
    names = ", ".join(map(str, bundle.names)) if isinstance(bundle.names, tuple) else "?"
    return f"bundle {place} ({bundle.record + ': ' if bundle.record else ''}{names})"


def check_lists(system: Any) -> None:
    """Whether what a system states are lists of the engine's own things, and arrays in them.

    Raises
    ------
    DataError
        Something is not what it should be.
    """
    for what, kind in (("bundles", Bundle), ("nuisances", Nuisance), ("candidates", Candidate)):
        _check_list(getattr(system, what), kind, what)
    for i, bundle in enumerate(system.bundles):
        where = name_of(bundle, i)
        _check_list(bundle.segments, Segment, f"{where}, segments")
        _check_list(bundle.tones_hz, (int, float, np.number), f"{where}, tones_hz")
        for what in ("t_s", "value"):
            if not isinstance(getattr(bundle, what), np.ndarray):
                raise DataError(
                    f"{what} is a {type(getattr(bundle, what)).__name__}",
                    allowed="an array of numbers", where=where, remedy="np.asarray(...)",
                )  # fmt: skip
    for one in system.candidates:
        where = f"candidate {one.name!r}"
        _check_list(one.terms, Term, f"{where}, terms")
        _check_list(one.shapes, Shape, f"{where}, shapes")


def _check_list(found: Any, kind: Any, where: str) -> None:
    name = getattr(kind, "__name__", "number")
    if not isinstance(found, list | tuple):
        raise DataError(
            f"a {type(found).__name__}", allowed=f"a tuple of {name}", where=where,
            remedy="of one, (it,) with the comma",
        )  # fmt: skip
    for place, one in enumerate(found):
        if not isinstance(one, kind):
            raise DataError(
                f"a {type(one).__name__} in place {place}", allowed=name, where=where,
                remedy="see docs/engine.md, 'What you write'",
            )  # fmt: skip


def check_bundles(bundles: Sequence[Bundle]) -> None:
    """Whether recordings can be looked at.

    Raises
    ------
    DataError
        They cannot.
    """
    if not len(bundles):
        raise DataError(
            "no bundles", allowed="at least one", where="bundles",
            remedy="state what was recorded",
        )  # fmt: skip
    seen = 0
    for i, bundle in enumerate(bundles):
        where = name_of(bundle, i)
        _check_form(bundle, where)
        _check_noise(bundle, where)
        for segment in bundle.segments:
            inside = _check_segment(bundle, segment, where)
            seen += 0 if segment.sealed or inside < LEAST_SAMPLES else inside
    if not seen:
        raise DataError(
            f"no segment that may be seen holds {LEAST_SAMPLES} samples",
            allowed="a segment that is not sealed, from start_s up to end_s, over sample times",
            where="bundles",
            remedy="name causes by one part of the recording, seal another",
        )


def _check_form(bundle: Bundle, where: str) -> None:
    count = np.shape(bundle.t_s)
    if np.ndim(bundle.t_s) != 1 or np.ndim(bundle.value) != 2:
        raise DataError(
            f"t_s has shape {count}, value {np.shape(bundle.value)}", allowed="(n,) and (n, m)",
            where=where, remedy="of one channel, value[:, None]",
        )  # fmt: skip
    channels = bundle.value.shape[1]
    if len(bundle.value) != len(bundle.t_s):
        raise DataError(
            f"{len(bundle.value)} rows of value for {len(bundle.t_s)} sample times",
            allowed="one row for each", where=where, remedy="cut them alike",
        )  # fmt: skip
    for what, names in (("names", bundle.names), ("units", bundle.units)):
        if isinstance(names, str) or len(names) != channels:
            raise DataError(
                f"{what} is {names!r}", allowed=f"a tuple of {channels}, one for each channel",
                where=where, remedy='of one channel, ("x",)',
            )  # fmt: skip
    _check_times(np.asarray(bundle.t_s, dtype=float), where)
    _check_number("base_share", bundle.base_share, where, least=0.0, most=1.0)
    for tone_hz in bundle.tones_hz:
        _check_number("a tone of tones_hz", tone_hz, where, above=0.0)


def _check_times(t_s: Any, where: str) -> None:
    if not np.isfinite(t_s).all():
        place = int(np.flatnonzero(~np.isfinite(t_s))[0])
        raise DataError(
            f"t_s[{place}] is {t_s[place]}", allowed="finite times", where=where,
            remedy="leave out samples of which the time is not known",
        )  # fmt: skip
    back = np.flatnonzero(np.diff(t_s) <= 0.0)
    if back.size:
        k = int(back[0]) + 1
        raise DataError(
            f"t_s[{k}] is {t_s[k]:g} after {t_s[k - 1]:g}", allowed="times that increase",
            where=where, remedy="sort the samples, and leave out what is there twice",
        )  # fmt: skip


def _check_noise(bundle: Bundle, where: str) -> None:
    channels = bundle.value.shape[1]
    noise = np.asarray(bundle.covariance, dtype=float)
    remedy = "the variance of the noise of one sample, in the channels' units squared"
    if noise.shape != (channels, channels):
        raise DataError(
            f"covariance has shape {noise.shape}", allowed=f"({channels}, {channels})", where=where,
            remedy="of one channel, np.array([[sigma**2]])",
        )  # fmt: skip
    if not np.isfinite(noise).all() or not np.allclose(noise, noise.T):
        raise DataError(
            f"covariance is {noise.tolist()}", allowed="finite and symmetric", where=where,
            remedy=remedy,
        )  # fmt: skip
    try:
        np.linalg.cholesky(noise)
    except np.linalg.LinAlgError:
        raise DataError(
            f"covariance {noise.tolist()} is not positive definite",
            allowed="every variance above zero, no channel a copy of another", where=where,
            remedy=remedy,
        ) from None  # fmt: skip


def _check_segment(bundle: Bundle, segment: Segment, where: str) -> int:
    """How many samples it holds."""
    where = f"{where}, segment {segment.name!r}"
    if not segment.start_s < segment.end_s:
        raise DataError(
            f"from {segment.start_s:g} to {segment.end_s:g} s", allowed="start_s below end_s",
            where=where, remedy="samples from start_s up to, not with, end_s are looked at",
        )  # fmt: skip
    inside = segment.holds(bundle.t_s)
    t_s, value = bundle.t_s[inside], np.asarray(bundle.value[inside], dtype=float)
    bad = np.flatnonzero(~np.isfinite(value).all(axis=1))
    if bad.size:
        raise DataError(
            f"{bad.size} of {len(value)} samples are not finite, first at {t_s[bad[0]]:g} s",
            allowed="finite numbers in every sample that is looked at", where=where,
            remedy="end the segment before them, or fill them and say so in the noise",
        )  # fmt: skip
    if len(t_s) < LEAST_SAMPLES:
        return len(t_s)
    gaps = np.diff(t_s)
    nyquist_hz = 0.5 / float(np.median(gaps))
    for what, hertz in (("fundamental_hz", segment.fundamental_hz),
                        ("highest_hz", segment.highest_hz)):  # fmt: skip
        # What is above the highest line is not looked at: there it may say anything.
        if hertz is not None and not 0.0 < hertz < (
            nyquist_hz if what == "fundamental_hz" else np.inf
        ):
            raise DataError(
                f"{what} is {hertz:g}", allowed=f"above 0, below half the rate, {nyquist_hz:g} Hz",
                where=where, remedy="None: nothing repeats; nothing is too fast",
            )  # fmt: skip
    every = segment.fundamental_hz is None and segment.highest_hz is None
    if every and np.abs(gaps - np.median(gaps)).max() > UNEVEN * np.median(gaps):
        k = int(np.argmax(np.abs(gaps - np.median(gaps))))
        raise DataError(
            f"samples are {np.median(gaps):g} s apart, and {gaps[k]:g} s at {t_s[k]:g} s",
            allowed="evenly apart, where every sample counts", where=where,
            remedy="resample, end the segment at the gap, or give highest_hz",
        )  # fmt: skip
    return len(t_s)


def check_nuisances(system: System) -> None:
    """Whether parameters can be free within what is stated.

    Raises
    ------
    DataError
        They cannot.
    """
    _check_unique([one.name for one in system.nuisances], "nuisance")
    records = set(records_of(system))
    known = {one.name: {term.name for term in one.terms} for one in system.candidates}
    for one in system.nuisances:
        where = f"nuisance {one.name!r}"
        _check_number("sigma", one.sigma, where, above=0.0)
        _check_number("step", one.step, where, above=0.0)
        if one.record and one.record not in records:
            raise DataError(
                f"record {one.record!r}", allowed=_listed(records), where=where,
                remedy="the `record` of a bundle, or ''",
            )  # fmt: skip
        # Of a machine that states itself, some of what it knows may be left out of the list.
        if one.cause is not None and one.cause not in known and not rings(system):
            raise DataError(
                f"cause {one.cause!r}", allowed=_listed(known), where=where,
                remedy="the name of a candidate, or None",
            )  # fmt: skip
        if one.cause in known and one.term not in known[one.cause]:
            raise DataError(
                f"term {one.term!r}", allowed=_listed(known[one.cause]), where=where,
                remedy="the term of its cause that it is",
            )  # fmt: skip


def check_candidates(candidates: Sequence[Candidate]) -> None:
    """Whether candidates can be tried.

    Raises
    ------
    DataError
        They cannot.
    """
    _check_unique([one.name for one in candidates], "candidate")
    for one in candidates:
        where = f"candidate {one.name!r}"
        if not one.terms:
            raise DataError(
                "it has no terms", allowed="at least one", where=where,
                remedy="what is there or not there has one, and is `fixed`",
            )  # fmt: skip
        names = [term.name for term in one.terms]
        _check_unique(names, "term", where)
        _check_unique([shape.name for shape in one.shapes], "shape", where)
        _check_number("form_share", one.form_share, where, least=0.0, most=1.0)
        _check_number("prior", one.prior, where, above=0.0)
        unknown = sorted({term for whole in one.combinations for term in whole} - set(names))
        if unknown:
            raise DataError(
                f"combinations name {_listed(unknown)}", allowed=_listed(names), where=where,
                remedy="combinations are of its own terms",
            )  # fmt: skip
        for term in one.terms:
            _check_term(term, f"{where}, term {term.name!r}")
        for shape in one.shapes:
            _check_shape(shape, f"{where}, shape {shape.name!r}")
            if shape.term and shape.term not in names:
                raise DataError(
                    f"shape {shape.name!r} belongs to {shape.term!r}", allowed=_listed(names),
                    where=where, remedy="one of its own terms, or none",
                )  # fmt: skip


def _check_term(term: Term, where: str) -> None:
    _check_range(term.low, term.high, where)
    if not (term.step and term.low <= term.step <= term.high):
        raise DataError(
            f"step {term.step:g}", allowed=f"not 0, within {term.low:g} to {term.high:g}",
            where=where, remedy="a size at which it would be seen",
        )  # fmt: skip
    for what, end, right in (("least", term.least, term.low), ("most", term.most, term.high)):
        wider = end is None or (end <= right if what == "least" else end >= right)
        if not wider:
            raise DataError(
                f"{what} {end:g}", allowed=f"beyond {right:g}", where=where,
                remedy="how far beyond its plausible range a fit may go, or None",
            )  # fmt: skip


def _check_shape(shape: Shape, where: str) -> None:
    _check_range(shape.low, shape.high, where)
    if shape.logarithmic and not shape.low > 0.0:
        raise DataError(
            f"low {shape.low:g} of a logarithmic shape", allowed="above 0", where=where,
            remedy="logarithmic=False, where equal differences count alike",
        )  # fmt: skip
    for value in (shape.default, *shape.grid):
        if not shape.low <= value <= shape.high:
            raise DataError(
                f"{value:g} as default or in the grid",
                allowed=f"{shape.low:g} to {shape.high:g}", where=where,
                remedy="within its plausible range",
            )  # fmt: skip


def _check_range(low: float, high: float, where: str) -> None:
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise DataError(
            f"low {low:g}, high {high:g}", allowed="finite, low below high", where=where,
            remedy="the range that is plausible",
        )  # fmt: skip


def _check_number(
    what: str,
    value: float,
    where: str,
    *,
    least: float = -np.inf,
    above: float = -np.inf,
    most: float = np.inf,
) -> None:
    if not (np.isfinite(value) and value >= least and value > above and value <= most):
        allowed = f"above {above:g}" if above > -np.inf else f"{least:g} or more"
        allowed = f"{least:g} to {most:g}" if most < np.inf else allowed
        raise DataError(f"{what} is {value!r}", allowed=allowed, where=where,
                        remedy="see docs/engine.md, 'What you write'")  # fmt: skip


def _check_unique(names: Sequence[str], what: str, where: str = "") -> None:
    twice = sorted({one for one in names if list(names).count(one) > 1})
    if twice:
        raise DataError(
            f"more than one {what} is called {_listed(twice)}", allowed="names that differ",
            where=where or f"{what}s", remedy="rename or leave out one",
        )  # fmt: skip


def _listed(names: Iterable[str]) -> str:
    return ", ".join(repr(one) for one in sorted(names))
