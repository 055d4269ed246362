"""`vision track RUN`: accuracy on rendered runs, and what odd frames become."""

import numpy as np
import pandas as pd
import pytest
from takes import FPS, PITCH_DEG, PITCH_HZ, REST_S, film, still, write_run

from cdpr8.errors import DataError
from cdpr8.runfolder import POSE_AXES, FrameFlag, load_run
from cdpr8.runfolder.tables import POSE
from vision.refine import Refinement
from vision.tracked_run import track_run


@pytest.fixture(scope="module")
def poses(take, packaged_text, tmp_path_factory):
    folder = write_run(tmp_path_factory.mktemp("runs") / "run", take, packaged_text)
    return track_run(load_run(folder))


def in_file_units(truth):
    return np.column_stack([truth[:, :3], np.rad2deg(truth[:, 3:])])


def test_the_table_is_that_of_the_run_folder(poses, take):
    assert tuple(poses.columns) == POSE.names
    assert list(poses["frame"]) == list(range(len(take.times)))
    assert poses["t_s"].to_numpy() == pytest.approx(take.times, abs=1e-6)
    assert (poses["flags"] == 0).all()
    assert (poses["markers"] == 4).all()


def test_pitch_is_good_to_a_few_thousandths_of_a_degree(poses, take):
    error = poses["pitch_deg"].to_numpy() - np.rad2deg(take.truth[:, 4])
    assert np.sqrt((error**2).mean()) < 0.003
    assert abs(error.mean()) < 0.001


def test_all_six_are_where_the_platform_was(poses, take):
    errors = poses[list(POSE_AXES)].to_numpy() - in_file_units(take.truth)
    assert (np.sqrt((errors**2).mean(axis=0)) < [8e-5, 8e-5, 8e-5, 0.05, 0.003, 0.05]).all()


def test_the_amplitude_of_a_fitted_sine_is_good_to_a_thousandth(poses, take):
    moving = take.times > REST_S + 0.1
    phase = 2 * np.pi * PITCH_HZ * (take.times[moving] - REST_S)
    design = np.column_stack([np.sin(phase), np.cos(phase), np.ones_like(phase)])
    fit = np.linalg.lstsq(design, poses["pitch_deg"].to_numpy()[moving], rcond=None)[0]
    exposed = np.sinc(PITCH_HZ * take.rig.camera.exposure_s)  # an exposure averages the motion
    assert np.hypot(*fit[:2]) == pytest.approx(PITCH_DEG * exposed, rel=1e-3)


def test_sigmas_and_correlations_are_those_of_the_errors(poses, take):
    errors = poses[list(POSE_AXES)].to_numpy() - in_file_units(take.truth)
    sigmas = poses[[f"sigma_{name}" for name in POSE_AXES]].to_numpy()
    honest = np.sqrt((errors**2 / sigmas**2).mean(axis=0))
    assert (honest < 1.5).all()
    assert (honest > 1 / 1.5).all()
    columns = [column for column in poses.columns if column.startswith("corr_")]
    assert len(columns) == 15
    assert poses[columns].abs().to_numpy().max() <= 1.0


@pytest.mark.long
def test_two_processes_see_what_one_sees(take, packaged_text, tmp_path, monkeypatch):
    images = list(take.images)
    images[40] = images[39].copy()  # repeated just where the second process begins
    run = load_run(write_run(tmp_path / "halves", take, packaged_text, images))
    alone = track_run(run)
    monkeypatch.setattr("vision.watched.LEAST", 40)
    steps: list[int] = []
    together = track_run(run, workers=2, step=lambda: steps.append(1))
    # Sums differ in their last digits by where arrays lie in memory, flags and times not at all.
    pd.testing.assert_frame_equal(together, alone, rtol=1e-9, atol=1e-9)
    exact = list(together.select_dtypes("integer"))
    pd.testing.assert_frame_equal(together[exact], alone[exact], check_exact=True)
    assert FrameFlag(int(together["flags"][40])) == FrameFlag.REPEATED
    assert len(steps) == len(images)


def test_odd_frames_are_flagged_and_their_neighbours_unharmed(
    take, packaged, packaged_text, tmp_path
):
    images = [image.copy() for image in film(packaged, 14, motion=still, seed=4).images]
    images[2] = np.random.default_rng(1).integers(0, 5, images[2].shape).astype(np.uint8)
    images[4] = np.full_like(images[4], 90)
    images[6][:, :118] = 90  # half the plate hidden
    images[8][: images[8].shape[0] // 2] = 90
    images[8][:, :118] = 90  # three of the four markers hidden
    images[10] = images[9].copy()
    times = take.times[:14].copy()
    times[12:] += 1 / FPS
    folder = write_run(tmp_path / "odd", take, packaged_text, images, times)
    poses = track_run(load_run(folder)).set_index("frame")
    flags = [FrameFlag(int(bits)) for bits in poses["flags"]]
    assert flags[2] == FrameFlag.BLACK | FrameFlag.NO_MARKER
    assert flags[4] == FrameFlag.NO_MARKER
    assert FrameFlag.FEW_MARKERS in flags[8]
    assert flags[10] == FrameFlag.REPEATED
    assert flags[12] == FrameFlag.DROPPED_BEFORE
    assert [number for number, bits in enumerate(flags) if bits] == [2, 4, 8, 10, 12]
    assert list(poses["markers"].loc[[2, 4, 6, 8]]) == [0, 0, 2, 1]
    lost = poses["pitch_deg"].isna()
    assert list(poses.index[lost]) == [2, 4]
    assert poses.loc[lost, ["x_m", "sigma_pitch_deg", "reproj_px", "ratio"]].isna().all().all()
    assert poses.loc[~lost, "pitch_deg"].abs().max() < 0.03
    assert poses.loc[8, "sigma_pitch_deg"] > 2 * poses.loc[7, "sigma_pitch_deg"]


def test_flags_of_the_recorder_are_kept(take, packaged_text, tmp_path):
    folder = write_run(tmp_path / "run", take, packaged_text, take.images[:3], take.times[:3])
    table = (folder / "frames.csv").read_text().splitlines()
    table[2] = table[2][: table[2].rindex(",")] + ",1"
    (folder / "frames.csv").write_text("\n".join(table) + "\n")
    assert list(track_run(load_run(folder))["flags"]) == [0, 1, 0]


def without_camera_pose(text):
    start = text.index("[camera.pose]")
    return text[:start] + text[text.index("[plate]") :]


def test_without_a_camera_pose_the_rest_is_zero(take, packaged_text, tmp_path):
    text = without_camera_pose(packaged_text)
    folder = write_run(tmp_path / "run", take, text, take.images[:40], take.times[:40])
    notes = []
    poses = track_run(load_run(folder), notes=notes)
    errors = poses[list(POSE_AXES)].to_numpy() - in_file_units(take.truth[:40])
    assert "8 frames at rest" in notes[0]
    assert np.abs(errors[:8].mean(axis=0)).max() < 1e-3
    assert np.sqrt((errors[:, 4] ** 2).mean()) < 0.004


def test_without_a_camera_pose_and_a_rest_there_is_no_telling(take, packaged_text, tmp_path):
    text = without_camera_pose(packaged_text)
    late = write_run(tmp_path / "run", take, text, take.images[20:24], take.times[20:24])
    with pytest.raises(DataError, match="no frame with a pose before the motion") as caught:
        track_run(load_run(late))
    assert "camera.pose" in caught.value.where


@pytest.mark.parametrize(("rows", "frames"), [(6, 4), (4, 6)])
def test_an_interrupted_run_is_tracked_as_far_as_both_files_go(
    take, packaged_text, tmp_path, rows, frames
):
    folder = write_run(tmp_path / "run", take, packaged_text, take.images[:4], take.times[:4])
    if rows > frames:
        more = "".join(f"{n},{take.times[n]:.6f},0\n" for n in range(4, rows))
        (folder / "frames.csv").write_text((folder / "frames.csv").read_text() + more)
    else:
        longer = write_run(tmp_path / "l", take, packaged_text, take.images[:6], take.times[:6])
        (longer / "video.mkv").rename(folder / "video.mkv")
    notes = []
    poses = track_run(load_run(folder), notes=notes)
    assert len(poses) == 4
    assert f"{frames} whole frames" in notes[0]
    assert f"{rows} rows" in notes[0]


def test_a_run_without_frame_times_takes_those_of_the_video(take, packaged_text, tmp_path):
    folder = write_run(tmp_path / "run", take, packaged_text, take.images[:4], take.times[:4])
    (folder / "frames.csv").unlink()
    notes = []
    poses = track_run(load_run(folder), notes=notes)
    assert poses["t_s"].to_numpy() == pytest.approx(take.times[:4], abs=6e-4)
    assert "times are those of video.mkv" in notes[0]


def test_a_run_that_shows_no_plate_is_refused(take, packaged_text, tmp_path):
    blank = [np.full((240, 240), 90, np.uint8)] * 3
    folder = write_run(tmp_path / "run", take, packaged_text, blank, take.times[:3])
    with pytest.raises(DataError, match="no marker of DICT_4X4_50 in any of 3 frames"):
        track_run(load_run(folder))


def test_a_video_of_another_size_than_the_rig_says_is_refused(take, packaged_text, tmp_path):
    cropped = [np.ascontiguousarray(image[:, :200]) for image in take.images[:2]]
    folder = write_run(tmp_path / "run", take, packaged_text, cropped, take.times[:2])
    with pytest.raises(DataError, match="200 x 240 px"):
        track_run(load_run(folder))


def test_a_run_without_video_is_refused(take, packaged_text, tmp_path):
    folder = write_run(tmp_path / "run", take, packaged_text, take.images[:1], take.times[:1])
    (folder / "video.mkv").unlink()
    with pytest.raises(DataError, match=r"no video\.mkv"):
        track_run(load_run(folder))


@pytest.mark.long
def test_a_still_run_or_the_rest_sets_zero(take, packaged, packaged_text, tmp_path):
    folder = write_run(tmp_path / "run", take, packaged_text, take.images[:30], take.times[:30])
    quiet = film(packaged, 8, motion=still, seed=9)
    zero = write_run(tmp_path / "zero", quiet, packaged_text)
    plain = track_run(load_run(folder))
    for choice, words in ((load_run(zero), "8 frames of zero"), ("rest", "8 frames at rest")):
        notes = []
        poses = track_run(load_run(folder), zero=choice, notes=notes)
        moved = (poses["pitch_deg"] - plain["pitch_deg"]).to_numpy()
        assert np.abs(moved).max() < 0.005  # the stated camera was right: little to correct
        assert np.ptp(moved) < 1e-3
        assert any(words in line for line in notes)


@pytest.mark.long
def test_a_misprinted_plate_is_found_from_the_run_itself(packaged, packaged_text, tmp_path):
    wrong = packaged_text.replace(
        "[plate.grid]", "[plate.grid]  # as printed, the gap is 0.1 mm wider"
    ).replace("gap_m = 0.01", "gap_m = 0.0101")
    assert wrong != packaged_text
    shown = film(packaged, 24)
    folder = write_run(tmp_path / "run", shown, wrong)
    notes = []
    before = track_run(load_run(folder))
    after = track_run(load_run(folder), self_calibrate=True, notes=notes)
    assert after["reproj_px"].median() < before["reproj_px"].median() / 2
    assert after["sigma_pitch_deg"].median() < before["sigma_pitch_deg"].median() / 2
    assert "plate self-calibrated from" in notes[0]


def test_corners_alone_are_a_choice(take, packaged_text, tmp_path):
    folder = write_run(tmp_path / "run", take, packaged_text, take.images[:12], take.times[:12])
    pixels = track_run(load_run(folder))
    corners = track_run(load_run(folder), refinement=Refinement.CORNERS)
    assert pixels["blur_px"].between(0.65, 0.75).all()
    assert corners["blur_px"].isna().all()
    assert pixels["sigma_pitch_deg"].median() < corners["sigma_pitch_deg"].median()
