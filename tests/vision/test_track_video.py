"""`vision track VIDEO`: a real video, junk, and videos that do not fit."""

from pathlib import Path

import numpy as np
import pytest

from cdpr8.errors import DataError
from cdpr8.rigfile.intrinsics import load_intrinsics
from cdpr8.runfolder import FrameFlag, VideoWriter
from vision.board_file import load_board
from vision.camera_model import CameraModel
from vision.plate import Plate, Singles
from vision.tables import VIDEO_POSE
from vision.tracked_video import track_video

SINGLES = Path(__file__).parent / "aruco_single_video.toml"
IDS = {101, 601, 701, 801, 901, 1001}
README_REPROJECTION_PX = 0.374


@pytest.fixture(scope="module")
def real(data):
    camera = CameraModel.from_intrinsics(load_intrinsics(data / "intrinsics.yml"))
    return track_video(data / "video.avi", camera, load_board(SINGLES))


def test_a_truncated_real_video_says_how_much_is_missing(data, tmp_path):
    camera = CameraModel.from_intrinsics(load_intrinsics(data / "intrinsics.yml"))
    path, notes = tmp_path / "cut.avi", []
    path.write_bytes((data / "video.avi").read_bytes()[:300_000])
    track_video(path, camera, load_board(SINGLES), notes=notes)
    assert "13 whole frames of the 145 announced" in notes[0]


def test_every_frame_of_the_real_video_with_markers_has_poses(real):
    assert tuple(real.columns) == VIDEO_POSE.names
    assert set(real["frame"]) == set(range(145))
    unseen = real["marker"].isna()
    assert real.loc[~unseen, ["x_m", "z_m", "rx_deg", "sigma_x_m", "reproj_px"]].notna().all().all()
    assert real.loc[unseen, ["x_m", "z_m", "rx_deg", "sigma_x_m", "reproj_px"]].isna().all().all()
    assert (real.loc[unseen, "flags"] & int(FrameFlag.NO_MARKER) != 0).all()
    assert set(real.loc[~unseen, "marker"]) == IDS
    assert len(real[~unseen]) / 145 > 5.3  # its README counts 5.37 a frame


def test_the_reprojection_error_of_the_real_video_is_that_of_its_readme(real):
    assert real["reproj_px"].mean() <= README_REPROJECTION_PX


def test_markers_of_the_real_sheet_keep_their_distance(real):
    places = real.dropna(subset="marker").pivot(
        index="frame", columns="marker", values=["x_m", "y_m", "z_m"]
    )
    there = {marker: places.xs(marker, axis=1, level="marker").to_numpy() for marker in IDS}
    apart = np.linalg.norm(there[101] - there[1001], axis=1)
    apart = apart[np.isfinite(apart)]
    assert len(apart) > 100
    assert np.median(np.abs(apart - np.median(apart))) < 0.02 * np.median(apart)


def test_times_are_those_of_the_container(real):
    times = real.drop_duplicates("frame")["t_s"].to_numpy()
    assert (np.diff(times) > 0).all()
    assert np.median(np.diff(times)) == pytest.approx(1 / 4.98, rel=0.01)


def film_to(path, images, times):
    height, width = images[0].shape
    writer = VideoWriter(path, width, height, 16.0)
    for image, t_s in zip(images, times, strict=True):
        writer.write(image, float(t_s))
    writer.close()
    return path


@pytest.fixture(scope="module")
def camera(packaged):
    return CameraModel.from_intrinsics(
        packaged.camera.intrinsics, packaged.camera.region_of_interest
    )


@pytest.fixture(scope="module")
def plate(packaged):
    return Plate.from_rig(packaged.plate)


@pytest.fixture(scope="module")
def video(take, tmp_path_factory):
    return film_to(tmp_path_factory.mktemp("video") / "v.mkv", take.images[:6], take.times[:6])


def test_a_plate_gives_one_row_a_frame_in_the_camera_frame(video, camera, plate, packaged):
    poses = track_video(video, camera, plate)
    distance = np.linalg.norm(
        np.subtract(packaged.camera.pose.position_m, packaged.plate.pose.position_m)
    )
    assert len(poses) == 6
    assert poses["marker"].isna().all()
    away = np.linalg.norm(poses[["x_m", "y_m", "z_m"]].to_numpy(), axis=1)
    assert away == pytest.approx(np.full(6, distance), abs=1e-3)


def test_an_uneven_frame_rate_is_kept_and_said(take, camera, plate, tmp_path):
    times = np.array([0.0, 0.06, 0.13, 0.19, 0.40, 0.46])
    path = film_to(tmp_path / "v.mkv", take.images[:6], times)
    notes = []
    poses = track_video(path, camera, plate, notes=notes)
    assert poses["t_s"].to_numpy() == pytest.approx(times, abs=1e-3)
    assert "variable frame rate" in notes[0]
    assert poses["flags"].iloc[4] == FrameFlag.DROPPED_BEFORE


def test_a_video_without_times_takes_the_rate_it_is_given(video, camera, plate, monkeypatch):
    from cdpr8.runfolder.video import read_video

    monkeypatch.setattr(
        "vision.tracked_video.read_video", lambda p: ((i, None) for i, _ in read_video(p))
    )
    notes = []
    assert track_video(video, camera, plate, notes=notes)["t_s"].isna().all()
    assert "--fps" in notes[0]
    assert track_video(video, camera, plate, fps=10.0)["t_s"].iloc[5] == pytest.approx(0.5)


def test_a_text_file_is_no_video(camera, plate, tmp_path):
    path = tmp_path / "take.mp4"
    path.write_text("this is not a video\n" * 100)
    with pytest.raises(DataError, match="not a video"):
        track_video(path, camera, plate)


def test_a_truncated_video_gives_its_whole_frames_and_says_so(take, camera, plate, tmp_path):
    path = film_to(tmp_path / "v.mkv", take.images[:40], take.times[:40])
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 6 // 10])
    notes = []
    poses = track_video(path, camera, plate, notes=notes)
    assert 10 <= len(poses) < 40
    assert "cut short" in notes[0]
    assert poses["x_m"].notna().all()


def test_a_video_without_any_marker_is_one_message(camera, plate, tmp_path):
    path = film_to(tmp_path / "v.mkv", [np.full((240, 240), 90, np.uint8)] * 3, [0, 0.1, 0.2])
    with pytest.raises(DataError, match="no marker of DICT_4X4_50 in any of 3 frames") as caught:
        track_video(path, camera, plate)
    assert caught.value.remedy


def test_intrinsics_of_another_size_are_one_message(video, packaged, plate):
    full = CameraModel.from_intrinsics(packaged.camera.intrinsics)
    with pytest.raises(DataError, match="240 x 240 px, the intrinsics are for 1280 x 1024"):
        track_video(video, full, plate)


def test_a_board_with_other_markers_is_one_message(video, camera):
    with pytest.raises(DataError, match=r"does not fit.*show 0, 1, 2, 3") as caught:
        track_video(video, camera, Singles("DICT_4X4_50", 0.04, (7, 8)))
    assert "7, 8" in caught.value.allowed


def test_a_board_of_another_layout_is_one_message(video, camera, plate):
    wider = Plate(plate.dictionary, plate.ids, plate.corners + plate.corners[:, :1] * [0.6, 0, 0])
    with pytest.raises(DataError, match="does not fit: median reprojection error"):
        track_video(video, camera, wider)


def test_a_mirrored_board_is_one_message(video, camera, plate):
    mirrored = Plate(plate.dictionary, plate.ids[::-1], plate.corners)
    with pytest.raises(DataError, match="no pose puts them where they are"):
        track_video(video, camera, mirrored)
