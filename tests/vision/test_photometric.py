"""Poses fitted to pixels: at the noise limit, with a covariance that is true, for every case."""

import numpy as np
import pytest
from cases import CASES, cropped, measure
from takes import film, seen_from, still, with_markers

from cdpr8.runfolder.tables import FrameFlag
from rig.simulated.render import Appearance
from vision.camera_model import CameraModel
from vision.marker_print import PADDING, print_of
from vision.photometric import align_print
from vision.plate import Plate
from vision.refine import Refinement
from vision.tracker import Tracker

QUICK_FRAMES = 24
LUCK = 1.4
"""What the rms error of 24 frames may be over its expectation: 3 sigma is 1.43."""


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_pitch_is_at_the_noise_limit(case, packaged):
    result = measure(case, packaged, QUICK_FRAMES, seed=5)
    assert len(result.errors) == result.frames
    assert result.pitch_rms_deg < case.bar_deg
    assert result.flips == 0
    if not case.zeroed:
        assert result.pitch_rms_deg < LUCK * result.sigma_deg
        assert 0.7 < result.normalised_square < 1.4


def test_blur_noise_and_gamma_are_found_beside_the_pose(packaged):
    rig = cropped(with_markers(seen_from(packaged, 30.0), size_m=0.02))
    look = Appearance(blur_px=1.1, noise=3.0, shading=0.1)
    take = film(rig, 1, motion=still, appearance=look)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    plate = Plate.from_rig(rig.plate)
    pose = Tracker(camera, plate, Refinement.CORNERS).see(take.images[0]).sightings[0].estimate.pose
    found = align_print(take.images[0], print_of(plate), pose.rotation, pose.translation, camera)
    assert found.blur_px == pytest.approx(1.1, abs=0.02)
    assert found.noise == pytest.approx(3.0, abs=0.15)
    assert found.light[1] == pytest.approx(255 * look.black, abs=1.0)
    assert found.light[4] == pytest.approx(255 * (look.white - look.black), abs=3.0)
    assert found.light[5] > 2.0  # brighter to the right
    assert found.misfit < 3.0


def test_where_the_print_is_not_as_stated_sigmas_grow(packaged):
    rig = cropped(with_markers(seen_from(packaged, 30.0), size_m=0.02))
    take = film(rig, 1, motion=still)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    plate = Plate.from_rig(rig.plate)
    shift = np.zeros((4, 1, 3))
    shift[0, 0, 0] = 1e-4
    moved = Plate(plate.dictionary, plate.ids, plate.corners + shift)
    right = Tracker(camera, plate).see(take.images[0]).sightings[0].estimate
    wrong = Tracker(camera, moved).see(take.images[0]).sightings[0].estimate
    assert right.misfit < 4.0 < wrong.misfit
    grown = np.diag(wrong.pose.covariance) / np.diag(right.pose.covariance)
    assert (grown > 4.0).all()


def test_a_finger_over_a_marker_costs_that_marker_and_little_else(packaged):
    rig = cropped(with_markers(seen_from(packaged, 30.0), size_m=0.02))
    take = film(rig, 3, motion=still)
    images = [image.copy() for image in take.images]
    images[1][60:98, 60:100] = 120
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    tracker = Tracker(camera, Plate.from_rig(rig.plate))
    seen = [tracker.see(image).sightings[0] for image in images]
    assert [one.markers for one in seen] == [4, 3, 4]
    turn = seen[1].estimate.pose.rotation @ seen[0].estimate.pose.rotation.T
    assert np.abs(turn - np.eye(3)).max() < 2e-3


def test_the_print_is_the_dictionarys():
    plate = Plate.single("DICT_4X4_50", 0, 0.06)
    printed = print_of(plate)
    assert printed.modules == 6
    inside = printed.paper[0, PADDING:-PADDING, PADDING:-PADDING]
    assert inside[0].sum() == inside[:, 0].sum() == 0  # the black border
    assert inside[1:-1, 1:-1].tolist() == [[1, 0, 1, 1], [0, 1, 0, 1], [0, 0, 1, 1], [0, 0, 1, 0]]
    assert printed.frame[0] @ [6, 6, 1] == pytest.approx([0.03, -0.03, 0.0])


def test_tracking_looks_where_the_plate_is_and_everywhere_when_it_is_lost(packaged):
    rig = with_markers(seen_from(packaged, 30.0), size_m=0.02)
    whole = rig.camera.model_copy(update={"region_of_interest": None})
    rig = rig.model_copy(update={"camera": whole})
    take = film(rig, 4)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics)
    tracker = Tracker(camera, Plate.from_rig(rig.plate))
    elsewhere = np.roll(take.images[3], (300, 400), axis=(0, 1))
    searches = []
    for image in (*take.images[:3], elsewhere):
        sighting = tracker.see(image).sightings[0]
        searches.append(tracker.searches)
        assert sighting.markers == 4
        assert sighting.flags == FrameFlag(0)
    assert searches == [1, 1, 1, 2]
