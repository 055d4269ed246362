"""Pose of a plane: both solutions, the choice between them, and an honest covariance."""

import numpy as np
import pytest
from takes import film, moving, seen_from, still, with_markers

from vision.camera_model import CameraModel
from vision.corners import refine_corners
from vision.detect import MarkerDetector
from vision.mounting import mounting_of
from vision.plate import Plate
from vision.pose import estimate_pose


def estimates(rig, frames, *, motion=moving, seed=1, remember=True):
    """(estimate, platform values, true values) of each frame."""
    take = film(rig, frames, motion=motion, seed=seed)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    plate, mounting = Plate.from_rig(rig.plate), mounting_of(rig)
    detector = MarkerDetector(plate.dictionary)
    previous, found = None, []
    for image, truth in zip(take.images, take.truth, strict=True):
        markers = detector.detect(image).of(plate.ids)
        if not markers.ids:
            continue
        corners = refine_corners(image, markers, camera, detector.modules)
        estimate = estimate_pose(plate.corners_of(corners.ids), corners, camera, previous)
        previous = estimate.pose if remember else None
        found.append((estimate, mounting.platform(estimate.pose), truth))
    return found


@pytest.mark.parametrize(("azimuth_deg", "size_m"), [(0.0, 0.04), (30.0, 0.04), (30.0, 0.02)])
def test_errors_are_of_the_size_that_the_covariance_says(packaged, azimuth_deg, size_m):
    rig = seen_from(packaged, azimuth_deg)
    if size_m != 0.04:
        rig = with_markers(rig, size_m=size_m)
    found = estimates(rig, 48)
    errors = np.array([pose.values - truth for _, pose, truth in found])
    sigmas = np.array([np.sqrt(np.diag(pose.covariance)) for _, pose, _ in found])
    honest = np.sqrt((errors**2 / sigmas**2).mean(axis=0))
    assert (honest < 1.5).all()
    assert (honest > 1 / 1.5).all()


def test_all_six_together_are_of_the_size_that_the_covariance_says(packaged):
    found = estimates(seen_from(packaged, 30.0), 48)
    errors = [(pose.values - truth, pose.covariance) for _, pose, truth in found]
    squares = [error @ np.linalg.solve(covariance, error) / 6 for error, covariance in errors]
    assert 0.7 < np.mean(squares) < 1.4


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("remember", [True, False])
def test_a_face_on_single_marker_does_not_flip_unnoticed(packaged, seed, remember):
    rig = with_markers(seen_from(packaged, 3.0), size_m=0.02, across=1)
    found = estimates(rig, 48, seed=seed, remember=remember)
    assert len(found) > 40
    flipped = 0
    for estimate, pose, truth in found:
        error = np.rad2deg(np.abs(pose.values - truth)[3:]).max()
        sigma = np.rad2deg(np.sqrt(np.diag(pose.covariance))[3:]).max()
        if error > max(4 * sigma, 2.0):
            flipped += 1
            assert estimate.ambiguous
    assert any(estimate.ambiguous for estimate, _, _ in found)
    assert remember or flipped, "without this the test shows nothing"


def test_where_corners_do_not_decide_the_frame_before_does(packaged):
    rig = with_markers(seen_from(packaged, 2.0), size_m=0.02, across=1)
    found = estimates(rig, 24, motion=still)
    assert any(estimate.ambiguous for estimate, _, _ in found)
    turns = np.array([estimate.pose.rotation[2] for estimate, _, _ in found])
    assert np.ptp(turns, axis=0).max() < 0.1, "one branch throughout"
    assert any(estimate.from_previous for estimate, _, _ in found)


def test_seen_from_the_side_there_is_no_doubt(packaged):
    for estimate, _, _ in estimates(seen_from(packaged, 30.0), 6):
        assert estimate.ratio > 20
        assert not estimate.ambiguous


def test_misses_beyond_noise_widen_the_covariance(packaged):
    rig = seen_from(packaged, 30.0)
    image = film(rig, 1).images[0]
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    plate, detector = Plate.from_rig(rig.plate), MarkerDetector("DICT_4X4_50")
    corners = refine_corners(image, detector.detect(image), camera, detector.modules)
    true = estimate_pose(plate.corners, corners, camera).pose
    misprint = np.random.default_rng(1).normal(0.0, 3e-4, plate.corners.shape) * [1, 1, 0]
    wrong = estimate_pose(plate.corners + misprint, corners, camera).pose
    moved = wrong.translation - true.translation
    sigma = np.sqrt(np.diag(wrong.covariance)[3:])
    assert wrong.reprojection_px > 10 * true.reprojection_px
    assert (np.abs(moved) < 4 * sigma).all()
