"""The winch controller's own log, its source opened and its columns known before the run."""

from dataclasses import dataclass
from pathlib import Path

from cdpr8.errors import UsageError
from rig.command_columns import CommandColumns, LineReader
from rig.log_source import GrowingFile, LineSource, TcpLines


@dataclass(frozen=True)
class CommandLog:
    """A log that is to be recorded.

    Attributes
    ----------
    source
        Where its lines come from.
    columns
        What they hold.
    """

    source: LineSource
    columns: CommandColumns

    @property
    def description(self) -> str:
        """For start.json."""
        return f"{self.source.name}: {self.columns.text}"

    def reader(self) -> LineReader:
        """A reader that knows the headings which were there before the run.

        Raises
        ------
        UsageError
            The columns are not there.
        """
        reader = LineReader(self.columns)
        for line in self.source.heading():
            reader.heading(line)
        return reader


def open_command_log(where: str, map_: str | None) -> CommandLog:
    """Open the log that a command line names.

    Parameters
    ----------
    where
        A file, or ``tcp://HOST:PORT``.
    map_
        Its columns, as `CommandColumns.parse` reads them.

    Raises
    ------
    UsageError
        The map or the address is none.
    DataError, DeviceError
        The log is not there.
    """
    columns = CommandColumns.parse(map_)
    if not where.startswith("tcp://"):
        log = CommandLog(GrowingFile(Path(where)), columns)
        log.reader()  # what does not fit is told before the run
        return log
    host, _, port = where.removeprefix("tcp://").rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise UsageError(
            f"--command-log {where!r} is no address", allowed="FILE, or tcp://HOST:PORT"
        )
    return CommandLog(TcpLines(host, int(port)), columns)
