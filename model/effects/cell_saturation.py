"""The cell or its amplifier sees no more than a limit."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

SHARP_N = 1e-9
"""Less than this is a sharp corner."""


def measure(time_s: Any, tension_n: Any, limit_n: Any, knee_n: Any) -> Any:
    """min(T, T_max), the corner rounded over w; a limit of 0 is none."""
    del time_s
    limits = np.where(limit_n > 0.0, limit_n, np.inf)
    knee = np.maximum(knee_n, SHARP_N)
    below = np.abs(tension_n - limits) / knee
    return np.minimum(tension_n, limits) - np.where(
        knee_n > 0.0, knee * np.log1p(np.exp(-below)), 0.0
    )


EFFECT = Effect(
    name="cell_saturation",
    title="saturation of the cell",
    acts=Acts.CELL,
    equation="T_m = min(T, T_max) - w ln(1 + exp(-|T - T_max|/w))",
    source="amplifier manual of the force cells; design, section 6",
    signature="a flat top of one channel, even harmonics",
    parameters=(
        Parameter("limit_n", "N", 20.0, 0.0, 500.0, "T_max; 0: no limit", magnitude=True),
        Parameter("knee_n", "N", 0.0, 0.0, 50.0, "w, over which it bends; 0: a sharp corner"),
    ),
    measure=measure,
    order=5,
)
