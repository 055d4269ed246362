"""The camera's scale is off."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def measure(look: Any, gain_share: Any) -> Any:
    """(1 + e) X."""

    def seen(stamp_s: Any) -> Any:
        return look(stamp_s) * (1.0 + gain_share)

    return seen


EFFECT = Effect(
    name="camera_gain",
    title="gain of the camera",
    acts=Acts.CAMERA,
    equation="X_m = (1 + e) X",
    source="notes/left-out-physics.md, Section 2",
    signature="one factor on pose; k Delta L off by it in all cables, the wrench balance clean",
    parameters=(Parameter("gain_share", "1", 0.02, -0.3, 0.3, "e", False, True),),
    measure=measure,
    order=4,
)
