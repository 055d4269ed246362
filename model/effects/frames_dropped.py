"""Frames went missing without a gap in their stamps."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

PLACES = 5
"""Where one frame more may be lost."""


def measure(look: Any, frames: Any, at_s: Any, frame_hz: Any, **again_s: Any) -> Any:
    """From t_d on, X(t + n / f), and from each further t_k on another 1 / f later."""
    further = [at for at in again_s.values() if at > 0.0]

    def seen(stamp_s: Any) -> Any:
        lost = np.where(stamp_s < at_s, 0.0, round(frames))
        for at in further:
            lost = lost + (stamp_s >= at)
        return look(stamp_s + lost / frame_hz)

    return seen


EFFECT = Effect(
    name="frames_dropped",
    title="dropped frames",
    acts=Acts.CLOCK,
    equation="X_m(t) = X(t + n/f) for t >= t_d, and 1/f later still from each t_k on",
    source="notes/left-out-physics.md, Section 2",
    signature="from one moment on, all cables and the pose disagree by whole frames",
    parameters=(
        Parameter("frames", "1", 1.0, 0.0, 50.0, "n, rounded", False, True),
        Parameter("at_s", "s", 3.0, 0.0, 1e4, "t_d", False),
        Parameter("frame_hz", "Hz", 16.0, 1.0, 1000.0, "f, frame rate", False),
        *(
            Parameter(f"again_{k}_s", "s", 0.0, 0.0, 1e4, "t_k, one frame more; 0: none", False)
            for k in range(1, PLACES + 1)
        ),
    ),
    measure=measure,
    order=7,
)
