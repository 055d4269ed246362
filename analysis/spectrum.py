"""Amplitude spectra at uneven sample times, and the lines that stand above the noise."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analysis.sine_fit import fit_sine

Array = NDArray[np.float64]

LOWEST_HZ = 0.3
HIGHEST_HZ = 40.0
"""Beyond the platform's own tones; the cells' noise is all that is left there."""

OVERSAMPLING = 4
"""Grid points per resolution cell 1/T; a line then loses at most 3 % between them."""

MOST_LINES = 6

SIGNIFICANT = 4.5
"""A line counts above this multiple of the noise level: once in some 10 000 grid points."""


@dataclass(frozen=True)
class Line:
    """One line of a spectrum: a sine, with its frequency and amplitude."""

    frequency_hz: float
    amplitude: float


@dataclass(frozen=True)
class SampleTimes:
    """Sample times and the frequencies that they resolve, up to half their mean rate.

    Parameters
    ----------
    t_s
        Shape (n,), in order; need not be even.
    """

    t_s: Array

    @property
    def length_s(self) -> float:
        """From the first sample to the last."""
        return float(self.t_s[-1] - self.t_s[0])

    @cached_property
    def frequency_hz(self) -> Array:
        """Frequencies of the spectrum, shape (m,)."""
        top = min(HIGHEST_HZ, 0.5 * (len(self.t_s) - 1) / self.length_s)
        return np.arange(LOWEST_HZ, top, 1.0 / (OVERSAMPLING * self.length_s))

    @cached_property
    def _window(self) -> Array:
        """Hann's: without it the drive's line leaks over everything that friction adds."""
        turn = 2.0 * np.pi * (self.t_s - self.t_s[0]) / self.length_s
        return np.asarray(0.5 - 0.5 * np.cos(turn))

    @cached_property
    def _waves(self) -> NDArray[np.complex128]:
        phase = np.outer(self.frequency_hz, self.t_s - self.t_s[0])
        waves: NDArray[np.complex128] = np.exp(-2j * np.pi * phase)
        waves *= 2.0 * self._window / self._window.sum()
        return waves

    def amplitude(self, value: Array) -> Array:
        """Amplitude spectrum of a series taken at these times.

        Parameters
        ----------
        value
            Shape (n,).

        Returns
        -------
        Array
            At `frequency_hz`, shape (m,): the amplitude a sine of that frequency would have.
        """
        parts: NDArray[np.complex128] = self._waves @ (value - value.mean())
        return np.asarray(np.abs(parts))

    def noise_level(self, noise: float) -> float:
        """Expected amplitude of white noise of standard deviation `noise` at one frequency."""
        spread = np.sqrt(np.sum(self._window**2)) / self._window.sum()
        return noise * float(np.sqrt(np.pi) * spread)

    def lines(self, value: Array, noise: float) -> tuple[Line, ...]:
        """The lines above the noise, strongest first, each taken out before the next is sought.

        Parameters
        ----------
        value
            Shape (n,).
        noise
            Standard deviation of one sample.
        """
        found: list[Line] = []
        centred = value - value.mean()
        rest = centred
        design = np.ones((len(value), 1))
        for _ in range(MOST_LINES):
            heights = self.amplitude(rest)
            best = int(np.argmax(heights))
            if heights[best] < SIGNIFICANT * self.noise_level(noise):
                break
            frequency = fit_sine(self.t_s, rest, float(self.frequency_hz[best])).frequency_hz
            angle = 2.0 * np.pi * frequency * self.t_s
            design = np.column_stack([design, np.cos(angle), np.sin(angle)])
            weights = np.linalg.lstsq(design, centred, rcond=None)[0]
            rest = centred - design @ weights
            found.append(Line(frequency, float(np.hypot(*weights[-2:]))))
        return tuple(sorted(found, key=lambda line: -line.amplitude))
