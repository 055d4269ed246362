"""What a system states of its recordings: whether they can be looked at."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.engine.bundle import Bundle, Segment
from cdpr8.errors import DataError

LEAST_SAMPLES = 3
"""A stretch of fewer tells nothing, and is not looked at."""

UNEVEN = 0.01
"""Where every sample counts, they are evenly apart to this share of their distance."""


def name_of(bundle: Bundle, place: int) -> str:
    """Which bundle it is, in words."""
    names = ", ".join(map(str, bundle.names)) if isinstance(bundle.names, tuple) else "?"
    return f"bundle {place} ({bundle.record + ': ' if bundle.record else ''}{names})"


def looked_at(bundle: Bundle) -> NDArray[np.bool_]:
    """Which samples lie in a segment, shape (n,)."""
    inside = np.zeros(len(bundle.t_s), dtype=bool)
    for one in bundle.segments:
        inside |= one.holds(bundle.t_s)
    return inside


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
    seen = fitted = 0
    for i, bundle in enumerate(bundles):
        where = name_of(bundle, i)
        _check_form(bundle, where)
        _check_noise(bundle, where)
        for segment in bundle.segments:
            inside = _check_segment(bundle, segment, where)
            inside = 0 if segment.sealed or inside < LEAST_SAMPLES else inside
            seen += inside
            fitted += 0 if segment.held_out else inside
        _check_apart(bundle, where)
    if not seen:
        raise DataError(
            f"no segment that may be seen holds {LEAST_SAMPLES} samples",
            allowed="a segment that is not sealed, from start_s up to end_s, over sample times",
            where="bundles",
            remedy="name causes by one part of the recording, seal another",
        )
    if not fitted:
        raise DataError(
            "every segment is held out", allowed="one that is not, to fit to", where="bundles",
            remedy="hold out the last third: two segments, the second with held_out=True",
        )  # fmt: skip


def _check_form(bundle: Bundle, where: str) -> None:
    count = np.shape(bundle.t_s)
    if np.ndim(bundle.t_s) != 1 or np.ndim(bundle.value) != 2:
        raise DataError(
            f"t_s has shape {count}, value {np.shape(bundle.value)}", allowed="(n,) and (n, m)",
            where=where, remedy="of one channel, value[:, None]",
        )  # fmt: skip
    for what in ("t_s", "value"):
        held = getattr(bundle, what)
        if np.ma.isMaskedArray(held) or not _real(held):
            kind = "a masked array" if np.ma.isMaskedArray(held) else f"an array of {held.dtype}"
            raise DataError(
                f"{what} is {kind}", allowed="an array of real numbers", where=where,
                remedy="np.asarray(..., dtype=float); what is not known is NaN, in no segment",
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
    twice = sorted({one for one in bundle.names if list(bundle.names).count(one) > 1})
    if twice:
        raise DataError(
            f"more than one channel is called {listed(twice)}", allowed="names that differ",
            where=where, remedy="rename one: what is found is told by the channel's name",
        )  # fmt: skip
    _check_times(np.asarray(bundle.t_s, dtype=float), where)
    check_number("base_share", bundle.base_share, where, least=0.0, most=1.0)
    for tone_hz in bundle.tones_hz:
        check_number("a tone of tones_hz", tone_hz, where, above=0.0)


def _real(held: Any) -> bool:
    """Whether an array holds real numbers."""
    return np.issubdtype(held.dtype, np.floating) or np.issubdtype(held.dtype, np.integer)


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
            remedy="np.diag([sigma**2, ...]), one for each channel",
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


def _check_apart(bundle: Bundle, where: str) -> None:
    """Whether no sample is looked at twice."""
    held = np.array([one.holds(bundle.t_s) for one in bundle.segments])
    twice = np.flatnonzero(held.sum(axis=0) > 1) if len(held) else held
    if twice.size:
        both = [one.name for one, inside in zip(bundle.segments, held, strict=True)
                if inside[twice[0]]]  # fmt: skip
        raise DataError(
            f"{twice.size} samples lie in two segments ({listed(both)}), first that at "
            f"{bundle.t_s[twice[0]]:g} s", allowed="each sample in one at most", where=where,
            remedy="let the second start_s be the first's end_s: that is not in the first",
        )  # fmt: skip


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
            remedy="end the segment before them, or give the channel a bundle without them",
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


def check_number(
    what: str,
    value: float,
    where: str,
    *,
    least: float = -np.inf,
    above: float = -np.inf,
    most: float = np.inf,
) -> None:
    """Whether a number is finite and within what it may be.

    Raises
    ------
    DataError
        It is not.
    """
    if not (np.isfinite(value) and value >= least and value > above and value <= most):
        allowed = f"above {above:g}" if above > -np.inf else f"{least:g} or more"
        allowed = f"{least:g} to {most:g}" if most < np.inf else allowed
        raise DataError(f"{what} is {value!r}", allowed=allowed, where=where,
                        remedy="see docs/engine.md, 'What you write'")  # fmt: skip


def listed(names: Iterable[str]) -> str:
    """Names as they are said to the user."""
    return ", ".join(repr(one) for one in sorted(names))
