"""The camera looks for a while, and sees the mean."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

POINTS = 8
"""Of Gauss's rule: exact to rounding below 50 Hz."""


def measure(look: Any, exposure_s: Any) -> Any:
    """Mean of the pose over the exposure, by Gauss's rule."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)

    def seen(stamp_s: Any) -> Any:
        parts = zip(nodes, weights, strict=True)
        return sum(0.5 * weight * look(stamp_s + 0.5 * node * exposure_s) for node, weight in parts)

    return seen


EFFECT = Effect(
    name="camera_exposure",
    title="exposure of the camera",
    acts=Acts.CAMERA,
    equation="X_m(t) = mean of X over t -+ t_e/2",
    source="notes/left-out-physics.md, Section 2",
    signature="amplitude times sinc(f t_e): -3 % for a full frame at 2.06 Hz",
    parameters=(
        Parameter("exposure_s", "s", 0.02, 0.0, 0.0625, "t_e, beyond the rig file's", False, True),
    ),
    measure=measure,
    order=1,
)
