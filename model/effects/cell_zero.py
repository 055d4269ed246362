"""The cell's zero is off."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, zero_n: Any) -> Any:
    """T + d."""
    del time_s
    return tension_n + zero_n


EFFECT = Effect(
    name="cell_zero",
    title="zero of the cell",
    acts=Acts.CELL,
    equation="T_m = T + d",
    source="amplifier manual of the force cells; design, section 6",
    signature="a constant offset of one channel, nothing else",
    parameters=(Parameter("zero_n", "N", 0.2, -10.0, 10.0, "d", magnitude=True),),
    measure=measure,
    order=3,
)
