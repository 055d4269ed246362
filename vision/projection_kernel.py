"""Where on a print a pixel looks, and how prints are seen by the camera; compiled by numba."""

import numpy as np
from numpy.typing import NDArray

from vision.compiled import compiled

Array = NDArray[np.float64]


@compiled
def inverse(m: Array) -> Array:
    """Inverse of a matrix, (3, 3)."""
    out = np.empty((3, 3))
    out[0, 0] = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    out[0, 1] = m[0, 2] * m[2, 1] - m[0, 1] * m[2, 2]
    out[0, 2] = m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]
    out[1, 0] = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    out[1, 1] = m[0, 0] * m[2, 2] - m[0, 2] * m[2, 0]
    out[1, 2] = m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]
    out[2, 0] = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    out[2, 1] = m[0, 1] * m[2, 0] - m[0, 0] * m[2, 1]
    out[2, 2] = m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
    determinant = m[0, 0] * out[0, 0] + m[0, 1] * out[1, 0] + m[0, 2] * out[2, 0]
    for i in range(3):
        for j in range(3):
            out[i, j] /= determinant
    return out


@compiled
def placed(frame: Array, rotation: Array, translation: Array) -> Array:
    """Prints in the camera frame: `MarkerPrint.frame` rotated and moved."""
    out = np.empty_like(frame)
    for m in range(len(frame)):
        for i in range(3):
            for j in range(3):
                total = 0.0
                for k in range(3):
                    total += rotation[i, k] * frame[m, k, j]
                out[m, i, j] = total
            out[m, i, 2] += translation[i]
    return out


@compiled
def cubic(c: Array, x: float, y: float) -> float:
    """A cubic of two variables with its ten coefficients, as `vision.local_lens` orders them."""
    value: float = (
        c[0]
        + x * (c[1] + x * (c[3] + x * c[6]) + y * (c[4] + x * c[7] + y * c[8]))
        + y * (c[2] + y * (c[5] + y * c[9]))
    )
    return value


@compiled
def through_lens(lens: Array, x: float, y: float, slope: Array) -> tuple[float, float]:
    """Ideal pixel at an offset from the middle of a cubic; its derivatives go to `slope`."""
    for axis in range(2):
        c = lens[axis]
        slope[axis, 0] = c[1] + x * (2 * c[3] + 3 * c[6] * x) + y * (c[4] + 2 * c[7] * x + c[8] * y)
        slope[axis, 1] = c[2] + y * (2 * c[5] + 3 * c[9] * y) + x * (c[4] + 2 * c[8] * y + c[7] * x)
    return cubic(lens[0], x, y), cubic(lens[1], x, y)
