"""Four-parameter sine fit (IEEE Std 1057-2017, clause 5.4), with standard uncertainties."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SineFit:
    """A sin(2 pi f t + phase) + offset, least squares.

    Attributes
    ----------
    amplitude, frequency_hz, phase_rad, offset
        The parameters; phase at t = 0.
    sigma_amplitude, sigma_frequency_hz, sigma_phase_rad
        Standard uncertainties. Residuals are taken as independent, so harmonics and ringing left
        in them widen these.
    residual
        Standard deviation of what the sine leaves.
    """

    amplitude: float
    frequency_hz: float
    phase_rad: float
    offset: float
    sigma_amplitude: float
    sigma_frequency_hz: float
    sigma_phase_rad: float
    residual: float


def fit_sine(t_s: Array, value: Array, near_hz: float) -> SineFit:
    """Fit a sine whose frequency is about known.

    Parameters
    ----------
    t_s, value
        Samples at any times, shape (n,) with n of at least 8.
    near_hz
        Where to start; right to within about half a period over the whole record.
    """
    # The fit is made about the middle of the record: there frequency and phase do not correlate.
    middle = float((t_s[0] + t_s[-1]) / 2.0)
    tau = t_s - middle
    start = _linear_fit(tau, value, near_hz)
    scale = float(value.std()) or 1.0

    def model(x: Array, f: float, a: float, b: float, c: float) -> Array:
        angle = 2.0 * np.pi * f * x
        return a * np.cos(angle) + b * np.sin(angle) + c

    found, covariance = curve_fit(model, tau, value / scale, p0=(near_hz, *(start / scale)))
    frequency, a, b, c = (float(x) for x in found)
    amplitude = float(np.hypot(a, b))
    # First-order propagation from (f, a, b) to amplitude and phase.
    along = np.array([0.0, a, b, 0.0]) / (amplitude or 1.0)
    across = np.array([0.0, b, -a, 0.0]) / (amplitude**2 or 1.0)
    across[0] = -2.0 * np.pi * middle  # the frequency's share, carried from the middle to t = 0
    phase = np.arctan2(a, b) - 2.0 * np.pi * frequency * middle
    residual = value - scale * model(tau, *found)
    return SineFit(
        amplitude=amplitude * scale,
        frequency_hz=frequency,
        phase_rad=float(np.angle(np.exp(1j * phase))),
        offset=c * scale,
        sigma_amplitude=float(np.sqrt(along @ covariance @ along)) * scale,
        sigma_frequency_hz=float(np.sqrt(covariance[0, 0])),
        sigma_phase_rad=float(np.sqrt(across @ covariance @ across)),
        residual=float(residual.std(ddof=min(4, len(residual) - 1))),
    )


def phase_at(t_s: Array, value: Array, frequency_hz: float) -> tuple[float, float]:
    """Phase at t = 0 of a sine of known frequency, and its standard uncertainty, in rad."""
    a, b, c = _linear_fit(t_s, value, frequency_hz)
    angle = 2.0 * np.pi * frequency_hz * t_s
    residual = value - (a * np.cos(angle) + b * np.sin(angle) + c)
    amplitude = float(np.hypot(a, b))
    sigma = float(residual.std() * np.sqrt(2.0 / len(value)) / amplitude) if amplitude else np.inf
    return float(np.arctan2(a, b)), sigma


def _linear_fit(t_s: Array, value: Array, frequency_hz: float) -> Array:
    """Cosine part, sine part and offset at a known frequency."""
    angle = 2.0 * np.pi * frequency_hz * t_s
    design = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(t_s)])
    return np.asarray(np.linalg.lstsq(design, value, rcond=None)[0])
