"""Real cameras and video files behind the small interface (here: files)."""

import numpy as np
import pytest
from rig_stand_ins import virtual_clock

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Camera, Intrinsics, RegionOfInterest
from cdpr8.runfolder import VideoWriter
from rig.camera import CaptureCamera


def camera(source: str, width_px: int = 64, region: RegionOfInterest | None = None) -> Camera:
    intrinsics = Intrinsics(width_px=width_px, height_px=48, fx_px=80, fy_px=80, cx_px=32, cy_px=24)
    return Camera(source=source, fps=10.0, intrinsics=intrinsics, region_of_interest=region)


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("video") / "film.mkv"
    writer = VideoWriter(path, 64, 48, 10.0)
    for number in range(5):
        image = np.full((48, 64), 40 * number, np.uint8)
        image[10:20, 30:50] = 255
        writer.write(image, number / 10)
    writer.close()
    return str(path)


def test_a_file_plays_at_the_rig_files_rate_and_ends(video: str) -> None:
    clock = virtual_clock()
    opened = CaptureCamera(camera(video), clock)
    opened.start(1.0)
    frames = []
    while (frame := opened.next_frame()) is not None:
        frames.append(frame)
    assert [int(frame.image[0, 0]) for frame in frames] == [0, 40, 80, 120, 160]
    # Mid-exposure: half an exposure after its start.
    assert [frame.t_mid_s for frame in frames] == pytest.approx(1.0025 + np.arange(5) / 10)
    opened.close()


def test_only_the_region_of_interest_is_handed_on(video: str) -> None:
    region = RegionOfInterest(x_px=30, y_px=10, width_px=20, height_px=10)
    opened = CaptureCamera(camera(video, region=region), virtual_clock())
    opened.start(0.0)
    frame = opened.next_frame()
    assert frame is not None
    assert frame.image.shape == (opened.height_px, opened.width_px) == (10, 20)
    assert (frame.image == 255).all()


def test_a_size_other_than_the_intrinsics_is_refused(video: str) -> None:
    with pytest.raises(DeviceError, match="gives 64 x 48 px"):
        CaptureCamera(camera(video, width_px=640), virtual_clock())


@pytest.mark.parametrize("source", ["no-such-film.mkv", "97"])
def test_a_camera_that_is_not_there_is_told(source: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(DeviceError, match=source):
        CaptureCamera(camera(source), virtual_clock())
    assert capfd.readouterr().err == ""  # the library's own chatter is kept away
