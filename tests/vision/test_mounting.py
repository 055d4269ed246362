"""From camera to platform and back, exactly; and what the covariance becomes on the way."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cdpr8.errors import DataError
from cdpr8.rigfile import load_rig, packaged_rig_path
from cdpr8.rigfile.parameter import Point
from cdpr8.rigfile.schema import CameraPose as StatedPose
from cdpr8.rigfile.schema import PlatePose
from rig.simulated.render import PlateRenderer
from vision.mounting import mounting_of
from vision.pose import CameraPose

RIG = load_rig(packaged_rig_path())
MASS_OFFSET = (0.01, -0.004, 0.006)


def slanted_rig():
    """Everything off the axes, and the centre of mass off the platform's origin."""
    plate = RIG.plate.model_copy(
        update={
            "pose": PlatePose(position_m=(0.02, 0.11, -0.03), normal=(0.3, 1, 0.2), up=(0.1, 0, 1))
        }
    )
    camera = RIG.camera.model_copy(
        update={"pose": StatedPose(position_m=(0.6, 1.1, 0.4), look_at_m=(0.0, 0.1, 0.0))}
    )
    platform = RIG.platform.model_copy(
        update={"centre_of_mass_m": Point(value=MASS_OFFSET, sigma=0.0, unit="m")}
    )
    return RIG.model_copy(update={"plate": plate, "camera": camera, "platform": platform})


def seen_by_the_renderer(rig, pose):
    """The plate in the camera frame by the renderer's own geometry, which `vision` does not use."""
    offset = rig.platform.centre_of_mass_m.value
    view = PlateRenderer(rig.camera, rig.plate, centre_of_mass_m=offset)._view(pose).to_image
    x, y, origin = view.T
    return CameraPose(np.column_stack([x, y, np.cross(x, y)]), origin, np.eye(6), 0.0)


angle = st.floats(-0.6, 0.6)
place = st.floats(-0.2, 0.2)


@settings(deadline=None, max_examples=40)
@given(st.tuples(place, place, place, angle, angle, angle))
def test_the_platform_is_found_where_the_renderer_put_it(pose):
    rig = slanted_rig()
    found = mounting_of(rig).platform(seen_by_the_renderer(rig, np.array(pose)))
    assert found.values == pytest.approx(pose, abs=1e-12)


def test_the_covariance_is_that_of_small_changes():
    import cv2

    rig, generator = slanted_rig(), np.random.default_rng(3)
    mounting, seen = (
        mounting_of(rig),
        seen_by_the_renderer(rig, np.array([0.1, 0, 0, 0.2, 0.3, 0.4])),
    )
    half = generator.normal(size=(6, 6))
    covariance = half @ half.T
    step = 1e-6
    columns = []
    for axis in range(6):
        moved = []
        for sign in (step, -step):
            change = sign * np.eye(6)[axis]
            turn = cv2.Rodrigues(change[:3])[0]
            pose = CameraPose(turn @ seen.rotation, seen.translation + change[3:], covariance, 0.0)
            moved.append(mounting.platform(pose).values)
        columns.append((moved[0] - moved[1]) / (2 * step))
    jacobian = np.column_stack(columns)
    seen = CameraPose(seen.rotation, seen.translation, covariance, 0.0)
    assert mounting.platform(seen).covariance == pytest.approx(
        jacobian @ covariance @ jacobian.T, rel=1e-5, abs=1e-6
    )


def test_frames_at_rest_tell_where_the_camera_stands():
    rig = slanted_rig()
    rest = seen_by_the_renderer(rig, np.zeros(6))
    unknown = rig.model_copy(update={"camera": rig.camera.model_copy(update={"pose": None})})
    mounting = mounting_of(unknown).with_camera_seeing_rest([rest, rest])
    assert mounting.camera_position == pytest.approx(rig.camera.pose.position_m)
    pose = (0.01, 0.02, 0.03, 0.1, 0.2, 0.3)
    found = mounting.platform(seen_by_the_renderer(rig, np.array(pose)))
    assert found.values == pytest.approx(pose, abs=1e-9)


def test_directions_that_make_no_frame_are_refused():
    pose = PlatePose(position_m=(0, 0.1, 0), normal=(0, 0, 1), up=(0, 0, 2))
    plate = RIG.plate.model_copy(update={"pose": pose})
    with pytest.raises(DataError, match="parallel"):
        mounting_of(RIG.model_copy(update={"plate": plate}))
