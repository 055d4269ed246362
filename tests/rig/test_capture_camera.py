"""Cameras and video files behind the small interface (files, and a stand-in for a device)."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from rig_stand_ins import rig_text, virtual_clock

from cdpr8.clock import VirtualClock
from cdpr8.errors import DeviceError
from cdpr8.rigfile import Rig
from cdpr8.rigfile.schema import Camera, Intrinsics, RegionOfInterest
from cdpr8.runfolder import (
    CameraStart,
    ClockAnchor,
    FrameFlag,
    RunWriter,
    StartRecord,
    VideoWriter,
    load_run,
    read_video,
)
from rig.camera import CaptureCamera, Frame
from rig.scribe import DirectScribe
from rig.streams import CameraStream, Span
from rig.tally import Tally


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


PERIOD_S = 0.1
STAMP, EXPOSURE, AUTO = cv2.CAP_PROP_POS_MSEC, cv2.CAP_PROP_EXPOSURE, cv2.CAP_PROP_AUTO_EXPOSURE


class StandIn:
    """A capture device as OpenCV shows one, on a virtual clock.

    Frames are given as (time of the driver's stamp, grey level); each arrives 30 ms later.
    """

    def __init__(
        self,
        clock: VirtualClock,
        frames: list[tuple[float, int]],
        backend: str = "V4L2",
        stamps: bool = True,
        shortest: float = 0.0,
    ) -> None:
        self.clock, self.frames, self.backend, self.stamps = clock, list(frames), backend, stamps
        self.shortest = shortest
        self.values: dict[int, float] = {}
        self.level = 0

    def isOpened(self) -> bool:  # noqa: N802
        return True

    def getBackendName(self) -> str:  # noqa: N802
        return self.backend

    def set(self, key: int, value: float) -> bool:
        self.values[key] = max(value, self.shortest) if key == EXPOSURE else value
        return True

    def get(self, key: int) -> float:
        return self.values.get(key, 0.0)

    def grab(self) -> bool:
        if not self.frames:
            return False
        stamp_s, self.level = self.frames.pop(0)
        self.clock.sleep_until(stamp_s + 0.03)
        self.values[STAMP] = 1e3 * stamp_s if self.stamps else 0.0
        return True

    def retrieve(self) -> tuple[bool, np.ndarray]:
        return True, np.full((48, 64, 3), self.level, np.uint8)

    def release(self) -> None: ...


def opened(
    monkeypatch: pytest.MonkeyPatch, device: StandIn, exposure_s: float = 0.005
) -> CaptureCamera:
    monkeypatch.setattr(cv2, "VideoCapture", lambda source: device)
    asked = camera("0").model_copy(update={"exposure_s": exposure_s})
    found = CaptureCamera(asked, device.clock)
    found.start(0.0)
    return found


def taken(found: CaptureCamera) -> list[Frame]:
    frames = []
    while (frame := found.next_frame()) is not None:
        frames.append(frame)
    return frames


def film(steps: list[float]) -> list[tuple[float, int]]:
    """Frames at these steps, in periods; the first is thrown away at the start."""
    times = 1.0 + PERIOD_S * np.cumsum([0.0, 1.0, *steps])
    return [(float(t_s), 10 + number) for number, t_s in enumerate(times)]


def test_a_devices_frames_are_stamped_by_its_driver(monkeypatch: pytest.MonkeyPatch) -> None:
    frames = taken(opened(monkeypatch, StandIn(virtual_clock(), film([1.0, 1.0]))))
    assert [each.t_mid_s for each in frames] == pytest.approx([1.0975, 1.1975, 1.2975])
    assert [int(each.image[0, 0]) for each in frames] == [11, 12, 13]


@pytest.mark.parametrize("stamps_of_another_clock", [False, True])
def test_without_a_stamp_of_this_clock_it_is_the_arrival(
    monkeypatch: pytest.MonkeyPatch, stamps_of_another_clock: bool
) -> None:
    device = StandIn(virtual_clock(), film([1.0]), stamps=False)
    if stamps_of_another_clock:
        device.get = lambda key: 7.7e9 if key == STAMP else device.values.get(key, 0.0)
    frames = taken(opened(monkeypatch, device))
    assert [each.t_mid_s for each in frames] == pytest.approx([1.1275, 1.2275])


@pytest.mark.parametrize(
    ("backend", "asked_s", "shortest", "spelled", "read_s"),
    [
        ("V4L2", 0.005, 0.0, 50.0, 0.005),
        ("V4L2", 0.0001, 3.0, 3.0, 0.0003),  # the camera can do no less
        ("DSHOW", 0.005, -20.0, -8.0, 1 / 256),
        ("MSMF", 0.03, -20.0, -5.0, 1 / 32),
        ("AVFOUNDATION", 0.005, 0.0, None, 0.005),
    ],
)
def test_the_exposure_is_set_by_hand_and_read_back(
    monkeypatch: pytest.MonkeyPatch,
    backend: str,
    asked_s: float,
    shortest: float,
    spelled: float | None,
    read_s: float,
) -> None:
    device = StandIn(virtual_clock(), film([]), backend, shortest=shortest)
    found = opened(monkeypatch, device, asked_s)
    assert device.values.get(EXPOSURE) == spelled
    assert (AUTO in device.values) is (spelled is not None)
    assert found.exposure_s == pytest.approx(read_s)


@pytest.mark.parametrize(
    ("steps", "dropped"),
    [
        ([1.0] * 10, [0] * 11),
        ([1.0, 1.0, 2.0, 1.0], [0, 0, 0, 1, 0]),
        ([1.0, 4.0, 1.0], [0, 0, 3, 0]),
        ([1.0, 1.4, 0.6, 1.0], [0] * 5),  # one came late
        ([1.04] * 60, [0] * 61),  # a camera of 9.6 instead of 10 frames a second
        ([0.96] * 60, [0] * 61),
        ([1.0, 2.1, 0.9, 2.0, 1.0], [0, 0, 1, 0, 1, 0]),
    ],
)
def test_dropped_frames_are_counted_from_the_stamps(
    monkeypatch: pytest.MonkeyPatch, steps: list[float], dropped: list[int]
) -> None:
    frames = taken(opened(monkeypatch, StandIn(virtual_clock(), film(steps))))
    assert [each.dropped_before for each in frames] == dropped


def test_dropped_and_repeated_frames_are_flagged_and_times_kept_in_the_video(
    monkeypatch: pytest.MonkeyPatch, rig: Rig, tmp_path: Path
) -> None:
    clock = virtual_clock()
    steps = [1.0, 1.03, 2.0, 0.98, 1.0, 1.0]
    frames = film(steps)
    frames[4] = (frames[4][0], frames[3][1])  # the same picture twice
    found = opened(monkeypatch, StandIn(clock, frames))
    start = CameraStart(source="0", fps=10.0, exposure_s=0.005, width_px=64, height_px=48)
    record = StartRecord(
        id="test",
        simulated=False,
        rig_file="rig.toml",
        rig_sha256="0" * 64,
        excitation=rig.excitation,
        motion_start_known=False,
        camera=start,
        clock_anchor=ClockAnchor(t_s=0.0, wall=clock.wall()),
    )
    writer, tally = RunWriter(tmp_path / "run", record, rig_text()), Tally()
    stream = CameraStream(found, DirectScribe(writer, tally), tally, Span(1.0, 9.0))
    while stream.step():
        pass
    writer.close()
    run = load_run(tmp_path / "run")
    assert tally.lost == {"frame_dropped": 1, "frame_repeated": 1, "camera_lost": 1}
    flags = run.frames["flags"].tolist()
    assert flags == [0, 0, 0, FrameFlag.DROPPED_BEFORE | FrameFlag.REPEATED, 0, 0, 0]
    said = run.events[run.events["kind"] == "frame_dropped"]
    assert said["detail"].tolist() == ["1 before this frame"]
    # Variable frame rate: each picture carries its own time, to Matroska's millisecond.
    expected = PERIOD_S * np.cumsum([1.0, *steps]) - 0.0025
    assert run.frames["t_s"].to_numpy() == pytest.approx(expected)
    assert [t_s for _, t_s in read_video(run.video)] == pytest.approx(expected, abs=6e-4)


def test_a_device_by_its_path_is_a_device(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    opened_: list[object] = []
    device = StandIn(virtual_clock(), film([]))
    monkeypatch.setattr(cv2, "VideoCapture", lambda source: opened_.append(source) or device)
    found = CaptureCamera(camera("/dev/null"), device.clock)  # a character device, as /dev/video0
    assert opened_ == ["/dev/null"]
    assert found._is_device
