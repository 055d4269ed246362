"""video.mkv: lossless grey frames (FFV1 in Matroska), written as they come and read back."""

import os
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError

Image = NDArray[np.uint8]

_TICK = Fraction(1, 1000)
"""Matroska's own resolution; the exact times stand in frames.csv."""


class VideoWriter:
    """Appends grey frames to a Matroska file that is readable up to its last whole cluster.

    Parameters
    ----------
    path
        The file; overwritten.
    width, height
        Frame size in px.
    fps
        Nominal rate; each frame carries its own time.
    """

    def __init__(self, path: Path, width: int, height: int, fps: float) -> None:
        import av

        self._path = path

        # Reproducible bytes: no random segment id, no library version in the header. Clusters of
        # a quarter of a second, flushed as written, bound what a cut can take.
        self._container = av.open(
            str(path),
            "w",
            format="matroska",
            options={"fflags": "+bitexact", "flush_packets": "1", "cluster_time_limit": "250"},
        )
        stream = self._container.add_stream("ffv1", rate=Fraction(fps).limit_denominator(1000))
        stream.width, stream.height, stream.pix_fmt = width, height, "gray"
        stream.time_base = _TICK
        stream.codec_context.time_base = _TICK
        stream.codec_context.options = {"level": "3", "slicecrc": "1", "flags": "+bitexact"}
        stream.codec_context.thread_count = 1
        self._stream = stream
        self._last_tick = -1

    def write(self, image: Image, t_s: float) -> None:
        """Append one frame, shape (height, width), taken at `t_s`."""
        import av

        frame = av.VideoFrame.from_ndarray(image, format="gray")
        # Two frames inside one tick would be refused; the exact times stand in frames.csv.
        self._last_tick = max(self._last_tick + 1, round(t_s / _TICK))
        frame.pts, frame.time_base = self._last_tick, _TICK
        for packet in self._stream.encode(frame):
            self._container.mux(packet)

    def sync(self) -> None:
        """Hand all whole clusters to the disk: they have left this process as they were made."""
        descriptor = os.open(self._path, os.O_RDWR)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

    def close(self) -> None:
        """Write what the encoder still holds and the index."""
        try:
            for packet in self._stream.encode(None):
                self._container.mux(packet)
        finally:
            self._container.close()


def read_video(path: Path) -> Iterator[tuple[Image, float | None]]:
    """Frames of any video as grey images with their presentation times.

    Parameters
    ----------
    path
        A file that FFmpeg reads; one cut short yields its whole frames.

    Yields
    ------
    image
        Shape (height, width).
    t_s
        Presentation time in s, None where the container has none.

    Raises
    ------
    DataError
        The file is missing, is no video, or holds no frame.
    """
    import av

    if not path.is_file():
        raise DataError(f"no video {str(path)!r}")
    try:
        container = av.open(str(path))
    except (av.FFmpegError, OSError, ValueError) as error:
        raise _not_a_video(path, error) from None
    with container:
        if not container.streams.video:
            raise _not_a_video(path, "no video stream")
        count = 0
        try:
            for frame in container.decode(container.streams.video[0]):
                count += 1
                time = None if frame.pts is None or frame.time_base is None else float(frame.time)
                # Rows without gaps: code compiled for such pictures is not compiled for others.
                yield np.ascontiguousarray(frame.to_ndarray(format="gray"), dtype=np.uint8), time
        except av.FFmpegError as error:
            if count == 0:
                raise _not_a_video(path, error) from None
        if count == 0:
            raise _not_a_video(path, "no frame")


def _not_a_video(path: Path, reason: object) -> DataError:
    return DataError(
        f"is not a video that can be read: {getattr(reason, 'strerror', None) or reason}",
        where=str(path),
        allowed="any video that FFmpeg decodes, with at least one whole frame",
        remedy="check the file name; a recording cut short stays readable up to its last cluster",
    )
