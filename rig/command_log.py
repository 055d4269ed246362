"""The winch controller's own log, recorded beside the tensions: a growing file, or lines over TCP.

Every line that arrives is kept as it came, with its time of arrival (command.txt). Lines that can
be read become rows of command.csv. The log's own clock is tied to the run by arrival: a line comes
late, never early, so of the last `WINDOW_S` the quickest tells how the two clocks stand.
"""

import socket
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from cdpr8.clock import Clock
from cdpr8.errors import DataError, DeviceError, ToolkitError, UsageError
from cdpr8.runfolder import EventKind
from rig.command_columns import Command, CommandColumns, LineReader
from rig.scribe import CommandLine, CommandRow, Scribe
from rig.streams import Span
from rig.tally import Tally

LOOK_EVERY_S = 0.02
"""A log is looked at this often: how late a line may be noticed."""

WINDOW_S = 10.0
"""Clocks off by 100 ppm part by 1 ms in this time."""

CONNECT_S = 3.0
RECONNECT_EVERY_S = 1.0
HEADING_BYTES = 65536
"""Of a file that is there before the run, so much is read for its column names."""

LONGEST_LINE = 65536
"""More bytes without a line end are kept as a line of their own."""


class LineSource(Protocol):
    """Where lines come from."""

    @property
    def name(self) -> str:
        """What a user calls it."""
        ...

    def heading(self) -> Sequence[bytes]:
        """Lines that were there before the run."""
        ...

    def read(self, now_s: float) -> bytes:
        """Bytes that have come; raises `OSError` where the source is lost."""
        ...

    def close(self) -> None:
        """Give it back."""
        ...


class GrowingFile:
    """A file that another program appends to; it may appear after the run has begun.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    DataError
        Its folder is not there, or it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.name = str(path)
        self._path = path
        self._heading: list[bytes] = []
        self._at = 0
        if not path.resolve().parent.is_dir():
            raise DataError(
                "its folder is not there", where=self.name, remedy="check --command-log"
            )
        if not path.exists():
            return
        try:
            with path.open("rb") as file:
                self._heading = file.read(HEADING_BYTES).split(b"\n")[:-1]
                # The recording begins at the next whole line.
                end = file.seek(0, 2)
                file.seek(max(0, end - HEADING_BYTES))
                begun = file.read()
                self._at = end - len(begun) + begun.rfind(b"\n") + 1
        except OSError as error:
            raise DataError(f"cannot be read: {error.strerror}", where=self.name) from None

    def heading(self) -> Sequence[bytes]:
        """Lines that were there before the run."""
        return self._heading

    def read(self, now_s: float) -> bytes:
        """What was appended; a file that was begun anew is read from its start."""
        del now_s
        try:
            size = self._path.stat().st_size
        except FileNotFoundError:
            return b""
        if size < self._at:
            self._at = 0
        if size == self._at:
            return b""
        with self._path.open("rb") as file:
            file.seek(self._at)
            data = file.read()
        self._at += len(data)
        return data

    def close(self) -> None:
        """Nothing is held open."""


class TcpLines:
    """Lines that another program sends; a lost connection is tried again once a second.

    Parameters
    ----------
    host, port
        Where it listens.

    Raises
    ------
    DeviceError
        Nobody listens there.
    """

    def __init__(self, host: str, port: int) -> None:
        self.name = f"tcp://{host}:{port}"
        self._address = (host, port)
        self._retry_s = 0.0
        try:
            self._socket: socket.socket | None = self._connect(CONNECT_S)
        except OSError as error:
            raise DeviceError(
                f"nobody sends a command log at {self.name}: {error.strerror or error}",
                remedy="start the winch controller's log first, or leave --command-log out",
            ) from None

    def heading(self) -> Sequence[bytes]:
        """None is known."""
        return ()

    def read(self, now_s: float) -> bytes:
        """What was sent.

        Raises
        ------
        OSError
            The connection is lost.
        """
        if self._socket is None:
            if now_s < self._retry_s:
                return b""
            self._retry_s = now_s + RECONNECT_EVERY_S
            self._socket = self._connect(LOOK_EVERY_S)
        data, fault = b"", OSError("the other side closed the connection")
        try:
            while chunk := self._socket.recv(65536):
                data += chunk
        except BlockingIOError:
            return data
        except OSError as error:
            fault = error
        if data:
            return data  # the fault is still there at the next look
        self.close()
        self._socket = None
        self._retry_s = now_s + RECONNECT_EVERY_S
        raise fault

    def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            with suppress(OSError):
                self._socket.close()

    def _connect(self, timeout_s: float) -> socket.socket:
        connected = socket.create_connection(self._address, timeout_s)
        connected.setblocking(False)
        return connected


class ArrivalClock:
    """A log's own clock against the run's, by the quickest of its last lines."""

    def __init__(self) -> None:
        self._late: deque[tuple[float, float]] = deque()
        self._last_s = -float("inf")

    def add(self, log_s: float, arrived_s: float) -> None:
        """A line of the log's time `log_s` had come by `arrived_s`."""
        if log_s < self._last_s:
            self._late.clear()  # begun anew
        self._last_s = log_s
        late_s = arrived_s - log_s
        while self._late and self._late[-1][1] >= late_s:
            self._late.pop()
        self._late.append((arrived_s, late_s))
        while self._late[0][0] < arrived_s - WINDOW_S:
            self._late.popleft()

    def run_s(self, log_s: float) -> float:
        """A time of the log on the run's clock."""
        return log_s + self._late[0][1]


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


class CommandStream:
    """Takes the log's lines during a recording.

    Parameters
    ----------
    log
        Opened.
    scribe, tally
        Take what comes.
    span
        Of the run.
    clock
        A real one.
    """

    name = "command log"

    def __init__(
        self, log: CommandLog, scribe: Scribe, tally: Tally, span: Span, clock: Clock
    ) -> None:
        self._log = log
        self._scribe = scribe
        self._tally = tally
        self._span = span
        self._clock = clock
        self._reader = log.reader()
        self._arrivals = ArrivalClock()
        self._rest = b""
        self._bad = 0
        self._lost = False

    @property
    def due_s(self) -> float:
        """Now."""
        return self._clock.monotonic_s()

    def step(self) -> bool:
        """Take the lines that have come, then wait a little."""
        now_s = self._clock.monotonic_s()
        self._take(now_s)
        if now_s >= self._span.end_s:
            if self._rest:
                self._hand_on([self._rest], now_s - self._span.origin_s)
            return False
        self._clock.sleep_until(min(now_s + LOOK_EVERY_S, self._span.end_s))
        return True

    def _take(self, now_s: float) -> None:
        t_s = now_s - self._span.origin_s
        try:
            data = self._log.source.read(now_s)
        except OSError as error:
            if not self._lost:
                self._tally.lose("command_log_lost")
                self._event(t_s, f"{self._log.source.name} is lost: {error.strerror or error}")
            self._lost = True
            return
        if not data:
            return
        if self._lost:
            self._event(t_s, f"{self._log.source.name} sends again")
            self._lost = False
        *lines, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > LONGEST_LINE:
            lines.append(self._rest)
            self._rest = b""
        self._hand_on(lines, t_s)

    def _hand_on(self, lines: list[bytes], arrived_s: float) -> None:
        """All lines that came together tell the clock before any of them is timed."""
        parsed = []
        for line in lines:
            raw = line.removesuffix(b"\r")
            found: tuple[Command, ...] = ()
            try:
                found = self._reader.read(raw)
            except (DataError, UsageError) as fault:
                self._refuse(arrived_s, fault)
            for each in found:
                if each.log_s is not None:
                    self._arrivals.add(each.log_s, arrived_s)
            parsed.append((raw, found))
        for raw, found in parsed:
            rows = tuple(
                CommandRow(
                    t_s=arrived_s if each.log_s is None else self._arrivals.run_s(each.log_s),
                    cable=each.cable,
                    values=each.values,
                    log_s=each.log_s,
                )
                for each in found
            )
            self._tally.commands += len(rows)
            self._scribe.command(CommandLine(arrived_s, raw, rows))

    def _refuse(self, t_s: float, fault: ToolkitError) -> None:
        """The first bad line is told, all are counted, and all are in command.txt."""
        self._bad += 1
        self._tally.lose("command_line")
        if self._bad == 1:
            self._event(t_s, f"{fault.what}; further ones are counted")

    def _event(self, t_s: float, words: str) -> None:
        self._scribe.event(t_s, EventKind.COMMAND_LOG, words)
