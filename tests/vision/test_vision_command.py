"""`vision track` as a user types it."""

import json
import os
import subprocess
import sys

import pandas as pd
import pytest
from takes import write_run

from cdpr8.errors import ExitCode
from cdpr8.runfolder import load_run
from cdpr8.terminal import run_app
from vision.command import app


@pytest.fixture
def run(take, packaged_text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return write_run(tmp_path / "runs" / "today", take, packaged_text, take.images[:8], range(8))


def test_a_run_gets_its_pose_table_and_the_user_a_summary(run, capsys):
    assert run_app(app, ["track", "today"]) == ExitCode.OK
    pose = load_run(run).pose
    assert len(pose) == 8
    assert pose["pitch_deg"].notna().all()
    said = capsys.readouterr().out
    for words in ("with pose", "8 (100.0%)", "reprojection error", "sigma of pitch", "worst frame"):
        assert words in said
    assert [path.name for path in run.iterdir() if path.name.startswith(".")] == []


def test_tracking_again_replaces_the_table(run, capsys):
    assert run_app(app, ["track", "today"]) == ExitCode.OK
    assert run_app(app, ["track", "today"]) == ExitCode.OK
    assert len(load_run(run).pose) == 8


def test_json_carries_the_summary_alone(run, capsys):
    assert run_app(app, ["track", "today", "--json"]) == ExitCode.OK
    result = json.loads(capsys.readouterr().out)
    assert result["frames"] == result["frames_with_pose"] == 8
    assert 0 < result["median_sigma_pitch_deg"] < 0.01
    assert result["written"].endswith("pose.csv")
    assert set(result["flags"]) <= {"dropped_before"}


def test_out_names_another_file(run, tmp_path, capsys):
    assert run_app(app, ["track", "today", "--out", "elsewhere/p.csv"]) == ExitCode.OK
    assert len(pd.read_csv(tmp_path / "elsewhere" / "p.csv")) == 8
    assert not (run / "pose.csv").exists()


def test_a_packaged_run_is_not_written_to(run, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("cdpr8.runfolder.find.sample_data_folder", lambda: tmp_path / "runs")
    assert run_app(app, ["track", "today"]) == ExitCode.OK
    assert (tmp_path / "results" / "today" / "pose.csv").is_file()
    assert not (run / "pose.csv").exists()


def test_a_video_is_tracked_with_a_rig_file_or_refused_without(run, tmp_path, capsys):
    video = str(run / "video.mkv")
    assert run_app(app, ["track", video]) == ExitCode.USAGE
    assert "--intrinsics FILE" in capsys.readouterr().err
    assert run_app(app, ["track", video, "--rig", str(run / "rig.toml")]) == ExitCode.OK
    assert len(pd.read_csv(tmp_path / "video.pose.csv")) == 8


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["none"], ExitCode.BAD_DATA, "no run 'none'"),
        (["none.mp4"], ExitCode.BAD_DATA, "no video 'none.mp4'"),
        (["today", "--board", "b.toml"], ExitCode.USAGE, "--board with a run"),
        (["today", "--refine", "magic"], ExitCode.USAGE, "corners or photometric"),
        (
            ["junk.mp4", "--rig", "rig.toml", "--zero", "rest"],
            ExitCode.USAGE,
            "--zero with a video",
        ),
        (["today", "--zero", "none"], ExitCode.BAD_DATA, "no run 'none'"),
        (["today", "--rig", "none.toml"], ExitCode.BAD_DATA, "no rig file"),
        (["junk.mp4", "--rig", "rig.toml"], ExitCode.BAD_DATA, "not a video"),
    ],
)
def test_what_cannot_be_is_one_message(run, arguments, code, says, capsys, tmp_path):
    (tmp_path / "junk.mp4").write_text("no video")
    assert run_app(app, ["track", *arguments]) == code
    said = capsys.readouterr().err
    assert says in said
    assert "Traceback" not in said


def test_the_command_starts_without_opencv_and_numpy():
    code = (
        "import sys, vision, vision.command\n"
        "sys.exit(', '.join({'cv2', 'numpy', 'pandas', 'av', 'scipy'} & sys.modules.keys()) or 0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env=os.environ
    )
    assert done.returncode == 0, done.stderr
