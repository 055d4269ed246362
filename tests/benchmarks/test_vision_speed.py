"""What tracking costs, as multiples of OpenCV's bare detector in the same process."""

import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "vision"))

from takes import film, seen_from, with_markers

from cdpr8.rigfile import load_rig, packaged_rig_path
from vision.camera_model import CameraModel
from vision.plate import Plate
from vision.refine import Refinement
from vision.tracker import Tracker

LENS = (-0.2, 0.05, 0.001, -0.001, 0.0)


@pytest.fixture(scope="module", params=[False, True], ids=["no distortion", "distortion"])
def whole_frames(request):
    """Twelve whole frames of 1280 x 1024 px and their camera."""
    rig = with_markers(seen_from(load_rig(packaged_rig_path()), 30.0), size_m=0.02)
    changed = {"region_of_interest": None}
    if request.param:
        changed["intrinsics"] = rig.camera.intrinsics.model_copy(update={"distortion": LENS})
    rig = rig.model_copy(update={"camera": rig.camera.model_copy(update=changed)})
    images = film(rig, 12).images
    assert images[0].shape == (1024, 1280)
    return images, CameraModel.from_intrinsics(rig.camera.intrinsics), Plate.from_rig(rig.plate)


def seconds(work, images):
    spent = []
    for image in images:
        start = time.process_time()
        work(image)
        spent.append(time.process_time() - start)
    return np.array(spent)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("refinement", "most"), [(Refinement.CORNERS, 1.5), (Refinement.PHOTOMETRIC, 4.0)]
)
def test_tracking_costs_a_small_multiple_of_the_bare_detector(whole_frames, refinement, most):
    images, camera, plate = whole_frames
    cv2.setNumThreads(1)
    book = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    bare = cv2.aruco.ArucoDetector(book, cv2.aruco.DetectorParameters())
    tracker = Tracker(camera, plate, refinement)
    for image in images[:2]:  # the first frame is searched whole, and compiles
        tracker.see(image)
    ratios = []
    for _ in range(5):
        detector = np.median(seconds(bare.detectMarkers, images[2:]))
        ratios.append(np.median(seconds(tracker.see, images[2:])) / detector)
    assert tracker.searches == 1
    sys.stdout.write(f"\n{refinement}: {np.median(ratios):.2f} times the bare detector\n")
    assert np.median(ratios) <= most
