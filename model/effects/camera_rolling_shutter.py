"""The rows of a frame are read one after the other."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter

STEP_S = 5e-4
"""Half the base of the difference that gives the speed."""


def measure(look: Any, readout_s: Any, field_m: Any, plate_y_m: Any, plate_half_m: Any) -> Any:
    """Rows above the centre are late: a moving plate is sheared, and read as a turned one.

    Of the shear across the image, a rigid plate takes half as pitch; of that along the line of
    sight, all as roll. The plate stands beside the centre of mass, and moves with its turning.
    """

    def seen(stamp_s: Any) -> Any:
        pose = look(stamp_s)
        if readout_s == 0.0:
            return pose
        late = readout_s / field_m
        when_s = stamp_s + late * pose[:, 2]
        pose = look(when_s)
        rate = (look(when_s + STEP_S) - look(when_s - STEP_S)) / (2.0 * STEP_S)
        across = rate[:, 0] - rate[:, 5] * plate_y_m
        along = rate[:, 1]
        high = late * plate_half_m**2
        pose[:, 0] += high * rate[:, 4]
        pose[:, 1] -= high * rate[:, 3]
        pose[:, 2] += late * along * plate_y_m
        pose[:, 3] -= late * along
        pose[:, 4] += 0.5 * late * across
        return pose

    return seen


EFFECT = Effect(
    name="camera_rolling_shutter",
    title="rolling shutter of the camera",
    acts=Acts.CAMERA,
    equation="X_m(t) = X(t + s z), pitch + s V_x/2, roll - s V_y, s = t_r/h, V: of the plate",
    source="notes/left-out-physics.md, Section 2; camera looks along Y, rows along Z; a rigid "
    "plate fitted to a sheared one, to first order (Ait-Aider et al. 2006)",
    signature="pitch and roll in proportion to the speed of the plate, pose only",
    parameters=(
        Parameter("readout_s", "s", 0.01, 0.0, 0.0625, "t_r, first row to last", False, True),
        Parameter("field_m", "m", 0.3, 0.05, 5.0, "h, height of the field of view", False),
        Parameter("plate_y_m", "m", 0.1, -2.0, 2.0, "the plate from the centre of mass", False),
        Parameter("plate_half_m", "m", 0.03, 0.0, 1.0, "half the height of its corners", False),
    ),
    measure=measure,
    order=2,
)
