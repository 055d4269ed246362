"""The lens: samples seen as a few hundred numbers that hold what physics can be told by.

Over a periodic stretch every channel is resolved into harmonics of the drive, and the slow change
of the first ones; over another stretch into lines of a Fourier series, or, where every sample is
to be looked at, into all its lines by a cosine transform. Each is an orthonormal set of vectors
over the samples, so white noise stays white and one harmonic of a minute's motion is one number: a
law that misses it by a hair does not count as thousands of samples missed. Where every line is
looked at, that is why it is lines and not samples: what is wrong with a law has the colour of what
the law does, and of sixty thousand samples of a slow signal a few hundred lines tell anything.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.labels import Labels
from analysis.engine.system import Prediction
from analysis.engine.tones import drive_frequency_hz, leaked, rings, rings_near
from analysis.engine.whiten import covariance_over, whiles
from cdpr8.errors import DataError

HARMONICS = 10
"""The drive's harmonics that are looked at."""

SLOW_HARMONICS = 2
"""Harmonics whose slow change is looked at, from the mean on."""

SLOW_ORDERS = 3
"""Degrees of the polynomials that follow the change."""

LINE_HZ = 20.0
"""Of a stretch that does not repeat, lines up to here."""

BAND = 0.05
"""Where every line is looked at, so wide are the bands of lines that belong together, as a share
of their frequency: a law that is off is off on all of them alike."""

BAND_LINES = (8, 64)
"""And neither narrower nor wider, in lines."""

CAPTURED = 1e-6
"""A vector that is this much the others' is none of its own."""


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
        late: list[Array] = []
        group, stretch = 0, -1
        for b, bundle in enumerate(self.bundles):
            for s, segment in enumerate(bundle.segments):
                inside = np.flatnonzero(segment.holds(bundle.t_s))
                if inside.size < 3:
                    continue
                whiten = np.linalg.inv(np.linalg.cholesky(covariance_over(bundle, inside)))
                every = segment.fundamental_hz is None and segment.highest_hz is None
                basis: Array | None = None
                if every:
                    lines = _every_line(bundle.t_s[inside])
                    kept, bands = list(range(inside.size)), _bands(inside.size)
                else:
                    vectors, lines = _vectors(bundle.t_s[inside], segment)
                    without = rings_near(bundle.t_s[inside], segment, bundle)
                    basis, kept = _orthonormal(vectors, without)
                self._parts.append(_Part(b, inside, basis, whiten))
                if basis is None or segment.fundamental_hz is None:
                    rung.append(np.zeros(len(kept) * len(bundle.names)))
                else:
                    seen = bundle.value[inside] @ whiten.T
                    steady = np.array([lines[place][2] == 0 for place in kept])
                    rung.append(leaked(bundle.t_s[inside], seen, basis, steady, bundle.tones_hz))
                late.append(_late(bundle, inside, basis, whiten))
                hertz = segment.fundamental_hz or 1.0
                unit = 1.0 if segment.fundamental_hz is not None else drive_frequency_hz(bundle)
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
                                rings(line * hertz, order, segment, bundle),
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
        self.late: Array = np.concatenate(late) if late else np.zeros(0)
        """What instants that are off alike for a while give each, as variance, shape (f,)."""
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
        for place, (bundle, seen) in enumerate(zip(self.bundles, prediction, strict=True)):
            if np.shape(seen) != bundle.value.shape:
                raise DataError(
                    f"a simulation of bundle {place} has shape {np.shape(seen)}",
                    allowed=f"{bundle.value.shape}, as its `value` has", where="simulate",
                    remedy="one row for each sample time, whatever the point: NaN where there is "
                    "nothing",
                )  # fmt: skip
        found = []
        for part in self._parts:
            samples = prediction[part.bundle][part.rows]
            found.append(_resolved(samples, part.basis, part.whiten))
        return np.concatenate(found) if found else np.zeros(0)

    def of_data(self) -> Array:
        """Features of what was recorded."""
        return self([bundle.value for bundle in self.bundles])


def _resolved(samples: Array, basis: Array | None, whiten: Array) -> Array:
    """Features of the samples of a stretch, one channel after the other."""
    seen = dct(samples, type=2, norm="ortho", axis=0) if basis is None else basis.T @ samples
    return np.asarray((seen @ whiten.T).T.reshape(-1))


def _late(bundle: Bundle, inside: NDArray[np.int64], basis: Array | None, whiten: Array) -> Array:
    """Variance of the features of a stretch where all instants are off alike for a while."""
    size = inside.size if basis is None else basis.shape[1]
    variance = np.zeros(size * len(bundle.names))
    if bundle.late is None:
        return variance
    none = np.zeros((inside.size, len(bundle.names)))
    first, _ = whiles(bundle.t_s[inside])
    for begin, end in pairwise([*first, inside.size]):
        there = none.copy()
        there[begin:end] = bundle.late[inside[begin:end]]
        variance += _resolved(there, basis, whiten) ** 2
    return variance


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
