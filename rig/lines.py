"""What a run folder's tables take, line by line, and the writing of one line."""

from collections.abc import Mapping
from dataclasses import dataclass

from cdpr8.runfolder import EventKind, RunWriter
from rig.tally import Tally


@dataclass(frozen=True, slots=True)
class Sample:
    """One row of tension.csv; times in s of the run."""

    t_s: float
    cable: int
    digits: int
    tension_n: float
    status: int
    request_s: float
    received_s: float


@dataclass(frozen=True, slots=True)
class CommandRow:
    """One row of command.csv; `values` are its four quantities by name."""

    t_s: float
    cable: int
    values: Mapping[str, float]
    log_s: float | None


@dataclass(frozen=True, slots=True)
class CommandLine:
    """One line of the winch controller's log as it came, and what it says."""

    arrived_s: float
    raw: bytes
    rows: tuple[CommandRow, ...]


@dataclass(frozen=True, slots=True)
class Event:
    """One row of events.csv; time in s of the run."""

    t_s: float
    kind: EventKind
    detail: str
    cable: int | None


Line = Sample | Event | CommandLine


def write_line(writer: RunWriter, tally: Tally, line: Line) -> None:
    """Write one line into its table.

    Parameters
    ----------
    writer
        Of the run folder.
    tally
        Takes the last event.
    line
        A line of the command log is kept as it came too.

    Raises
    ------
    ValueError
        A line of a command log, in a run that has none.
    OSError
        The disk does not take it.
    """
    if isinstance(line, Sample):
        writer.tension.append(_row(line))
    elif isinstance(line, CommandLine):
        _write_command(writer, line)
    else:
        writer.event(line.t_s, line.kind, line.detail, line.cable)
        tally.last_event = f"{line.kind.value}: {line.detail}"


def _row(sample: Sample) -> dict[str, float | int | str | None]:
    return {
        "t_s": sample.t_s,
        "cable": sample.cable,
        "digits": sample.digits,
        "tension_n": sample.tension_n,
        "status": sample.status,
        "request_s": sample.request_s,
        "received_s": sample.received_s,
    }


def _write_command(writer: RunWriter, line: CommandLine) -> None:
    """The line as it came first: whatever can be made of it."""
    if writer.command is None or writer.command_text is None:
        raise ValueError("start.json names no command log, so this run has none")
    writer.command_text.append(line.arrived_s, line.raw)
    for row in line.rows:
        writer.command.append(
            {
                "t_s": row.t_s,
                "cable": row.cable,
                **row.values,
                "log_s": row.log_s,
                "arrived_s": line.arrived_s,
            }
        )
