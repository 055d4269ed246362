"""How a recording may end, and what keeps it from beginning."""

import errno
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from cdpr8.errors import DataError, DeviceError, ToolkitError
from cdpr8.runfolder import StartRecord, StopRecord
from rig.stop import StopRequest


@dataclass(frozen=True)
class Recording:
    """What was recorded.

    Attributes
    ----------
    folder
        The run folder.
    start, stop
        Its records.
    fault
        What ended it before its time, None where nothing did.
    commands
        Rows of the command log, None where none was recorded.
    """

    folder: Path
    start: StartRecord
    stop: StopRecord
    fault: ToolkitError | None = None
    commands: int | None = None

    def rate_per_s(self, cable: int) -> float:
        """Mean rate of a cable's samples."""
        return self.stop.samples[cable] / self.stop.t_s if self.stop.t_s > 0 else 0.0


def reason(
    stop: StopRequest, fault: ToolkitError | None
) -> Literal["duration", "interrupted", "stopped_at_once", "device", "disk_full"]:
    """The word for stop.json."""
    if isinstance(fault, DeviceError):
        return "device"
    if fault is not None:
        return "disk_full"
    if stop.requested:
        return "stopped_at_once" if stop.at_once else "interrupted"
    return "duration"


def require_empty(folder: Path) -> None:
    """Told before any device is opened; `RunWriter` holds to it."""
    if folder.exists() and not folder.is_dir():
        raise DataError(
            "is a file, and a run is a folder", where=str(folder), remedy="choose another name"
        )
    if folder.is_dir() and any(folder.iterdir()):
        raise DataError(
            "the run folder is not empty; nothing recorded is ever overwritten",
            where=str(folder),
            remedy="choose another name",
        )


def disk_fault(error: OSError, folder: Path) -> DataError:
    """What the operating system refused, as a user reads it."""
    full = error.errno == errno.ENOSPC
    return DataError(
        "the disk is full" if full else f"the run cannot be written: {error.strerror or error}",
        where=str(folder),
        remedy="what was written before stays readable; "
        + ("free some space and record again" if full else "check the disk"),
    )
