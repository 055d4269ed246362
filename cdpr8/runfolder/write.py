"""Writing a run folder: append-only tables that are valid when cut at any byte."""

import json
import math
import os
from collections.abc import Mapping
from contextlib import ExitStack
from io import BufferedWriter, TextIOWrapper
from pathlib import Path
from typing import Self

from pydantic import BaseModel

from cdpr8.errors import DataError
from cdpr8.runfolder.records import StartRecord, StopRecord
from cdpr8.runfolder.tables import COMMAND, EVENTS, FRAMES, TENSION, EventKind, Table
from cdpr8.runfolder.video import Image, VideoWriter

Cell = float | int | str | None


class TableWriter:
    """Appends rows to one CSV table; a row is written whole, in one call.

    Parameters
    ----------
    folder
        The run folder.
    table
        Which table; its header is written at once.
    """

    def __init__(self, folder: Path, table: Table) -> None:
        # How a number with a fixed number of digits is formatted, by column.
        self._columns = tuple(
            (column.name, "" if column.digits is None else f".{column.digits}f")
            for column in table.columns
        )
        self._file: TextIOWrapper = (folder / table.file).open("x", encoding="utf-8", newline="")
        self._file.write(",".join(table.names) + "\n")

    def append(self, row: Mapping[str, Cell]) -> None:
        """Write one row; columns left out stay empty."""
        cells = [_spell(row.get(name), form) for name, form in self._columns]
        self._file.write(",".join(cells) + "\n")

    def sync(self) -> None:
        """Hand everything to the disk."""
        self._file.flush()
        os.fsync(self._file.fileno())

    def flush(self) -> None:
        """Hand everything to the operating system: it survives the death of this process."""
        self._file.flush()

    def close(self) -> None:
        """Sync and close; a second time does nothing."""
        if not self._file.closed:
            self.sync()
            self._file.close()


class RawLog:
    """Keeps the lines of another program as they came, each after its time of arrival and a tab.

    Parameters
    ----------
    path
        The file; must not exist.
    """

    def __init__(self, path: Path) -> None:
        self._file: BufferedWriter = path.open("xb")

    def append(self, arrived_s: float, line: bytes) -> None:
        """Keep one line, given without its end."""
        self._file.write(f"{arrived_s:.6f}\t".encode("ascii") + line + b"\n")

    def sync(self) -> None:
        """Hand everything to the disk."""
        self._file.flush()
        os.fsync(self._file.fileno())

    def flush(self) -> None:
        """Hand everything to the operating system."""
        self._file.flush()

    def close(self) -> None:
        """Sync and close; a second time does nothing."""
        if not self._file.closed:
            self.sync()
            self._file.close()


class RunWriter:
    """Writes one run folder (design, section 3).

    Parameters
    ----------
    folder
        Where; must not exist or be empty.
    start
        Written and synced to disk before this returns.
    rig_text
        The rig file as it was.
    beside_rig
        Files that the rig file names (`cdpr8.rigfile.files_beside`), so that the run stands alone.

    Raises
    ------
    DataError
        The folder holds something already, or cannot be written.
    """

    def __init__(
        self,
        folder: Path,
        start: StartRecord,
        rig_text: str,
        beside_rig: Mapping[str, bytes] | None = None,
    ) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if any(folder.iterdir()):
                raise DataError(
                    "the run folder is not empty; nothing recorded is ever overwritten",
                    where=str(folder),
                    remedy="choose another name",
                )
            self.folder = folder
            for name, content in (beside_rig or {}).items():
                (folder / name).write_bytes(content)
            _write_synced(folder / "rig.toml", rig_text)
            self.tension = TableWriter(folder, TENSION)
            self.frames = TableWriter(folder, FRAMES)
            self.events = TableWriter(folder, EVENTS)
            self.command: TableWriter | None = None
            self.command_text: RawLog | None = None
            if start.command_log is not None:
                self.command = TableWriter(folder, COMMAND)
                if start.import_map is None:  # imported lines never arrived
                    self.command_text = RawLog(folder / "command.txt")
            self._video = _video(folder, start)
            # What start.json makes a run of is there before it, whatever happens next.
            for table in self.tables:
                table.sync()
            _write_synced(folder / "start.json", _as_json(start))
        except OSError as error:
            raise DataError(
                f"the run folder cannot be written: {error.strerror}",
                where=str(folder),
                remedy="choose a folder you may write to, on a disk with room",
            ) from None
        self._frame_count = 0

    @property
    def tables(self) -> tuple["TableWriter | RawLog", ...]:
        """Everything that lines are appended to."""
        every = (self.tension, self.events, self.frames, self.command, self.command_text)
        return tuple(table for table in every if table is not None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def write_frame(self, image: Image, t_s: float, flags: int = 0) -> None:
        """Append one frame, shape (height, width), and its row."""
        if self._video is None:
            raise ValueError("start.json names no camera, so this run has no video")
        self._video.write(image, t_s)
        self.frames.append({"frame": self._frame_count, "t_s": t_s, "flags": flags})
        self._frame_count += 1

    def sync_frames(self) -> None:
        """Hand the video and its times to the disk."""
        if self._video is not None:
            self._video.sync()
        self.frames.sync()

    def event(self, t_s: float, kind: EventKind, detail: str, cable: int | None = None) -> None:
        """Append one event; it is handed to the operating system at once."""
        self.events.append({"t_s": t_s, "kind": kind.value, "cable": cable, "detail": detail})
        self.events.flush()

    def stop(self, record: StopRecord) -> None:
        """Close every file and say how the run ended, even where a file cannot be closed.

        Raises
        ------
        OSError
            A file could not be closed; the stop record is written all the same.
        """
        try:
            self.close()
        finally:
            _write_synced(self.folder / "stop.json", _as_json(record))

    def close(self) -> None:
        """Close every file; without `stop` the run stays marked as interrupted.

        Raises
        ------
        OSError
            A file could not be closed; the others are, all the same. A video that once met a full
            disk raises it again here, whatever room there is by now.
        """
        video, self._video = self._video, None
        with ExitStack() as stack:
            for each in reversed(self.tables):
                stack.callback(each.close)
            if video is not None:
                stack.callback(video.close)


def _video(folder: Path, start: StartRecord) -> VideoWriter | None:
    camera = start.camera
    if camera is None:
        return None
    return VideoWriter(folder / "video.mkv", camera.width_px, camera.height_px, camera.fps)


def _spell(value: Cell, form: str) -> str:
    if isinstance(value, float):
        if math.isnan(value):
            return ""
        return format(value, form) if form else repr(value)
    if isinstance(value, int):
        return str(value)
    if value is None:
        return ""
    text = str(value)
    if any(mark in text for mark in ',"\n\r'):
        return '"' + text.replace('"', '""').replace("\n", " ").replace("\r", " ") + '"'
    return text


def _as_json(record: BaseModel) -> str:
    return json.dumps(record.model_dump(mode="json"), indent=1) + "\n"


def _write_synced(path: Path, text: str) -> None:
    """Write a small file so that after a crash it is there whole or not at all."""
    part = path.with_suffix(path.suffix + ".part")
    with part.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    part.rename(path)
    descriptor = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
