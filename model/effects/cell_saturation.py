"""The cell or its amplifier sees no more than a limit."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, limit_n: Any) -> Any:
    """min(T, T_max); a limit of 0 is none."""
    del time_s
    limits = np.where(limit_n > 0.0, limit_n, np.inf)
    return np.minimum(tension_n, limits)


EFFECT = Effect(
    name="cell_saturation",
    title="saturation of the cell",
    acts=Acts.CELL,
    equation="T_m = min(T, T_max)",
    source="amplifier manual of the force cells; design, section 6",
    signature="a flat top of one channel, even harmonics",
    parameters=(Parameter("limit_n", "N", 20.0, 0.0, 500.0, "T_max; 0: no limit", magnitude=True),),
    measure=measure,
    order=5,
)
