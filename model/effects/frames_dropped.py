"""Frames went missing without a gap in their stamps."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def measure(look: Any, frames: Any, at_s: Any, frame_hz: Any) -> Any:
    """From t_d on, X(t + n / f)."""
    lost_s = round(frames) / frame_hz

    def seen(stamp_s: Any) -> Any:
        return look(np.where(stamp_s < at_s, stamp_s, stamp_s + lost_s))

    return seen


EFFECT = Effect(
    name="frames_dropped",
    title="dropped frames",
    acts=Acts.CLOCK,
    equation="X_m(t) = X(t + n/f) for t >= t_d",
    source="notes/left-out-physics.md, Section 2",
    signature="from one moment on, all cables and the pose disagree by whole frames",
    parameters=(
        Parameter("frames", "1", 1.0, 0.0, 50.0, "n, rounded", False, True),
        Parameter("at_s", "s", 3.0, 0.0, 1e4, "t_d", False),
        Parameter("frame_hz", "Hz", 16.0, 1.0, 1000.0, "f, frame rate", False),
    ),
    measure=measure,
    order=7,
)
