"""Board files, and the plates they describe."""

import numpy as np
import pytest

from cdpr8.errors import DataError
from cdpr8.rigfile import packaged_rig_path
from vision.board_file import load_board
from vision.plate import Plate, Singles


def board(tmp_path, text):
    path = tmp_path / "board.toml"
    path.write_text(text)
    return load_board(path)


GRID = """
[plate]
dictionary = "DICT_6X6_250"
grid = {columns = 3, rows = 2, size_m = 0.04, gap_m = 0.01, first_id = 5}
"""


def test_a_grid_counts_from_top_left_and_corners_run_clockwise(tmp_path):
    plate = board(tmp_path, GRID)
    assert isinstance(plate, Plate)
    assert plate.ids == (5, 6, 7, 8, 9, 10)
    assert plate.corners[0] == pytest.approx(
        np.array([[-0.07, 0.045, 0], [-0.03, 0.045, 0], [-0.03, 0.005, 0], [-0.07, 0.005, 0]])
    )
    assert plate.corners_of((10, 5))[1] == pytest.approx(plate.corners[0])


def test_a_rig_file_is_a_board_file_too(packaged):
    plate = load_board(packaged_rig_path())
    assert plate.ids == tuple(marker.id for marker in packaged.plate.markers())


def test_single_markers_have_sizes_and_no_places(tmp_path):
    singles = board(
        tmp_path,
        '[singles]\ndictionary = "DICT_ARUCO_ORIGINAL"\nsize_m = 0.05\nids = [3, 4]\n'
        "sizes_m = {4 = 0.02}\n",
    )
    assert isinstance(singles, Singles)
    assert singles.wants(3)
    assert not singles.wants(5)
    assert np.ptp(singles.plate_of(3).corners[0, :, 0]) == pytest.approx(0.05)
    assert np.ptp(singles.plate_of(4).corners[0, :, 0]) == pytest.approx(0.02)


def test_without_ids_every_marker_of_the_dictionary_is_meant(tmp_path):
    singles = board(tmp_path, '[singles]\ndictionary = "DICT_4X4_50"\nsize_m = 0.05\n')
    assert singles.wants(49)


@pytest.mark.parametrize(
    ("text", "says", "allowed"),
    [
        ("not toml at all [", "is no TOML", "[plate]"),
        ("[something]\n", "holds no board", "[singles]"),
        (GRID + '[singles]\ndictionary = "DICT_4X4_50"\nsize_m = 0.05\n', "or two", "[plate]"),
        (GRID.replace("6X6_250", "9X9"), "'DICT_9X9'", "DICT_4X4_50, "),
        (GRID.replace("first_id = 5", "first_id = 248"), "no marker 250", "ids 0 to 249"),
        (GRID.replace("0.04", "-0.04"), "plate.grid.size_m", "[plate]"),
        (GRID.replace("columns", "colums"), "plate.grid", "[plate]"),
        ('[singles]\ndictionary = "DICT_4X4_50"\n', "singles.size_m", "size_m"),
        ("plate = 3\n", "holds no board", "[plate]"),
    ],
)
def test_a_wrong_board_file_is_one_message(tmp_path, text, says, allowed):
    with pytest.raises(DataError) as caught:
        board(tmp_path, text)
    assert says in caught.value.what
    assert allowed in caught.value.allowed
    assert "board.toml" in caught.value.where


def test_a_missing_board_file_is_one_message(tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        load_board(tmp_path / "none.toml")


PLANE = """[[plane]]
dictionary = "DICT_4X4_50"
grid = {{columns = 1, rows = 1, size_m = 0.04, gap_m = 0.01, first_id = {first}}}
pose = {{position_m = {place}, normal = {normal}, up = [0, 0, 1]}}
"""


def test_a_board_of_two_planes_has_its_markers_in_space(tmp_path):
    path = tmp_path / "b.toml"
    path.write_text(
        PLANE.format(first=0, place=[0, 0, 0], normal=[0, -1, 0])
        + PLANE.format(first=7, place=[0.1, 0, 0], normal=[1, 0, 0])
    )
    board = load_board(path)
    assert board.ids == (0, 7)
    assert board.corners[0] == pytest.approx(
        np.array([[-0.02, 0, 0.02], [0.02, 0, 0.02], [0.02, 0, -0.02], [-0.02, 0, -0.02]])
    )
    assert board.corners[1, :, 0] == pytest.approx([0.1] * 4)


def test_an_id_in_two_planes_is_refused(tmp_path):
    path = tmp_path / "b.toml"
    path.write_text(2 * PLANE.format(first=0, place=[0, 0, 0], normal=[0, -1, 0]))
    with pytest.raises(DataError, match="an id in two of them"):
        load_board(path)


def test_a_charuco_board_has_markers_and_saddles(tmp_path):
    path = tmp_path / "b.toml"
    path.write_text(
        '[charuco]\ndictionary = "DICT_6X6_250"\ncolumns = 5\nrows = 7\n'
        "square_m = 0.04\nmarker_m = 0.02\n"
    )
    board = load_board(path)
    assert len(board.ids) == 17
    assert board.saddles.shape == (24, 3)
    assert board.quiet_m == pytest.approx(0.01)
    path.write_text(path.read_text().replace("marker_m = 0.02", "marker_m = 0.05"))
    with pytest.raises(DataError, match="marker_m must be less"):
        load_board(path)
