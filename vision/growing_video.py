"""A video that is still being written, frame by frame as it grows."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError

Image = NDArray[np.uint8]

POLL_S = 0.03
PATIENCE_S = 15.0
"""A file that has not grown for so long will not: its writer is gone."""


class _GrowingFile:
    """A file whose end is waited at, until its writer has finished."""

    def __init__(
        self,
        path: Path,
        finished: Callable[[], bool],
        patience_s: float,
        clock: Callable[[], float],
        sleep: Callable[[float], None],
    ) -> None:
        self._file = path.open("rb")
        self._finished = finished
        self._patience_s = patience_s
        self._clock = clock
        self._sleep = sleep

    def read(self, size: int) -> bytes:
        """Up to so many bytes; none only where the file is complete."""
        since = self._clock()
        while True:
            over = self._finished()  # asked before reading: what came before the end is read
            if data := self._file.read(size):
                return data
            if over or self._clock() - since > self._patience_s:
                return b""
            self._sleep(POLL_S)

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


def read_growing(
    path: Path,
    finished: Callable[[], bool],
    *,
    patience_s: float = PATIENCE_S,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Iterator[tuple[Image, float | None]]:
    """Frames of a Matroska video that is still being recorded.

    Parameters
    ----------
    path
        The file; it may not exist yet.
    finished
        Whether its writer is done.
    patience_s
        How long to wait for more of a file whose writer does not say that it is done.
    clock, sleep
        Time and waiting.

    Yields
    ------
    image
        Shape (height, width).
    t_s
        Presentation time, s; None where the container has none.

    Raises
    ------
    DataError
        No video came, or it is none.
    """
    import av

    since = clock()
    while not path.is_file() or path.stat().st_size == 0:
        if finished() or clock() - since > patience_s:
            raise DataError(
                f"no {path.name} came within {patience_s:g} s",
                where=str(path.parent),
                remedy="is the run recorded with a camera?",
            )
        sleep(POLL_S)
    growing = _GrowingFile(path, finished, patience_s, clock, sleep)
    count = 0
    try:
        with av.open(growing, format="matroska") as container:
            stream = container.streams.video[0]
            stream.codec_context.thread_count = 1  # frame threads would hold frames back
            for frame in container.decode(stream):
                count += 1
                t_s = None if frame.pts is None or frame.time_base is None else float(frame.time)
                yield frame.to_ndarray(format="gray").astype(np.uint8, copy=False), t_s
    except (av.FFmpegError, IndexError, OSError, ValueError) as error:
        if count == 0:
            raise DataError(f"is not a video that can be read: {error}", where=str(path)) from None
    finally:
        growing.close()
