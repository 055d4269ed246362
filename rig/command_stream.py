"""The winch controller's log, recorded beside the tensions as its lines come.

Every line that arrives is kept as it came, with its time of arrival (command.txt). Lines that can
be read become rows of command.csv, their times put on the run's clock by `ArrivalClock`.
"""

from cdpr8.clock import Clock
from cdpr8.errors import DataError, ToolkitError, UsageError
from cdpr8.runfolder import EventKind
from rig.arrival_clock import ArrivalClock
from rig.command_columns import Command
from rig.command_log import CommandLog
from rig.lines import CommandLine, CommandRow
from rig.log_source import LOOK_EVERY_S
from rig.scribe import Scribe
from rig.streams import Span
from rig.tally import Tally

LONGEST_LINE = 65536
"""More bytes without a line end are kept as a line of their own."""


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
                self._hand_on([self._rest], self._run_s())
            return False
        self._clock.sleep_until(min(now_s + LOOK_EVERY_S, self._span.end_s))
        return True

    def _take(self, now_s: float) -> None:
        try:
            data = self._log.source.read(now_s)
        except OSError as error:
            if not self._lost:
                self._tally.lose("command_log_lost")
                words = f"{self._log.source.name} is lost: {error.strerror or error}"
                self._event(self._run_s(), words)
            self._lost = True
            return
        if not data:
            return
        # After the reading: what was written during it had not come before, and no line is early.
        t_s = self._run_s()
        if self._lost:
            self._event(t_s, f"{self._log.source.name} sends again")
            self._lost = False
        *lines, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > LONGEST_LINE:
            lines.append(self._rest)
            self._rest = b""
        self._hand_on(lines, t_s)

    def _run_s(self) -> float:
        return self._clock.monotonic_s() - self._span.origin_s

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
