"""Smooth switches that need neither branches nor the C library: compiled into every kernel."""

from typing import Any

import numpy as np

TINY = 1e-300
"""Keeps 0 / 0 at 0."""


def smooth_sign(value: Any, width: Any) -> Any:
    """sgn(value), rounded: value / sqrt(value^2 + width^2); 0.7 at one width, 0.995 at ten."""
    return value / np.sqrt(value * value + width * width + TINY)


def smooth_size(value: Any, width: Any) -> Any:
    """|value|, rounded: value^2 / sqrt(value^2 + width^2); exactly 0 at 0."""
    return value * smooth_sign(value, width)


def smooth_positive(value: Any, width: Any) -> Any:
    """max(value, 0), rounded: (value + sqrt(value^2 + width^2)) / 2."""
    return 0.5 * (value + np.sqrt(value * value + width * width))


def gaussian(value: Any) -> Any:
    """exp(-value^2), by its series in an eighth part: within 1e-4."""
    square = value * value
    part = square / (8.0 + 1e-5 * square)
    eighth = 1.0 + part * (1.0 + part / 2.0 * (1.0 + part / 3.0 * (1.0 + part / 4.0)))
    fourth = eighth * eighth * eighth * eighth
    return 1.0 / (fourth * fourth)
