"""Reading a run folder: every run loads, whatever cut it short, and what is missing is said."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from cdpr8.errors import DataError
from cdpr8.rigfile.load import load_rig
from cdpr8.rigfile.schema import Rig
from cdpr8.runfolder.records import StartRecord, StopRecord
from cdpr8.runfolder.tables import (
    BAD_TENSION,
    COMMAND,
    EVENTS,
    FRAMES,
    POSE,
    SCHEMA_VERSION,
    TENSION,
    Table,
)

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Run:
    """One recorded run.

    Attributes
    ----------
    folder
        Where it was read from.
    start, stop
        The records; `stop` is None where the run was interrupted.
    rig
        The rig file as it was.
    tension, frames, events
        The tables as data frames, with the columns of `cdpr8.runfolder.tables`.
    pose
        The same, None until `vision track` has run.
    notes
        What a user must know: torn lines, a missing stop record, and so on.
    command
        The winch controller's log as a data frame, None where the run has none.
    """

    folder: Path
    start: StartRecord
    stop: StopRecord | None
    rig: Rig
    tension: "pd.DataFrame"
    frames: "pd.DataFrame"
    events: "pd.DataFrame"
    pose: "pd.DataFrame | None"
    notes: tuple[str, ...]
    command: "pd.DataFrame | None" = None

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.resolve().name

    @property
    def video(self) -> Path | None:
        """The video, None where the run has none."""
        path = self.folder / "video.mkv"
        return path if path.is_file() else None

    def filter_delay_s(self, cable: int) -> float:
        """How much later a cable's amplifier gives a tension than it was, as far as is known."""
        stated = (node.filter_delay_s for node in self.start.nodes if node.cable == cable)
        return next(stated, None) or 0.0

    def cable_tension(self, cable: int) -> "pd.DataFrame":
        """Good samples of one cable (1 to 8), in order of time; its filter's delay is taken off."""
        rows = self.tension["cable"] == cable
        rows &= (self.tension["status"].to_numpy() & int(BAD_TENSION)) == 0
        rows &= self.tension["tension_n"].notna()
        good: pd.DataFrame = self.tension[rows]
        good = good.assign(t_s=good["t_s"] - self.filter_delay_s(cable))
        return good.sort_values("t_s", kind="stable").reset_index(drop=True)


def load_run(folder: str | Path) -> Run:
    """Read a run folder.

    Parameters
    ----------
    folder
        A folder as `rig record` or any program that follows docs/run-folder.md writes it.

    Raises
    ------
    DataError
        The folder is no run, or a file of it is damaged beyond a torn last line.
    RigFileError
        The run's rig.toml is wrong.
    """
    folder = Path(folder)
    notes: list[str] = []
    start = _read_start(folder)
    stop = _read_stop(folder, notes)
    rig_path = folder / "rig.toml"
    if not rig_path.is_file():
        raise DataError(
            "the run has no rig.toml",
            where=str(folder),
            remedy="copy the rig file of the machine into the run folder",
        )
    return Run(
        folder=folder,
        start=start,
        stop=stop,
        rig=load_rig(rig_path),
        tension=read_table(folder / TENSION.file, TENSION, notes),
        frames=_or_empty(folder, FRAMES, notes),
        events=_or_empty(folder, EVENTS, notes),
        pose=_or_none(folder, POSE, notes),
        command=_or_none(folder, COMMAND, notes),
        notes=tuple(notes),
    )


def read_table(path: Path, table: Table, notes: list[str]) -> "pd.DataFrame":
    """Read one CSV table; a torn last line is dropped and noted.

    Parameters
    ----------
    path
        The file.
    table
        Its definition; columns it has beyond these are kept, optional ones may be absent.
    notes
        Takes what a user must know.

    Raises
    ------
    DataError
        The file is missing, lacks a column, or holds a cell that is not what it must be.
    """
    import pandas as pd

    try:
        data = path.read_bytes()
    except OSError as error:
        raise DataError(
            f"{table.file} cannot be read: {error.strerror}", where=str(path.parent)
        ) from None
    whole = data[: data.rfind(b"\n") + 1]
    if len(whole) < len(data):
        line = whole.count(b"\n") + 1
        notes.append(
            f"{path.name}: torn last line dropped (line {line}, {len(data) - len(whole)} bytes)"
        )
    if not whole:
        return pd.DataFrame({name: pd.Series(dtype=float) for name in table.names})
    try:
        text = whole.decode("utf-8")
        frame = pd.read_csv(io.StringIO(text), dtype=str, keep_default_na=False)
    except (UnicodeDecodeError, pd.errors.ParserError) as error:
        raise DataError(
            f"is not a CSV table: {error}",
            where=str(path),
            allowed="comma-separated, UTF-8, columns " + ",".join(table.names),
        ) from None
    needed = [c.name for c in table.columns if not c.optional and c.left_out is None]
    missing = [name for name in needed if name not in frame]
    if missing:
        raise DataError(
            f"lacks the column{'s' if len(missing) > 1 else ''} {', '.join(missing)}",
            where=f"{path}:1",
            allowed="columns " + ",".join(table.names),
            remedy=f"only {', '.join(needed)} must be there",
        )
    for column in table.columns:
        if column.name not in frame:
            frame[column.name] = float("nan") if column.left_out is None else column.left_out
        elif column.type != "string":
            frame[column.name] = _numbers(frame[column.name], column.type, path, column.optional)
    return frame


def _numbers(cells: "pd.Series[Any]", kind: str, path: Path, optional: bool) -> "pd.Series[Any]":
    import pandas as pd

    numbers = pd.to_numeric(cells.where(cells != "", None), errors="coerce")
    bad = numbers.isna() & (cells != "") if optional else numbers.isna()
    if kind == "integer" and not bad.any():
        bad = numbers.notna() & (numbers % 1 != 0)
    if bad.any():
        line = int(bad.to_numpy().argmax()) + 2
        raise DataError(
            f"{cells.name} is {cells.iloc[line - 2]!r}",
            where=f"{path}:{line}, column {cells.name}",
            allowed=f"{'an integer' if kind == 'integer' else 'a number'}"
            + (" or an empty cell" if optional else ""),
            remedy="restore the file; nothing is repaired silently",
        )
    return numbers.astype("int64") if kind == "integer" and not optional else numbers


def _or_none(folder: Path, table: Table, notes: list[str]) -> "pd.DataFrame | None":
    path = folder / table.file
    return read_table(path, table, notes) if path.is_file() else None


def _or_empty(folder: Path, table: Table, notes: list[str]) -> "pd.DataFrame":
    import pandas as pd

    if (folder / table.file).is_file():
        return read_table(folder / table.file, table, notes)
    notes.append(f"{table.file} is missing")
    return pd.DataFrame({name: pd.Series(dtype=float) for name in table.names})


def _read_start(folder: Path) -> StartRecord:
    path = folder / "start.json"
    if not path.is_file():
        raise DataError(
            "is no run folder: it has no start.json",
            where=str(folder),
            remedy="name a folder written by `rig record` (see docs/run-folder.md)",
        )
    try:
        start = StartRecord.model_validate_json(path.read_text(encoding="utf-8"))
    except (ValidationError, UnicodeDecodeError, OSError) as error:
        raise _bad_record(path, error) from None
    if start.schema_version > SCHEMA_VERSION:
        raise DataError(
            f"the run has schema version {start.schema_version}",
            where=str(path),
            allowed=f"up to {SCHEMA_VERSION}",
            remedy="update the toolkit",
        )
    return start


def _read_stop(folder: Path, notes: list[str]) -> StopRecord | None:
    path = folder / "stop.json"
    if not path.is_file():
        notes.append("no stop.json: the recording was interrupted; what had arrived is used")
        return None
    try:
        return StopRecord.model_validate_json(path.read_text(encoding="utf-8"))
    except (ValidationError, UnicodeDecodeError, OSError) as error:
        raise _bad_record(path, error) from None


def _bad_record(path: Path, error: Exception) -> DataError:
    if isinstance(error, ValidationError):
        fault = error.errors()[0]
        key = ".".join(str(part) for part in fault["loc"])
        return DataError(
            f"{key + ': ' if key else ''}{fault['msg']}",
            where=str(path),
            allowed="the keys of cdpr8/runfolder/schemas/"
            f"v{SCHEMA_VERSION}/{path.stem}.schema.json",
        )
    return DataError(f"cannot be read: {error}", where=str(path))
