"""The camera's clock runs faster than the tensions'."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def measure(look: Any, drift_ppm: Any) -> Any:
    """X(t / (1 + d))."""

    def seen(stamp_s: Any) -> Any:
        return look(stamp_s / (1.0 + 1e-6 * drift_ppm))

    return seen


EFFECT = Effect(
    name="clock_drift",
    title="drift of the clocks",
    acts=Acts.CLOCK,
    equation="X_m(t) = X(t/(1 + d))",
    source="notes/left-out-physics.md, Section 2",
    signature="a latency that grows with time",
    parameters=(
        Parameter(
            "drift_ppm",
            "ppm",
            100.0,
            -5000.0,
            5000.0,
            "d, positive when the camera's is fast",
            False,
            True,
        ),
    ),
    measure=measure,
    order=6,
)
