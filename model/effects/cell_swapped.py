"""Cells are plugged into each other's channels."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, swapped: Any) -> Any:
    """The chosen channels, each with the tension of the next of them."""
    del time_s
    chosen = np.flatnonzero(swapped)
    mixed = tension_n.copy()
    mixed[:, chosen] = tension_n[:, np.roll(chosen, -1)]
    return mixed


EFFECT = Effect(
    name="cell_swapped",
    title="swapped cells",
    acts=Acts.CELL,
    equation="T_m,i = T_j and so on round the chosen cables",
    source="design, section 6",
    signature="two channels that fit each other's cables",
    parameters=(Parameter("swapped", "1", 1.0, 0.0, 1.0, "not 0: takes part", magnitude=True),),
    measure=measure,
    order=6,
)
