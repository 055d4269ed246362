"""Other people's photographs: one-frame videos, at the reprojection errors of their README."""

import os
from pathlib import Path

import pytest

from cdpr8.rigfile.intrinsics import load_intrinsics
from cdpr8.runfolder import FrameFlag
from vision.board_file import load_board
from vision.camera_model import CameraModel
from vision.tracked_video import track_video

CHARUCO = (
    '[charuco]\ndictionary = "DICT_6X6_250"\ncolumns = 5\nrows = 7\n'
    "square_m = 0.04\nmarker_m = 0.02\n"
)
SINGLES = '[singles]\ndictionary = "DICT_6X6_250"\nsize_m = 0.05\n'
GRID = '[plate]\ndictionary = "{}"\ngrid = {{columns = 5, rows = 7, size_m = 0.04, gap_m = 0.01}}\n'


@pytest.fixture(scope="module")
def pictures():
    beside = Path(__file__).parents[3] / "shared" / "data"
    folder = Path(os.environ.get("CDPR_DATA", beside)) / "vision" / "opencv_aruco_tutorial"
    if not folder.is_dir():
        pytest.skip(f"no photographs in {folder}: set CDPR_DATA to the folder of recordings")
    return folder


def tracked(pictures, name, camera_file, board, tmp_path):
    path = tmp_path / "board.toml"
    path.write_text(board)
    lens = load_intrinsics(pictures / camera_file, image_size=(640, 480))
    return track_video(pictures / name, CameraModel.from_intrinsics(lens), load_board(path))


@pytest.mark.parametrize(
    ("name", "most_px"),
    [
        ("img_00.jpg", 0.233),
        ("img_01.jpg", 0.233),
        ("img_02.jpg", 0.26),  # the README has 0.233 with OpenCV's own window
        ("img_03.jpg", 0.233),
        ("chocclusion_original.jpg", 0.173),
    ],
)
def test_charuco_boards(pictures, tmp_path, name, most_px):
    poses = tracked(pictures, name, "tutorial_camera_charuco.yml", CHARUCO, tmp_path)
    assert len(poses) == 1
    assert poses["reproj_px"].iloc[0] <= most_px
    assert poses["flags"].iloc[0] == 0


def test_single_markers(pictures, tmp_path):
    name = "singlemarkersoriginal.jpg"
    poses = tracked(pictures, name, "tutorial_camera_charuco.yml", SINGLES, tmp_path)
    assert set(poses["marker"]) == {23, 40, 62, 98, 124, 203}
    assert poses["reproj_px"].median() <= 0.21


def test_a_grid_of_another_dictionary_with_a_camera_that_does_not_fit(pictures, tmp_path):
    board = GRID.format(pictures / "tutorial_dict.yml")
    poses = tracked(pictures, "gboriginal.png", "tutorial_camera_params.yml", board, tmp_path)
    assert poses["markers"].iloc[0] == 35
    assert poses["reproj_px"].iloc[0] < 2.4
    assert poses["flags"].iloc[0] & int(FrameFlag.HIGH_REPROJECTION)
