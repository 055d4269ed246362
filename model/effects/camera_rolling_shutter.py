"""The rows of a frame are read one after the other."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter

STEP_S = 5e-4
"""Half the base of the difference that gives the speed."""


def measure(look: Any, readout_s: Any, field_m: Any) -> Any:
    """A row above the centre is late: shear by X', read as half as much pitch."""

    def seen(stamp_s: Any) -> Any:
        pose = look(stamp_s)
        if readout_s == 0.0:
            return pose
        late_s = readout_s * pose[:, 2] / field_m
        pose = look(stamp_s + late_s)
        speed = (look(stamp_s + STEP_S) - look(stamp_s - STEP_S))[:, 0] / (2.0 * STEP_S)
        pose[:, 4] += 0.5 * speed * readout_s / field_m
        return pose

    return seen


EFFECT = Effect(
    name="camera_rolling_shutter",
    title="rolling shutter of the camera",
    acts=Acts.CAMERA,
    equation="X_m(t) = X(t + t_r z/h), pitch + X' t_r/(2 h)",
    source="notes/left-out-physics.md, Section 2; camera looks along Y, rows along Z",
    signature="pitch in proportion to the speed across the image, pose only",
    parameters=(
        Parameter("readout_s", "s", 0.01, 0.0, 0.0625, "t_r, first row to last", False, True),
        Parameter("field_m", "m", 0.3, 0.05, 5.0, "h, height of the field of view", False),
    ),
    measure=measure,
    order=2,
)
