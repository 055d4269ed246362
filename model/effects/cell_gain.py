"""The cell reads too much or too little."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, gain_share: Any) -> Any:
    """(1 + e) T."""
    del time_s
    return tension_n * (1.0 + gain_share)


EFFECT = Effect(
    name="cell_gain",
    title="gain of the cell",
    acts=Acts.CELL,
    equation="T_m = (1 + e) T",
    source="amplifier manual of the force cells; design, section 6",
    signature="one channel, in proportion to T, the mean included",
    parameters=(Parameter("gain_share", "1", 0.02, -0.3, 0.3, "e", magnitude=True),),
    measure=measure,
    order=2,
)
