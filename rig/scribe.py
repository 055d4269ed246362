"""Who writes: from the streams into the run folder, never holding a stream up.

On a virtual clock everything is written at once, so that a seed repeats a run to the byte. On a
real clock one thread writes tables and syncs them to disk every `SYNC_S`, another encodes video:
neither a slow disk nor a slow encoder stalls the bus.
"""

import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

from cdpr8.clock import Clock
from cdpr8.runfolder import EventKind, FrameFlag, RawLog, RunWriter, TableWriter
from rig.camera import Image
from rig.lines import CommandLine, Event, Line, Sample, write_line
from rig.tally import Tally

SYNC_S = 0.25
"""Tables are synced to disk this often: what a power cut can take at most."""

FLUSH_S = 0.05
"""Tables are handed to the operating system this often: what kill -9 can take at most."""

BATCH_S = 0.02
"""Lines are written in batches this often, within `FLUSH_S`."""

FRAMES_WAITING = 64
"""Frames that may wait for the encoder; beyond, frames are dropped, counted and flagged."""


class Scribe(Protocol):
    """What a stream hands its data to."""

    def sample(self, sample: Sample) -> None:
        """Take one sample."""
        ...

    def event(self, t_s: float, kind: EventKind, detail: str, cable: int | None = None) -> None:
        """Take one event."""
        ...

    def command(self, line: CommandLine) -> None:
        """Take one line of the command log."""
        ...

    def frame(self, image: Image, t_s: float, flags: int) -> None:
        """Take one frame, shape (height, width)."""
        ...

    @property
    def failure(self) -> BaseException | None:
        """What stopped the writing: a full disk, most likely; None while all is well."""
        ...

    def close(self) -> None:
        """Write what is still waiting."""
        ...


class DirectScribe:
    """Writes at once.

    Parameters
    ----------
    writer
        Of the run folder.
    tally
        Takes the count of frames and the last event.
    """

    def __init__(self, writer: RunWriter, tally: Tally) -> None:
        self._writer = writer
        self._tally = tally

    def sample(self, sample: Sample) -> None:
        """Write one sample."""
        write_line(self._writer, self._tally, sample)

    def event(self, t_s: float, kind: EventKind, detail: str, cable: int | None = None) -> None:
        """Write one event."""
        write_line(self._writer, self._tally, Event(t_s, kind, detail, cable))

    def command(self, line: CommandLine) -> None:
        """Write one line of the command log."""
        write_line(self._writer, self._tally, line)

    def frame(self, image: Image, t_s: float, flags: int) -> None:
        """Write one frame."""
        self._writer.write_frame(image, t_s, flags)
        self._tally.frames += 1

    @property
    def failure(self) -> BaseException | None:
        """None: a failure is raised where it happens."""
        return None

    def close(self) -> None:
        """Nothing waits."""


class ThreadedScribe:
    """Takes data at once and writes them on threads of its own.

    Parameters
    ----------
    writer
        Of the run folder.
    tally
        Takes the count of frames, the last event and dropped frames.
    clock
        Real.
    hurry
        Says when frames that still wait are to be given up.
    """

    def __init__(
        self, writer: RunWriter, tally: Tally, clock: Clock, hurry: Callable[[], bool]
    ) -> None:
        self._writer = writer
        self._tally = tally
        self._clock = clock
        self._lines: queue.SimpleQueue[Line | None] = queue.SimpleQueue()
        self._frames: queue.Queue[_Frame | None] = queue.Queue(FRAMES_WAITING)
        self._dropping = False
        self._hurry = hurry
        self._failure: BaseException | None = None
        self._threads = [
            threading.Thread(target=self._guard, args=(work,), name=name, daemon=True)
            for name, work in (("tables", self._write_lines), ("video", self._write_frames))
        ]
        for thread in self._threads:
            thread.start()

    def sample(self, sample: Sample) -> None:
        """Queue one sample; never waits."""
        self._lines.put(sample)

    def event(self, t_s: float, kind: EventKind, detail: str, cable: int | None = None) -> None:
        """Queue one event; never waits."""
        self._lines.put(Event(t_s, kind, detail, cable))

    def command(self, line: CommandLine) -> None:
        """Queue one line of the command log; never waits."""
        self._lines.put(line)

    def frame(self, image: Image, t_s: float, flags: int) -> None:
        """Queue one frame; where too many wait already it is dropped, counted and said."""
        if self._dropping:
            flags |= FrameFlag.DROPPED_BEFORE
        try:
            self._frames.put_nowait(_Frame(image, t_s, int(flags)))
        except queue.Full:
            self._tally.lose("frame_dropped")
            if not self._dropping:
                self.event(t_s, EventKind.FRAME_DROPPED, "the encoder cannot keep up")
            self._dropping = True
        else:
            self._dropping = False

    @property
    def failure(self) -> BaseException | None:
        """What stopped a thread."""
        return self._failure

    def close(self) -> None:
        """Write what is waiting and end the threads."""
        tables, video = self._threads
        while video.is_alive():
            try:
                self._frames.put(None, timeout=FLUSH_S)
                break
            except queue.Full:
                continue
        video.join()
        self._lines.put(None)
        tables.join()
        # A disk that was full has some room again by now: what still waits may yet be written.
        if self._failure is not None:
            with suppress(OSError):
                self._write_waiting()

    def _guard(self, work: Callable[[], None]) -> None:
        try:
            work()
        except Exception as error:  # handed to the recorder, which tells the user
            self._failure = error

    def _write_lines(self) -> None:
        writer = self._writer
        tables: list[TableWriter | RawLog] = [writer.tension, writer.events]
        tables += [each for each in (writer.command, writer.command_text) if each is not None]
        flushed_s = synced_s = self._clock.monotonic_s()
        while True:
            # In batches: to be woken for every value would take the bus its turn a thousand
            # times a second.
            time.sleep(BATCH_S)
            if self._write_waiting():
                return
            now_s = self._clock.monotonic_s()
            if now_s - synced_s >= SYNC_S:
                for table in tables:
                    table.sync()
                synced_s = flushed_s = now_s
            elif now_s - flushed_s >= FLUSH_S:
                for table in tables:
                    table.flush()
                flushed_s = now_s

    def _write_waiting(self) -> bool:
        """Write the lines that wait; True where the last of all was among them."""
        while not self._lines.empty():
            line = self._lines.get()
            if line is None:
                return True
            write_line(self._writer, self._tally, line)
        return False

    def _write_frames(self) -> None:
        synced_s = self._clock.monotonic_s()
        while (frame := self._frames.get()) is not None:
            if self._hurry():
                self._tally.lose("frame_dropped")
                continue
            self._writer.write_frame(frame.image, frame.t_s, frame.flags)
            self._tally.frames += 1
            self._writer.frames.flush()
            if self._clock.monotonic_s() - synced_s >= SYNC_S:
                self._writer.sync_frames()
                synced_s = self._clock.monotonic_s()


@dataclass(frozen=True, slots=True)
class _Frame:
    image: Image
    t_s: float
    flags: int
