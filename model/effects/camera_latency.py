"""The camera stamps its frames late."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def measure(look: Any, latency_s: Any) -> Any:
    """X(t - tau)."""

    def seen(stamp_s: Any) -> Any:
        return look(stamp_s - latency_s)

    return seen


EFFECT = Effect(
    name="camera_latency",
    title="latency of the camera",
    acts=Acts.CAMERA,
    equation="X_m(t) = X(t - tau)",
    source="notes/left-out-physics.md, Section 2, Section 0",
    signature="like cable damping k tau in every cable, but nothing is dissipated",
    parameters=(
        Parameter(
            "latency_s", "s", 0.01, -0.1, 0.2, "tau, positive when stamps are late", False, True
        ),
    ),
    measure=measure,
    order=5,
)
