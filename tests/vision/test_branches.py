"""Two poses of a plane over a sequence: a wrong branch is left again, and doubt is flagged."""

import numpy as np
import pytest
from cases import cropped, in_front
from takes import film, seen_from, still, with_markers

from cdpr8.runfolder.tables import FrameFlag
from vision.branches import BranchScore, choose_branches
from vision.camera_model import CameraModel
from vision.mounting import mounting_of
from vision.plate import Plate
from vision.pose import CameraPose, PoseEstimate
from vision.tracker import Tracker


def turned(angle_rad):
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    rotation = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
    return CameraPose(rotation, np.array([0.0, 0.0, 1.0]), np.eye(6), 0.01)


def doubtful(better_rad, worse_rad, lead):
    return PoseEstimate(turned(better_rad), 1.1, lead < 16.0, False, turned(worse_rad), lead)


@pytest.fixture
def misled():
    """True branch +0.2 rad; three frames of twenty slightly prefer its mirror image."""
    return [doubtful(-0.2, 0.2, 3.0) if k < 3 else doubtful(0.2, -0.2, 4.0) for k in range(20)]


def test_a_wrong_start_is_left_again_while_tracking(misled):
    score = BranchScore()
    seen = [score.take(one, 1) for one in misled]
    assert seen[0].pose.rotation[2, 1] < 0  # nothing else was known
    assert seen[-1].pose.rotation[2, 1] > 0
    assert seen[0].ambiguous
    assert not seen[-1].ambiguous


def test_with_all_frames_known_the_wrong_start_is_put_right(misled):
    chosen = choose_branches(range(20), misled)
    assert all(one.pose.rotation[2, 1] > 0 for one in chosen)
    assert [one.from_previous for one in chosen] == [True] * 3 + [False] * 17
    assert not any(one.ambiguous for one in chosen)


def test_what_no_frame_tells_stays_ambiguous():
    chosen = choose_branches(range(5), [doubtful(0.01, -0.01, 0.2)] * 5)
    assert all(one.ambiguous for one in chosen)


def test_a_plate_that_does_turn_is_followed():
    frames = [doubtful(0.2, -0.2, 60.0)] * 5 + [doubtful(-0.2, 0.2, 60.0)] * 5
    chosen = choose_branches(range(10), frames)
    assert [one.pose.rotation[2, 1] > 0 for one in chosen] == [True] * 5 + [False] * 5


@pytest.mark.parametrize("size_m", [pytest.param(0.012, marks=pytest.mark.slow), 0.02])
def test_face_on_no_flip_goes_unnoticed(packaged, size_m):
    rig = cropped(in_front(with_markers(packaged, size_m=size_m), 0.0))
    take = film(rig, 40)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    tracker, mounting = Tracker(camera, Plate.from_rig(rig.plate)), mounting_of(rig)
    for image, truth in zip(take.images, take.truth, strict=True):
        sighting = tracker.see(image).sightings[0]
        if sighting.estimate is None:
            continue
        error = mounting.platform(sighting.estimate.pose).values - truth
        if np.rad2deg(np.abs(error[3:]).max()) > 3.0:
            assert sighting.flags & (FrameFlag.AMBIGUOUS | FrameFlag.FEW_MARKERS)


def test_one_face_on_marker_at_rest_keeps_its_branch(packaged):
    rig = cropped(with_markers(seen_from(packaged, 2.0), size_m=0.02, across=1))
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    tracker = Tracker(camera, Plate.from_rig(rig.plate))
    seen = [tracker.see(image).sightings[0] for image in film(rig, 24, motion=still).images]
    turns = np.array([one.estimate.pose.rotation[2] for one in seen if one.estimate])
    assert np.ptp(turns, axis=0).max() < 0.15
