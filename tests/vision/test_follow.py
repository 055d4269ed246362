"""`vision track --follow`: a run that is still being recorded."""

import threading
import time

import numpy as np
import pytest
from takes import FPS, write_run

from cdpr8.errors import DataError, ExitCode
from cdpr8.runfolder import load_run
from cdpr8.runfolder.records import StopRecord
from cdpr8.terminal import run_app
from vision.command import app
from vision.follow import follow_run
from vision.growing_video import read_growing
from vision.tracked_run import track_run


@pytest.fixture
def recorded(take, packaged_text, tmp_path):
    folder = write_run(tmp_path / "whole", take, packaged_text, take.images[:24], take.times[:24])
    anchor = load_run(folder).start.clock_anchor
    stop = StopRecord(reason="duration", t_s=1.5, samples={}, frames=24, clock_anchor=anchor)
    (folder / "stop.json").write_text(stop.model_dump_json())
    return folder


def test_frames_come_while_the_file_grows(recorded, tmp_path):
    data = (recorded / "video.mkv").read_bytes()
    path, done, most = tmp_path / "growing.mkv", threading.Event(), 3 * len(data) // 4
    enough = threading.Event()

    def record():
        with path.open("wb") as file:
            for start, end in ((0, most // 3), (most // 3, most), (most, len(data))):
                if end == len(data):
                    enough.wait(60.0)  # the rest is written once frames of the beginning came
                file.write(data[start:end])
                file.flush()
                time.sleep(0.02)
        done.set()

    writer = threading.Thread(target=record)
    writer.start()
    early, shapes = 0, []
    for image, _ in read_growing(path, done.is_set):
        early += not done.is_set()
        shapes.append(image.shape)
        if len(shapes) > 4:
            enough.set()
    writer.join()
    assert shapes == [(240, 240)] * 24
    assert early > 4, "frames must come before the recording is over"


@pytest.mark.long
def test_following_gives_the_table_of_tracking(recorded, take):
    live = []
    poses = follow_run(recorded, show=live.append, patience_s=0.5)
    after = track_run(load_run(recorded))
    assert poses["pitch_deg"].to_numpy() == pytest.approx(after["pitch_deg"].to_numpy(), abs=1e-9)
    assert [one.frame for one in live] == list(range(24))
    truth = np.rad2deg(take.truth[:24, 4])
    shown = [np.rad2deg(one.pose.values[4]) for one in live]
    assert shown == pytest.approx(truth, abs=0.01)
    assert "pitch" in live[0].sentence()


def test_a_recording_that_died_ends_the_following(recorded):
    (recorded / "stop.json").unlink()
    assert len(follow_run(recorded, patience_s=0.3)) == 24


def test_a_run_without_frames_is_told(recorded):
    (recorded / "video.mkv").unlink()
    with pytest.raises(DataError, match=r"no video\.mkv"):
        follow_run(recorded, patience_s=0.2)


def test_the_command_shows_pitch_as_it_comes(recorded, monkeypatch, capsys):
    monkeypatch.chdir(recorded.parent)
    assert run_app(app, ["track", "whole", "--follow"]) == ExitCode.OK
    said = capsys.readouterr().out
    assert said.count("pitch ") >= 24
    assert len(load_run(recorded).pose) == 24
    assert run_app(app, ["track", "whole", "--follow", "--zero", "rest"]) == ExitCode.USAGE


# Real time depends on the machine: with the other timings, not with what must always pass.
@pytest.mark.slow
def test_following_keeps_up_with_the_camera(recorded):
    start = time.process_time()
    follow_run(recorded, patience_s=0.3)
    assert time.process_time() - start < 24 / FPS
