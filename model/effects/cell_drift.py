"""The cell's zero wanders, as with temperature."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, drift_n_per_s: Any) -> Any:
    """T + b t."""
    return tension_n + time_s[:, None] * drift_n_per_s


EFFECT = Effect(
    name="cell_drift",
    title="drift of the cell",
    acts=Acts.CELL,
    equation="T_m = T + b t",
    source="amplifier manual of the force cells; design, section 6",
    signature="a straight drift of one channel's mean, its amplitude unchanged",
    parameters=(Parameter("drift_n_per_s", "N/s", 0.01, -1.0, 1.0, "b", magnitude=True),),
    measure=measure,
    order=4,
)
