"""Corners from fitted sides: without bias, with a covariance that is true."""

import numpy as np
import pytest
from takes import film, seen_from, with_markers

from rig.simulated.render import Appearance, PlateRenderer
from vision.camera_model import CameraModel
from vision.corners import refine_corners
from vision.detect import CORNER_PRECISION_PX, MarkerDetector, Markers
from vision.plate import Plate

FRAMES = 12


def corner_errors(rig, appearance=None):
    """Errors in ideal px, shape (frames, markers, 4, 2), and normalised squares, over frames."""
    take = film(rig, FRAMES, appearance=appearance)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    plate = Plate.from_rig(rig.plate)
    renderer = PlateRenderer(rig.camera, rig.plate)
    detector = MarkerDetector(plate.dictionary)
    errors, squares = [], []
    for image, pose in zip(take.images, take.truth, strict=True):
        found = refine_corners(
            image, detector.detect(image).of(plate.ids), camera, detector.modules
        )
        assert found.ids == plate.ids
        assert found.fitted.all()
        points = plate.corners_of(found.ids)[..., :2].reshape(-1, 2)
        truth = camera.undistort(renderer.project(pose, points)).reshape(found.pixels.shape)
        error = found.pixels - truth
        errors.append(error)
        whole = error.reshape(-1, 8)
        squares.append(np.einsum("ni,nij,nj->n", whole, np.linalg.inv(found.covariance), whole) / 8)
    return np.array(errors), np.array(squares)


@pytest.mark.parametrize("azimuth_deg", [0.0, 30.0])
def test_corners_are_good_to_two_hundredths_of_a_pixel_without_bias(packaged, azimuth_deg):
    errors, squares = corner_errors(seen_from(packaged, azimuth_deg))
    assert errors.std() < 0.02
    assert np.abs(errors.mean(axis=(0, 1))).max() < 0.005  # of each of the four corners
    assert 0.8 < squares.mean() < 1.25


def test_small_markers_keep_good_corners(packaged):
    errors, squares = corner_errors(with_markers(seen_from(packaged, 30.0), size_m=0.02))
    assert errors.std() < 0.02
    assert 0.75 < squares.mean() < 1.35


def test_blur_does_not_pull_corners_inwards(packaged):
    errors, _ = corner_errors(seen_from(packaged, 20.0), Appearance(blur_px=1.2))
    inwards = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])  # of TL, TR, BR, BL
    assert abs((errors * inwards).mean()) < 0.005


def test_a_distorting_lens_bends_sides_and_not_corners(packaged):
    rig = seen_from(packaged, 20.0)
    aside = rig.camera.pose.model_copy(update={"look_at_m": (0.15, 0.1, 0.1)})
    lens = rig.camera.intrinsics.model_copy(update={"distortion": (-0.3, 0.1, 0.002, -0.001, 0.0)})
    region = packaged.camera.region_of_interest
    camera = rig.camera.model_copy(update={"intrinsics": lens, "pose": aside})
    left, top = PlateRenderer(camera, rig.plate).corners(np.zeros(6)).min(axis=0).astype(int) - 40
    region = region.model_copy(
        update={"x_px": region.x_px + int(left), "y_px": region.y_px + int(top)}
    )
    camera = camera.model_copy(update={"region_of_interest": region})
    errors, squares = corner_errors(rig.model_copy(update={"camera": camera}))
    assert errors.std() < 0.02
    assert 0.75 < squares.mean() < 1.3


def test_where_there_is_no_edge_the_detected_corners_stay(packaged):
    camera = CameraModel.from_intrinsics(
        packaged.camera.intrinsics, packaged.camera.region_of_interest
    )
    flat = np.random.default_rng(1).normal(100.0, 2.0, (240, 240)).astype(np.uint8)
    square = np.array([[[60.0, 60.0], [100.0, 61.0], [99.0, 101.0], [59.0, 100.0]]])
    corners = refine_corners(flat, Markers((3,), square), camera, 6)
    assert not corners.fitted.any()
    assert np.array_equal(corners.pixels, square)
    assert corners.covariance[0] == pytest.approx(CORNER_PRECISION_PX**2 * np.eye(8))


def test_no_marker_gives_no_corners(packaged):
    camera = CameraModel.from_intrinsics(
        packaged.camera.intrinsics, packaged.camera.region_of_interest
    )
    detector = MarkerDetector("DICT_4X4_50")
    image = np.full((240, 240), 90, np.uint8)
    assert refine_corners(image, detector.detect(image).of((0, 1)), camera, 6).ids == ()
