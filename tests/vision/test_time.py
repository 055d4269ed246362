"""Exposure, rolling shutter, and frames that only the motion shows to be missing."""

import numpy as np
import pandas as pd
import pytest
from cases import cropped
from takes import FPS, PITCH_DEG, PITCH_HZ, REST_S, moving, seen_from, with_markers

from cdpr8.errors import UsageError
from cdpr8.runfolder.tables import FrameFlag
from rig.simulated.camera import SimulatedCamera
from vision import corrected_amplitude, exposure_attenuation
from vision.camera_model import CameraModel
from vision.motion_clock import flag_jumps_of_motion, jumps_of_motion
from vision.mounting import mounting_of
from vision.plate import Plate
from vision.rolling_shutter import delay_of, without_skew
from vision.tracker import Tracker


def test_an_exposure_shrinks_a_sine_as_its_average_does():
    exposure, phase = 0.06, np.linspace(0.0, 2 * np.pi, 400)
    open_for = np.linspace(-exposure / 2, exposure / 2, 2001)
    seen = np.sin(phase[:, None] + 2 * np.pi * 2.06 * open_for).mean(axis=1)
    assert exposure_attenuation(2.06, exposure) == pytest.approx(seen.max(), rel=1e-3)
    assert corrected_amplitude(seen.max(), 2.06, exposure) == pytest.approx(1.0, rel=1e-3)
    assert exposure_attenuation(2.06, 0.0) == 1.0


def test_what_an_exposure_left_nothing_of_is_not_corrected():
    with pytest.raises(UsageError, match=r"leaves 0\.00"):
        corrected_amplitude(1.0, 10.0, 0.1)


ROW_DELAY_S = 2e-4
STRIP = 20


def rolling(rig, times):
    """Pictures whose rows are exposed one after the other, the middle one at the stamp."""
    side = rig.camera.region_of_interest.height_px
    images = np.zeros((len(times), side, side), np.uint8)
    camera = SimulatedCamera(rig.camera, rig.plate, moving, np.random.default_rng(1))
    for top in range(0, side, STRIP):
        late = ROW_DELAY_S * (top + (STRIP - 1) / 2 - (side - 1) / 2)
        rows = slice(top, top + STRIP)
        for image, t_s in zip(images, times, strict=True):
            image[rows] = camera.expose(t_s + late)[rows]
    return images


def test_a_rolling_shutter_is_put_right(packaged):
    rig = cropped(with_markers(seen_from(packaged, 30.0), size_m=0.03), 160)
    times = REST_S + 0.1 + np.arange(14) / FPS
    images = rolling(rig, times)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    plate, mounting = Plate.from_rig(rig.plate), mounting_of(rig)
    tracker = Tracker(camera, plate)
    poses = [tracker.see(image).sightings[0].estimate.pose for image in images]
    seen_at = np.add(times, [delay_of(plate, pose, camera, ROW_DELAY_S) for pose in poses])
    straight = without_skew(seen_at, poses, plate, camera, ROW_DELAY_S)

    def rms_deg(found):
        values = np.array([mounting.platform(pose).values[3:] for pose in found])
        error = np.rad2deg(values - moving(seen_at)[:, 3:])[2:-2]
        return float(np.sqrt((error**2).mean()))

    assert rms_deg(straight) < rms_deg(poses) / 3


def sine(times, seed=1):
    noise = np.random.default_rng(seed).normal(0.0, 0.005, len(times))
    return PITCH_DEG * np.sin(2 * np.pi * PITCH_HZ * times) + noise


def test_a_steady_motion_does_not_jump():
    times = np.arange(120) / FPS
    assert jumps_of_motion(times, sine(times)) == []


@pytest.mark.parametrize("lost", [1, 2, -1])
def test_frames_lost_or_doubled_behind_the_stamps_show_in_the_motion(lost):
    stamps = np.arange(120) / FPS
    real = stamps + np.where(np.arange(120) >= 60, lost / FPS, 0.0)
    jumps = jumps_of_motion(stamps, sine(real))
    assert [jump.frames for jump in jumps] == [lost]
    assert abs(jumps[0].index - 60) <= 1


def test_noise_and_rest_do_not_jump():
    times = np.arange(120) / FPS
    assert jumps_of_motion(times, np.random.default_rng(1).normal(size=120)) == []
    assert jumps_of_motion(times, np.zeros(120)) == []
    assert jumps_of_motion(times[:10], np.zeros(10)) == []


def test_a_jump_becomes_a_flag_and_a_sentence():
    stamps = np.arange(120) / FPS
    real = stamps + np.where(np.arange(120) >= 60, 1 / FPS, 0.0)
    table = pd.DataFrame({"frame": range(120), "t_s": stamps, "pitch_deg": sine(real), "flags": 0})
    notes = []
    flag_jumps_of_motion(table, "pitch_deg", notes)
    flagged = table[table["flags"] == int(FrameFlag.DROPPED_BEFORE)]
    assert len(flagged) == 1
    assert "1 frame missing there that the stamps do not show" in notes[0]
