"""The system's own tones: where a ring is seen, and how much of it is seen elsewhere."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment

FAR_ABOVE = 1.5
"""A tone this many times above the drive is left to ring by whatever kicks it."""

NEAR = 0.15
"""Lines this near a tone, as a share of it, may be its ring."""

SOUGHT = 0.05
"""A ring is sought this near a tone, as a share of it."""

RING_SPACING, RING_SHARE = 0.7, 0.25
"""Rings at the tones nearest a drive are left out of its lines: vectors so far apart, in lines of
the stretch, and no more of them than this share of its samples."""

UNSTEADY = 0.03
"""No ring is quite steady: this share of it is seen as a slow change of other lines."""

ALIASED = 0.03
"""The same where a tone is seen at another frequency, being faster than it is sampled."""

WIDTH = 1.5
"""And lines this near, in lines of a stretch that does not repeat."""

RESONANT = 0.2
"""A drive this near a tone, as a share of itself, leaves nothing but means to be foretold."""


def resonant(tone_hz: float, drive_hz: float) -> bool:
    """Whether a drive is so near a tone that nothing but means can be foretold."""
    return abs(tone_hz - drive_hz) < RESONANT * drive_hz


def rings(line_hz: float, order: int, segment: Segment, bundle: Bundle) -> bool:
    """Whether a line may be the system's own ring."""
    drive_hz = drive_frequency_hz(bundle)
    length_s = segment.end_s - segment.start_s
    # Over a short stretch a ring is as wide as the stretch is short.
    wide_hz = WIDTH / length_s if segment.fundamental_hz is None else 0.0
    if line_hz > 0.0 and any(resonant(tone, drive_hz) for tone in bundle.tones_hz):
        return True
    above = [tone for tone in bundle.tones_hz if tone > FAR_ABOVE * drive_hz]
    if above and line_hz >= min(above) - max(NEAR * min(above), wide_hz):
        return True
    if any(abs(line_hz - tone) < max(NEAR * tone, wide_hz) for tone in bundle.tones_hz):
        return True
    # Whatever else is seen at the drive's own line, most of it is driven, and the rest leaks there.
    if not (line_hz or order) or (line_hz == segment.fundamental_hz and order == 0):
        return False
    # What is sampled slower than a tone shows it elsewhere.
    rate_hz = (len(bundle.t_s) - 1) / (bundle.t_s[-1] - bundle.t_s[0])
    slow_hz = 0.5 * (order + 1) / length_s
    return any(
        abs(abs(tone - round(tone / rate_hz) * rate_hz) - line_hz)
        < max(ALIASED * tone, wide_hz) + slow_hz
        for tone in bundle.tones_hz
        if tone > 0.5 * rate_hz
    )


def leaked(
    t_s: Array, value: Array, basis: Array, steady: NDArray[np.bool_], tones_hz: Sequence[float]
) -> Array:
    """Variance that rings at the tones give vectors that are not made for them.

    Parameters
    ----------
    t_s, value
        Samples in units of their noise, shapes (n,), (n, m).
    basis
        The vectors, shape (n, k).
    steady
        Those that are no ring: a slow change may be one, shape (k,).
    tones_hz
        Where to look for rings, each within a few per cent of it.

    Returns
    -------
    Array
        Channel by channel, shape (m k,).
    """
    rest = value - basis[:, steady] @ (basis[:, steady].T @ value)
    found = np.zeros((value.shape[1], basis.shape[1]))
    step_hz = 0.25 / (t_s[-1] - t_s[0])
    for tone in tones_hz:
        count = int(SOUGHT * tone / step_hz)
        turns = np.exp(2j * np.pi * np.outer(tone + step_hz * np.arange(-count, count + 1), t_s))
        power = 4.0 * np.abs(turns @ rest) ** 2 / len(t_s) ** 2
        loudest = np.argmax(power, axis=0)
        # The loudest of so many lines of noise alone is this loud.
        noise = 4.0 / len(t_s) * np.log(2.0 + count)
        for c, place in enumerate(loudest):
            amplitude = max(float(power[place, c]) - noise, 0.0)
            found[c] += 0.5 * amplitude * np.abs(turns[place] @ basis) ** 2
            found[c, ~steady] += 0.5 * amplitude * len(t_s) * UNSTEADY**2
    return found.reshape(-1)


def drive_frequency_hz(bundle: Bundle) -> float:
    """The drive's frequency, where any stretch has one."""
    known = [one.fundamental_hz for one in bundle.segments if one.fundamental_hz is not None]
    return known[0] if known else np.inf


def rings_near(t_s: Array, segment: Segment, bundle: Bundle) -> Array:
    """Vectors of rings at the tones nearest a drive, which no damping ends soon, shape (n, k)."""
    drive_hz = segment.fundamental_hz
    columns: list[Array] = []
    if drive_hz is None:
        return np.zeros((len(t_s), 0))
    step_hz = RING_SPACING / (segment.end_s - segment.start_s)
    for tone in sorted(bundle.tones_hz, key=lambda one: abs(one - drive_hz)):
        count = int(np.ceil(SOUGHT * tone / step_hz))
        if len(columns) + 4 * count + 2 > RING_SHARE * len(t_s):
            break
        if resonant(tone, drive_hz):
            continue
        for hertz in tone + step_hz * np.arange(-count, count + 1):
            columns += [np.cos(2.0 * np.pi * hertz * t_s), np.sin(2.0 * np.pi * hertz * t_s)]
    return np.stack(columns, axis=1) if columns else np.zeros((len(t_s), 0))
