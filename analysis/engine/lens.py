"""The lens: samples seen as a few hundred numbers that hold what physics can be told by.

Over a periodic stretch every channel is resolved into harmonics of the drive, and the slow change
of the first ones; over another stretch into lines of a Fourier series, or, where every sample is
to be looked at, into all its lines by a cosine transform. Each is an orthonormal set of vectors
over the samples, so white noise stays white and one harmonic of a minute's motion is one number: a
law that misses it by a hair does not count as thousands of samples missed. Where every line is
looked at, that is why it is lines and not samples: what is wrong with a law has the colour of what
the law does, and of sixty thousand samples of a slow signal a few hundred lines tell anything.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from analysis.engine.system import Array, Bundle, Prediction, Segment

HARMONICS = 10
"""The drive's harmonics that are looked at."""

SLOW_HARMONICS = 2
"""Harmonics whose slow change is looked at, from the mean on."""

SLOW_ORDERS = 3
"""Degrees of the polynomials that follow the change."""

LINE_HZ = 20.0
"""Of a stretch that does not repeat, lines up to here."""

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

BAND = 0.05
"""Where every line is looked at, so wide are the bands of lines that belong together, as a share
of their frequency: a law that is off is off on all of them alike."""

BAND_LINES = (8, 64)
"""And neither narrower nor wider, in lines."""

CAPTURED = 1e-6
"""A vector that is this much the others' is none of its own."""


@dataclass(frozen=True)
class Labels:
    """What each number is, arrays of shape (f,).

    Attributes
    ----------
    bundle, channel, segment
        Places in the system's bundles and in the bundle.
    line
        Harmonic of the drive; in a stretch that does not repeat, the frequency in Hz.
    ringing
        Whether the system rings here: the phase of what is seen is not to be foretold.
    growth
        How much less sure a law is of this line than of the drive's own: its multiple of it.
    quadrature
        0: mean or cosine, 1: sine.
    order
        Degree of the slow change; 0: none.
    held_out
        Whether it is kept back for confirming.
    group
        Numbers of one channel, stretch and line, cosine and sine, share their group; those of its
        slow change have another.
    stretch
        Numbers of one channel and stretch share it.
    samples
        How many samples the stretch has.
    free
        Whether the stretch does not repeat.
    every
        Whether all lines of the stretch are looked at; a band of them shares its group.
    sealed
        Whether nothing but the proof may see it.
    """

    bundle: NDArray[np.int64]
    channel: NDArray[np.int64]
    segment: NDArray[np.int64]
    line: Array
    ringing: NDArray[np.bool_]
    growth: Array
    quadrature: NDArray[np.int64]
    order: NDArray[np.int64]
    held_out: NDArray[np.bool_]
    group: NDArray[np.int64]
    stretch: NDArray[np.int64]
    samples: NDArray[np.int64]
    free: NDArray[np.bool_]
    every: NDArray[np.bool_]
    sealed: NDArray[np.bool_]

    @property
    def series(self) -> NDArray[np.int64]:
        """Numbers of one channel of one bundle share it."""
        return self.bundle * (int(self.channel.max(initial=0)) + 1) + self.channel


@dataclass(frozen=True)
class _Part:
    """One stretch of one bundle; no basis: the cosine transform."""

    bundle: int
    rows: NDArray[np.int64]
    basis: Array | None
    whiten: Array


class Lens:
    """Makes features of samples; made once for a system.

    Parameters
    ----------
    bundles
        What was recorded.
    """

    def __init__(self, bundles: "list[Bundle] | tuple[Bundle, ...]") -> None:
        self.bundles = tuple(bundles)
        self._parts: list[_Part] = []
        rows: list[tuple[float, ...]] = []
        rung: list[Array] = []
        group, stretch = 0, -1
        for b, bundle in enumerate(self.bundles):
            whiten = np.linalg.inv(np.linalg.cholesky(bundle.covariance))
            for s, segment in enumerate(bundle.segments):
                inside = np.flatnonzero(
                    (bundle.t_s >= segment.start_s) & (bundle.t_s < segment.end_s)
                )
                if inside.size < 3:
                    continue
                every = segment.fundamental_hz is None and segment.highest_hz is None
                basis: Array | None = None
                if every:
                    lines = _every_line(bundle.t_s[inside])
                    kept, bands = list(range(inside.size)), _bands(inside.size)
                else:
                    vectors, lines = _vectors(bundle.t_s[inside], segment)
                    rings = _rings_near(bundle.t_s[inside], segment, bundle)
                    basis, kept = _orthonormal(vectors, rings)
                self._parts.append(_Part(b, inside, basis, whiten))
                if basis is None or segment.fundamental_hz is None:
                    rung.append(np.zeros(len(kept) * len(bundle.names)))
                else:
                    seen = bundle.value[inside] @ whiten.T
                    steady = np.array([lines[place][2] == 0 for place in kept])
                    rung.append(leaked(bundle.t_s[inside], seen, basis, steady, bundle.tones_hz))
                hertz = segment.fundamental_hz or 1.0
                unit = 1.0 if segment.fundamental_hz is not None else _drive_hz(bundle)
                for c in range(len(bundle.names)):
                    stretch += 1
                    groups: dict[tuple[float, bool], int] = {}
                    for place in kept:
                        line, quadrature, order = lines[place]
                        own = (bands[place] if every else line, order > 0)
                        if own not in groups:
                            groups[own] = group
                            group += 1
                        rows.append(
                            (
                                b,
                                c,
                                s,
                                line,
                                _rings(line * hertz, order, segment, bundle),
                                max(line / unit, 1.0),
                                quadrature,
                                order,
                                segment.held_out,
                                groups[own],
                                stretch,
                                inside.size,
                                segment.fundamental_hz is None,
                                every,
                                segment.sealed,
                            )
                        )
        self.rung: Array = np.concatenate(rung) if rung else np.zeros(0)
        """What the ring of the recording gives each feature of a stretch that repeats, as variance,
        shape (f,)."""
        columns = list(zip(*rows, strict=True)) if rows else [()] * 15
        self.labels = Labels(
            bundle=np.array(columns[0], dtype=np.int64),
            channel=np.array(columns[1], dtype=np.int64),
            segment=np.array(columns[2], dtype=np.int64),
            line=np.array(columns[3], dtype=float),
            ringing=np.array(columns[4], dtype=bool),
            growth=np.array(columns[5], dtype=float),
            quadrature=np.array(columns[6], dtype=np.int64),
            order=np.array(columns[7], dtype=np.int64),
            held_out=np.array(columns[8], dtype=bool),
            group=np.array(columns[9], dtype=np.int64),
            stretch=np.array(columns[10], dtype=np.int64),
            samples=np.array(columns[11], dtype=np.int64),
            free=np.array(columns[12], dtype=bool),
            every=np.array(columns[13], dtype=bool),
            sealed=np.array(columns[14], dtype=bool),
        )

    @property
    def size(self) -> int:
        """Number of features."""
        return len(self.labels.line)

    def __call__(self, prediction: Prediction) -> Array:
        """Features of samples, in units of their noise.

        Parameters
        ----------
        prediction
            For each bundle, shape (n, m).

        Returns
        -------
        Array
            Shape (f,). Channels of a bundle are made independent by the inverse Cholesky factor
            of their covariance: a feature is of its channel less what those before it tell.
        """
        found = []
        for part in self._parts:
            samples = prediction[part.bundle][part.rows]
            if part.basis is None:
                seen = dct(samples, type=2, norm="ortho", axis=0)
            else:
                seen = part.basis.T @ samples
            found.append((seen @ part.whiten.T).T.reshape(-1))
        return np.concatenate(found) if found else np.zeros(0)

    def of_data(self) -> Array:
        """Features of what was recorded."""
        return self([bundle.value for bundle in self.bundles])


def resonant(tone_hz: float, drive_hz: float) -> bool:
    """Whether a drive is so near a tone that nothing but means can be foretold."""
    return abs(tone_hz - drive_hz) < RESONANT * drive_hz


def _rings(line_hz: float, order: int, segment: Segment, bundle: Bundle) -> bool:
    """Whether a line may be the system's own ring."""
    drive_hz = _drive_hz(bundle)
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
    if not (line_hz or order):
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


def _drive_hz(bundle: Bundle) -> float:
    """The drive's frequency, where any stretch has one."""
    known = [one.fundamental_hz for one in bundle.segments if one.fundamental_hz is not None]
    return known[0] if known else np.inf


def _every_line(t_s: Array) -> list[tuple[float, int, int]]:
    """(line in Hz, quadrature, order) of the cosine transform of samples evenly apart."""
    length_s = (t_s[-1] - t_s[0]) * len(t_s) / (len(t_s) - 1)
    return [(0.5 * k / length_s, 0, 0) for k in range(len(t_s))]


def _bands(count: int) -> list[int]:
    """Which band each of so many lines belongs to."""
    found, start = [0], 1
    while start < count:
        width = int(np.clip(BAND * start, *BAND_LINES))
        found += [found[-1] + 1] * min(width, count - start)
        start += width
    return found


def _vectors(t_s: Array, segment: Segment) -> tuple[Array, list[tuple[float, int, int]]]:
    """Vectors over the samples, shape (n, k), and their (line, quadrature, order)."""
    length = max(segment.end_s - segment.start_s, 1e-9)
    middle = 2.0 * (t_s - segment.start_s) / length - 1.0
    columns, lines = [], []
    if segment.fundamental_hz is not None:
        highest = segment.highest_hz or np.inf
        for harmonic in range(HARMONICS + 1):
            if harmonic * segment.fundamental_hz > highest:
                break
            orders = SLOW_ORDERS if harmonic < SLOW_HARMONICS else 0
            angle = 2.0 * np.pi * harmonic * segment.fundamental_hz * t_s
            for order in range(orders + 1):
                slow = np.polynomial.legendre.Legendre.basis(order)(middle)
                columns.append(slow * np.cos(angle))
                lines.append((float(harmonic), 0, order))
                if harmonic:
                    columns.append(slow * np.sin(angle))
                    lines.append((float(harmonic), 1, order))
        # Steady lines first, so that what changes slowly is only what they leave.
        order_of = sorted(range(len(lines)), key=lambda i: (lines[i][2], lines[i][0]))
        columns, lines = [columns[i] for i in order_of], [lines[i] for i in order_of]
    else:
        highest = min(segment.highest_hz or LINE_HZ, 0.5 * len(t_s) / length)
        columns.append(np.ones_like(t_s))
        lines.append((0.0, 0, 0))
        columns.append(middle)
        lines.append((0.0, 0, 1))
        for k in range(1, int(highest * length) + 1):
            angle = np.pi * k * (middle + 1.0)
            columns += [np.cos(angle), np.sin(angle)]
            lines += [(k / length, 0, 0), (k / length, 1, 0)]
    return np.stack(columns, axis=1), lines


def _rings_near(t_s: Array, segment: Segment, bundle: Bundle) -> Array:
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


def _orthonormal(vectors: Array, without: Array) -> tuple[Array, list[int]]:
    """An orthonormal set in the order of the vectors, and orthogonal to those without.

    Vectors within the span of others are left out.
    """
    if without.shape[1]:
        left, sizes, _ = np.linalg.svd(without, full_matrices=False)
        left = left[:, sizes > np.sqrt(CAPTURED) * sizes[0]]
        vectors = vectors - left @ (left.T @ vectors)
    scaled = vectors / np.maximum(np.linalg.norm(vectors, axis=0), 1e-300)
    q, r = np.linalg.qr(scaled)
    own = np.abs(np.diag(r)) > np.sqrt(CAPTURED)
    if own.all() and len(own) == vectors.shape[1]:
        # The sign of each is that of its vector.
        return q * np.sign(np.diag(r)), list(range(vectors.shape[1]))
    kept: list[int] = []
    basis = np.zeros((len(vectors), 0))
    for place in range(vectors.shape[1]):
        if basis.shape[1] >= len(vectors):
            break
        rest = scaled[:, place]
        for _ in range(2):
            rest = rest - basis @ (basis.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > np.sqrt(CAPTURED):
            basis = np.column_stack([basis, rest / size])
            kept.append(place)
    return basis, kept
