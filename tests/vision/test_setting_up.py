"""`vision plate`, `vision calibrate`, `vision overlay`: before and after the experiment."""

import json

import cv2
import numpy as np
import pytest
from cases import CASES, measure
from takes import film, seen_from, with_markers, write_run

from cdpr8.errors import ExitCode, UsageError
from cdpr8.rigfile.intrinsics import load_intrinsics
from cdpr8.runfolder import read_video
from cdpr8.terminal import run_app
from vision.bound import bound_of_view, standard_views
from vision.calibrate import calibrate
from vision.calibration_board import BoardView, board_of
from vision.camera_model import CameraModel
from vision.command import app
from vision.mounting import mounting_of
from vision.plate import Plate
from vision.plate_sheet import sheet_of, write_sheet

SIZE = (1280, 1024)
MATRIX = np.array([[1500.0, 0.0, 640.0], [0.0, 1505.0, 512.0], [0.0, 0.0, 1.0]])
LENS = np.array([-0.1, 0.05, 0.001, -0.0005, 0.0])


def test_the_bound_is_what_tracking_reaches(packaged):
    rig = CASES[1].make(packaged)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    view = bound_of_view("30 deg", Plate.from_rig(rig.plate), mounting_of(rig), camera)
    reached = measure(CASES[1], packaged, 24, seed=3)
    assert view.sigma_deg[1] == pytest.approx(reached.sigma_deg, rel=0.35)  # paler, by assumption
    assert view.warnings == ()


def test_a_face_on_plate_and_small_markers_are_warned_about(packaged):
    rig = with_markers(seen_from(packaged, 0.0), size_m=0.02)
    camera = CameraModel.from_intrinsics(rig.camera.intrinsics)
    side, _, _, front = standard_views(Plate.from_rig(rig.plate), camera, 1.0)
    assert front.sigma_deg[1] > 30 * side.sigma_deg[1]
    assert side.warnings == ()
    assert any("face-on" in warning for warning in front.warnings)
    far = standard_views(Plate.from_rig(rig.plate), camera, 1.5)[0]
    assert any("larger markers" in warning for warning in far.warnings)


def test_a_printed_plate_is_found_where_it_was_laid_out(packaged, tmp_path):
    plate = Plate.from_rig(packaged.plate)
    sheet = sheet_of(plate, 0.01)
    per_mm = 3
    picture = np.full((int(sheet.height_mm * per_mm), int(sheet.width_mm * per_mm)), 255, np.uint8)
    for box in sheet.boxes:
        x, y, width, height = (round(value * per_mm) for value in box)
        picture[y : y + height, x : x + width] = 0
    book = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    corners, ids, _ = cv2.aruco.ArucoDetector(book).detectMarkers(picture)
    assert sorted(ids.ravel().tolist()) == sorted(plate.ids)
    for found, marker in zip(corners, ids.ravel(), strict=True):
        side = np.linalg.norm(found[0][1] - found[0][0]) / per_mm
        assert side == pytest.approx(40.0, abs=0.5)
        placed = plate.corners[plate.ids.index(int(marker))]
        first = plate.corners[plate.ids.index(int(ids.ravel()[0]))]
        apart = (found[0][0] - corners[0][0][0]) / per_mm
        assert apart == pytest.approx(1e3 * (placed - first)[0, :2] * [1, -1], abs=0.6)


def test_sheets_are_to_scale(packaged, tmp_path):
    sheet = sheet_of(Plate.from_rig(packaged.plate), 0.01)
    write_sheet(sheet, tmp_path / "p.svg")
    write_sheet(sheet, tmp_path / "p.pdf")
    svg, pdf = (tmp_path / "p.svg").read_text(), (tmp_path / "p.pdf").read_bytes()
    assert f'width="{sheet.width_mm:.4f}mm"' in svg
    assert 'width="100.0000" height="0.4000"' in svg  # the ruler
    assert pdf.startswith(b"%PDF-1.4")
    assert f"[0 0 {sheet.width_mm * 72 / 25.4:.4f} ".encode() in pdf
    start = int(pdf.split(b"startxref\n")[1].split()[0])
    assert pdf[start:].startswith(b"xref")
    with pytest.raises(UsageError, match="unknown kind of file"):
        write_sheet(sheet, tmp_path / "p.png")


def board_views(tilts_deg, *, noise_px=0.05, spread=True):
    """Corners of an 8 x 6 chessboard as a known camera sees them."""
    points = np.zeros((48, 3))
    points[:, :2] = np.mgrid[:8, :6].T.reshape(-1, 2) * 0.03
    generator, views = np.random.default_rng(2), []
    for number, (about_y, about_x) in enumerate(tilts_deg):
        turn = np.deg2rad([about_x, about_y, 10.0 * (number % 3)])
        aside = (np.array([number % 3 - 1, number // 3 % 3 - 1]) if spread else np.zeros(2)) * 0.12
        away = (0.6 if spread else 1.2) + 0.05 * (number % 4)
        place = np.array([*(aside - [0.105, 0.075]), away])
        pixels = cv2.projectPoints(points, turn, place, MATRIX, LENS)[0].reshape(-1, 2)
        pixels += generator.normal(0.0, noise_px, pixels.shape)
        views.append(BoardView(f"shot {number}", points, pixels))
    return views


GOOD_TILTS = [(a, b) for a in (-35, -20, 0, 25, 35) for b in (-30, 0, 30)] * 2


def test_good_pictures_give_the_camera_and_a_plain_yes():
    found = calibrate(board_views(GOOD_TILTS), SIZE)
    assert found.faults == ()
    assert found.good
    assert np.abs(found.matrix - MATRIX).max() < 5 * max(found.focal_sigma_px) + 2.0
    assert found.reprojection_px == pytest.approx(0.05 * np.sqrt(2), rel=0.2)


def test_frontal_pictures_are_refused_though_they_fit():
    found = calibrate(board_views([(0.5, 0.5)] * 9), SIZE)
    assert found.reprojection_px < 0.2
    assert not found.good
    assert any("never tilted about its vertical" in fault for fault in found.faults)
    assert any("turned 20 to 45 deg" in picture for picture in found.missing)


def test_pictures_of_the_middle_alone_miss_the_rim():
    found = calibrate(board_views(GOOD_TILTS[:9], spread=False), SIZE)
    assert any("no corner was ever in top left" in fault for fault in found.faults)


def test_a_bent_board_is_refused():
    found = calibrate(board_views(GOOD_TILTS, noise_px=1.0), SIZE)
    assert any("corners miss by" in fault for fault in found.faults)


def chessboard_picture(view):
    """A picture of an 8 x 6 board: its squares filled between projected corners, supersampled."""
    points = view.points
    homography, _ = cv2.findHomography(points[:, :2] / 0.03, view.pixels)
    board = np.full((9 * 60, 11 * 60), 255, np.uint8)
    for row in range(7):
        for column in range(9):
            if (row + column) % 2 == 0:
                left, top = (column + 1) * 60, (row + 1) * 60
                board[top : top + 60, left : left + 60] = 20
    to_board = np.array([[1 / 60, 0, -2.0 + 0.5 / 60], [0, 1 / 60, -2.0 + 0.5 / 60], [0, 0, 1.0]])
    return cv2.warpPerspective(
        board, homography @ to_board, SIZE, flags=cv2.INTER_AREA, borderValue=255
    )


def test_calibrate_reads_pictures_and_writes_only_what_is_good(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = []
    for view in board_views(GOOD_TILTS[:4]):
        names.append(f"{view.name.replace(' ', '')}.png")
        cv2.imwrite(names[-1], chessboard_picture(view))
    options = ["--chessboard", "8x6", "--square-mm", "30"]
    assert run_app(app, ["calibrate", *names, *options]) == ExitCode.CHECK_FAILED
    said = capsys.readouterr().out
    assert "not good enough: only 4 pictures" in said
    assert not (tmp_path / "intrinsics.yml").exists()
    code = run_app(app, ["calibrate", *names, *options, "--force", "--json"])
    assert code == ExitCode.CHECK_FAILED
    assert json.loads(capsys.readouterr().out)["with_board"] == 4
    kept = load_intrinsics(tmp_path / "intrinsics.yml")
    assert (kept.width_px, kept.height_px) == SIZE


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["shot.png"], ExitCode.USAGE, "which board?"),
        (["shot.png", "--chessboard", "9by6"], ExitCode.USAGE, "a board of 9by6"),
        (["shot.png", "--charuco", "5x7"], ExitCode.USAGE, "--marker-mm smaller"),
        (["shot.png", "--chessboard", "9x6"], ExitCode.BAD_DATA, "the board is in 0 pictures"),
        (["none.png", "--chessboard", "9x6"], ExitCode.BAD_DATA, "no video 'none.png'"),
        (["shot.png", "tiny.png", "--chessboard", "9x6"], ExitCode.BAD_DATA, "of one size"),
    ],
)
def test_what_cannot_be_calibrated_is_one_message(
    arguments, code, says, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    cv2.imwrite("shot.png", np.full((60, 80), 90, np.uint8))
    cv2.imwrite("tiny.png", np.full((30, 40), 90, np.uint8))
    assert run_app(app, ["calibrate", *arguments]) == code
    said = capsys.readouterr().err
    assert says in said
    assert "Traceback" not in said


def test_plate_prints_and_predicts(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run_app(app, ["plate", "p.pdf", "--grid", "2x2", "--size-mm", "20", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert (tmp_path / "p.pdf").stat().st_size > 1000
    assert [view["view"] for view in result["views"]][1] == "along the pitch axis"
    assert run_app(app, ["plate", "--grid", "2by2"]) == ExitCode.USAGE
    assert run_app(app, ["plate"]) == ExitCode.OK
    assert "warning: " in capsys.readouterr().err


def test_overlay_draws_on_every_frame(take, packaged_text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_run(tmp_path / "runs" / "today", take, packaged_text, take.images[:5], take.times[:5])
    assert run_app(app, ["overlay", "today"]) == ExitCode.OK
    pictures = [image for image, _ in read_video(tmp_path / "today.overlay.mp4")]
    assert len(pictures) == 5
    assert pictures[0].shape[1] >= 640
    assert run_app(app, ["overlay", "today", "--out", "nowhere/o.mp4"]) == ExitCode.BAD_DATA


def test_boards_are_named_plainly():
    assert board_of("9x6", None, 25.0, None, "").columns == 9
    assert board_of(None, "5x7", 40.0, 20.0, "DICT_4X4_50").marker_m == 0.02


def test_a_film_of_whole_frames_has_their_size(packaged):
    whole = packaged.camera.model_copy(update={"region_of_interest": None})
    rig = packaged.model_copy(update={"camera": whole})
    assert film(rig, 1).images[0].shape == (1024, 1280)
