"""The camera: one small interface, and real cameras and video files behind it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cdpr8.clock import Clock
from cdpr8.errors import DeviceError
from cdpr8.rigfile import schema
from rig.dropped_frames import DropCounter
from rig.exposure_units import EXPOSURE_UNITS

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Frame:
    """One exposure.

    Attributes
    ----------
    image
        Grey levels, shape (height_px, width_px).
    t_mid_s
        Middle of the exposure, on the camera's clock.
    dropped_before
        Exposures lost since the previous frame.
    """

    image: Image
    t_mid_s: float
    dropped_before: int = 0


class Camera(Protocol):
    """What the recorder needs of a camera."""

    @property
    def source(self) -> str:
        """What a user calls it."""
        ...

    @property
    def width_px(self) -> int:
        """Columns of a frame."""
        ...

    @property
    def height_px(self) -> int:
        """Rows of a frame."""
        ...

    @property
    def fps(self) -> float:
        """Nominal frames per second."""
        ...

    @property
    def exposure_s(self) -> float:
        """Exposure as read back."""
        ...

    @property
    def clock(self) -> Clock:
        """The clock of the frames' times."""
        ...

    @property
    def next_frame_s(self) -> float:
        """When the next exposure is expected to be over."""
        ...

    def start(self, origin_s: float) -> None:
        """Begin to expose; the first exposure starts at `origin_s` or as soon as it can."""
        ...

    def next_frame(self) -> Frame | None:
        """Wait for the next frame; None where the camera gives none any more."""
        ...

    def close(self) -> None:
        """Give the camera back."""
        ...


class CaptureCamera:
    """A camera or a video file through OpenCV.

    A frame is stamped by the driver where that keeps the host's monotonic clock (V4L2 does), else
    when it arrives; the middle of its exposure lies half an exposure earlier (the transfer, some
    milliseconds, stays in as the camera's latency). Frames lost are counted from the stamps: a
    step of about n periods hides n - 1 frames. A frame that merely came late is followed by one
    that comes early, and the two together take two periods.

    Parameters
    ----------
    camera
        As the rig file has it.
    clock
        Stamps the frames.

    Raises
    ------
    DeviceError
        There is no such camera, or it cannot give frames of the intrinsics' size.
    """

    def __init__(self, camera: schema.Camera, clock: Clock) -> None:
        import cv2

        self._cv2 = cv2
        self._clock = clock
        self.source = camera.source
        self._is_device = camera.source.isdecimal() or _is_character_device(camera.source)
        self.fps, self.exposure_s = camera.fps, camera.exposure_s
        self._capture = self._open(camera)
        size = self._set(camera)
        region = camera.region_of_interest
        self._window = (
            (slice(None), slice(None))
            if region is None
            else (
                slice(region.y_px, region.y_px + region.height_px),
                slice(region.x_px, region.x_px + region.width_px),
            )
        )
        self.width_px = size[0] if region is None else region.width_px
        self.height_px = size[1] if region is None else region.height_px
        self._last_mid_s: float | None = None
        self._drops = DropCounter(camera.fps)
        self._start_s = 0.0
        self._count = 0

    @property
    def clock(self) -> Clock:
        """The host's clock."""
        return self._clock

    @property
    def next_frame_s(self) -> float:
        """One frame period after the last frame."""
        if self._last_mid_s is None:
            return self._clock.monotonic_s()
        return self._last_mid_s + 1.0 / self.fps

    def start(self, origin_s: float) -> None:
        """Throw away what was exposed before."""
        self._start_s = origin_s
        self._clock.sleep_until(origin_s)
        if self._is_device:
            self._capture.grab()

    def next_frame(self) -> Frame | None:
        """Wait for the next frame; None at a file's end or when the camera is gone."""
        if not self._is_device:
            # A file plays at the rig file's rate.
            self._clock.sleep_until(self._start_s + self._count / self.fps + self.exposure_s)
        if not self._capture.grab():
            return None
        t_mid_s = self._stamp_s(self._clock.monotonic_s()) - self.exposure_s / 2.0
        ok, image = self._capture.retrieve()
        if not ok:
            return None
        if image.ndim == 3:
            image = self._cv2.cvtColor(image, self._cv2.COLOR_BGR2GRAY)
        dropped = self._drops.before(t_mid_s) if self._is_device else 0
        self._last_mid_s = t_mid_s
        self._count += 1
        return Frame(np.ascontiguousarray(image[self._window]), t_mid_s, dropped)

    def close(self) -> None:
        """Give the camera back."""
        self._capture.release()

    def _stamp_s(self, arrived_s: float) -> float:
        """The driver's time of the frame, where it is one of this clock; else its arrival."""
        if not self._is_device:
            return arrived_s
        stamp_s = float(self._capture.get(self._cv2.CAP_PROP_POS_MSEC)) * 1e-3
        return stamp_s if 0.0 <= arrived_s - stamp_s < MOST_TRANSFER_S else arrived_s

    def _open(self, camera: schema.Camera) -> Any:
        if not self._is_device and not Path(camera.source).exists():
            raise DeviceError(
                f"no camera or video {camera.source!r}",
                allowed="a device number such as 0, a device, or a video file",
                remedy="set [camera] source in the rig file, or try --simulated",
            )
        source = int(camera.source) if camera.source.isdecimal() else camera.source
        level = self._cv2.utils.logging.getLogLevel()
        self._cv2.utils.logging.setLogLevel(self._cv2.utils.logging.LOG_LEVEL_SILENT)
        try:
            capture = self._cv2.VideoCapture(source)
        finally:
            self._cv2.utils.logging.setLogLevel(level)
        if not capture.isOpened():
            raise DeviceError(
                f"camera {camera.source!r} cannot be opened",
                remedy="check that it is connected and that no other program uses it",
            )
        return capture

    def _set(self, camera: schema.Camera) -> tuple[int, int]:
        """Set size, rate and exposure; return the size read back, as (width, height)."""
        cv2 = self._cv2
        wanted = camera.intrinsics
        if isinstance(wanted, str):
            raise TypeError("intrinsics are read into the rig by load_rig")
        if self._is_device:
            self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, wanted.width_px)
            self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, wanted.height_px)
            self._capture.set(cv2.CAP_PROP_FPS, camera.fps)
            self._capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
            self._set_exposure(camera.exposure_s)
        size = (
            int(self._capture.get(cv2.CAP_PROP_FRAME_WIDTH)),
            int(self._capture.get(cv2.CAP_PROP_FRAME_HEIGHT)),
        )
        if size != (wanted.width_px, wanted.height_px):
            self._capture.release()
            raise DeviceError(
                f"camera {camera.source!r} gives {size[0]} x {size[1]} px",
                allowed=f"{wanted.width_px} x {wanted.height_px} px, the size of its intrinsics",
                remedy="calibrate the camera at the size it gives",
            )
        return size

    def _set_exposure(self, exposure_s: float) -> None:
        """Set the exposure by hand and read it back; each system counts in units of its own."""
        units = EXPOSURE_UNITS.get(self._capture.getBackendName())
        if units is None:
            return
        cv2 = self._cv2
        self._capture.set(cv2.CAP_PROP_AUTO_EXPOSURE, units.manual)
        self._capture.set(cv2.CAP_PROP_EXPOSURE, units.spell(exposure_s))
        answered = float(self._capture.get(cv2.CAP_PROP_EXPOSURE))
        if (read_s := units.read_s(answered)) is not None:
            self.exposure_s = read_s


MOST_TRANSFER_S = 1.0
"""A driver's stamp older than this is of another clock."""


def _is_character_device(source: str) -> bool:
    try:
        return Path(source).is_char_device()
    except OSError:
        return False
