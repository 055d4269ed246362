"""The cell's zero wanders, as with temperature."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

TINY = 1e-9
"""So little of the way to where it settles is gone at first: a drift is straight there."""


def measure(time_s: Any, tension_n: Any, drift_n_per_s: Any, settles_per_s: Any) -> Any:
    """T + b (1 - exp(-s t)) / s; T + b t where s is nothing."""
    settled = time_s[:, None] * settles_per_s
    some = np.maximum(settled, TINY)
    gone = np.where(settled > TINY, -np.expm1(-some) / some, 1.0)
    return tension_n + time_s[:, None] * gone * drift_n_per_s


EFFECT = Effect(
    name="cell_drift",
    title="drift of the cell",
    acts=Acts.CELL,
    equation="T_m = T + b (1 - exp(-s t))/s, T + b t for s = 0",
    source="amplifier manual of the force cells; design, section 6",
    signature="a slow drift of one channel's mean, its amplitude unchanged",
    parameters=(
        Parameter("drift_n_per_s", "N/s", 0.01, -1.0, 1.0, "b, at the start", magnitude=True),
        Parameter("settles_per_s", "1/s", 0.0, 0.0, 1.0, "s, as an amplifier warms up"),
    ),
    measure=measure,
    order=4,
)
