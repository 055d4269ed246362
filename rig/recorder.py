"""Recording a run: open the rig, start the bus, write what comes until the end."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from cdpr8.clock import Clock, RealClock, VirtualClock
from cdpr8.errors import DataError, DeviceError, ToolkitError, UsageError
from cdpr8.rigfile import Excitation, Rig
from cdpr8.runfolder import (
    ClockAnchor,
    EventKind,
    RunWriter,
    StopRecord,
)
from rig.announcements import AnnouncementStream, announcements
from rig.broadcast import open_bus
from rig.bus import Bus
from rig.command_log import CommandLog
from rig.command_stream import CommandStream
from rig.concerns import concerns
from rig.ending import Recording, disk_fault, reason, require_empty
from rig.expected_rate import expected_rates
from rig.filter_delay import doubts
from rig.intake import Alarm, Intake
from rig.machine import Machine, open_machine
from rig.reserve import Reserve
from rig.schedule import run_by_time, run_in_threads
from rig.scribe import DirectScribe, Scribe, ThreadedScribe
from rig.start_record import start_record
from rig.stop import StopRequest
from rig.streaming import StreamingStream, StreamPort, open_ports
from rig.streaming.port import close_ports
from rig.streams import BusStream, CameraStream, Span, Stream
from rig.tally import Tally
from rig.taps import Taps
from rig.zeros import Zeros, check_zeros, zero_values

LEAD_S = 0.25
"""From the start record's clock anchor to the run's origin: time to get it onto the disk."""

Watch = Callable[[Tally, float], None]
"""Shown the counts and the run's time, now and then; may stall, may fail."""


def record(
    rig: Rig,
    rig_text: str,
    folder: Path,
    *,
    excitation: Excitation | None = None,
    clock: Clock | None = None,
    seed: int = 0,
    machine: Machine | None = None,
    reconstruction: str | None = None,
    rig_file: str = "rig.toml",
    stop: StopRequest | None = None,
    watch: Watch | None = None,
    alarm: Alarm | None = None,
    zeros: Zeros | None = None,
    taps: Taps | None = None,
    beside_rig: Mapping[str, bytes] | None = None,
    command_log: CommandLog | None = None,
    warn: Callable[[str], None] | None = None,
    ready: Callable[[], None] | None = None,
) -> Recording:
    """Record one run.

    On a `VirtualClock` the simulated rig runs as fast as it can, and a seed repeats the run to
    the byte (with the same versions of the libraries).

    Parameters
    ----------
    rig, rig_text
        The rig, and the file it was read from.
    folder
        The run folder; must not exist or be empty.
    excitation
        The motion, whose ``duration_s`` is the recording's; None takes the rig file's.
    clock
        None takes the computer's.
    seed
        Of a simulated rig.
    machine
        An opened rig, which is closed at the end; None opens what the rig file names. Another
        platform, or other friction: ``rig.simulated.open_rig(..., friction_n=...)``.
    reconstruction
        Said in start.json where the data are made to stand for others.
    rig_file
        Name of the rig file, for start.json.
    stop
        A wish to end before the time.
    watch
        Called now and then on a real clock with the counts and the run's time.
    alarm
        Told when an overload begins; must not wait.
    zeros
        Host-side zeros of the cells, as `rig zero` took them.
    taps
        Where the user's sync taps come in.
    beside_rig
        Files that the rig file names, for the run folder: `cdpr8.rigfile.files_beside`.
    command_log
        The winch controller's log, opened; closed at the end. Needs a real clock.
    warn
        Told what a user must know before the run, though it goes on.
    ready
        Called when all is set up, just before the run folder is made.

    Returns
    -------
    Recording
        Where it is and how it ended; ``fault`` says what ended it early.

    Raises
    ------
    DataError
        The folder is not empty or cannot be written.
    DeviceError
        A port, an amplifier or a camera is not there, or not what the rig file says.
    KeyboardInterrupt
        A stop was wished for before anything was recorded.
    """
    excitation = excitation or rig.excitation
    clock = clock or RealClock()
    stop = stop or StopRequest()
    try:
        if command_log is not None and isinstance(clock, VirtualClock):
            raise UsageError("a command log comes in real time", remedy="leave --virtual out")
        require_empty(folder)
        machine = machine or open_machine(rig, excitation, clock, seed=seed)
        session = _Session(machine, rig, clock, stop, excitation, alarm, zero_values(zeros))
        session.taps, session.command_log = taps, command_log
        check_zeros(zeros, {each.cable: each.identity.serial_number for each in session.stations})
        if warn is not None:
            for words in (*concerns(session.stations), *doubts(session.stations, rig)):
                warn(words)
        machine.ready()
        if stop.requested:
            raise KeyboardInterrupt  # nothing has been recorded
        if ready is not None:
            ready()
        now_s = clock.monotonic_s()
        start = start_record(
            machine,
            session.stations,
            rig,
            rig_text,
            excitation,
            rig_file=rig_file,
            reconstruction=reconstruction,
            seed=seed,
            zeros=zeros,
            anchor=ClockAnchor(t_s=-LEAD_S, wall=clock.wall()),
            command_log=None if command_log is None else command_log.description,
        )
        writer = RunWriter(folder, start, rig_text, beside_rig)
        try:
            reserve = Reserve(folder)
        except OSError as error:
            raise disk_fault(error, folder) from None
        stop_record, fault = session.run(writer, reserve, now_s + LEAD_S, watch)
        return Recording(folder, start, stop_record, fault, session.commands)
    finally:
        if command_log is not None:
            command_log.source.close()
        if machine is not None:
            machine.close()


class _Session:
    """A started rig, from its configured bus to its stop record."""

    def __init__(
        self,
        machine: Machine,
        rig: Rig,
        clock: Clock,
        stop: StopRequest,
        excitation: Excitation,
        alarm: Alarm | None,
        zeros: dict[int, float],
    ) -> None:
        self._alarm = alarm
        self.taps: Taps | None = None
        self.command_log: CommandLog | None = None
        self._machine = machine
        self._clock = clock
        self._stop = stop
        self._excitation = excitation
        self._tally = Tally()
        self._bus: Bus | None = None
        self._ports: tuple[StreamPort, ...] = ()
        if machine.ports:
            self._ports = open_ports(machine.ports, rig, zeros)
            self.stations = tuple(port.station for port in self._ports)
        else:
            self._bus = open_bus(machine.transport, rig, zeros)
            self.stations = self._bus.start()
        line = machine.transport.line
        self._tally.expected_per_s = expected_rates(self.stations, rig, line)
        if machine.camera is not None:
            import av  # noqa: F401  # now, not between the start record and the first sample

    @property
    def commands(self) -> int | None:
        """Rows of the command log so far."""
        return None if self.command_log is None else self._tally.commands

    def run(
        self, writer: RunWriter, reserve: Reserve, origin_s: float, watch: Watch | None
    ) -> tuple[StopRecord, ToolkitError | None]:
        """Record from the origin until the end, a wish to stop, or a fault."""
        span = Span(origin_s, origin_s + self._excitation.duration_s)
        self._machine.begin(origin_s)
        virtual = isinstance(self._clock, VirtualClock)
        scribe: Scribe = (
            DirectScribe(writer, self._tally)
            if virtual
            else ThreadedScribe(writer, self._tally, self._clock, hurry=lambda: self._stop.at_once)
        )
        fault: ToolkitError | None = None
        try:
            self._clock.sleep_until(origin_s)
            streams = self._streams(scribe, span)
            if virtual:
                run_by_time(streams, self._stop)
            else:
                run_in_threads(streams, self._stop, lambda: scribe.failure, self._look(watch, span))
        except DeviceError as error:
            fault = error
        except OSError as error:
            fault = disk_fault(error, writer.folder)
        ended_s = self._clock.monotonic_s() - origin_s
        anchor = ClockAnchor(t_s=round(ended_s, 6), wall=self._clock.wall())
        reserve.release()
        if isinstance(fault, DataError):
            scribe.event(ended_s, EventKind.DISK_FULL, fault.what)
        if self._stop.requested:
            scribe.event(ended_s, EventKind.INTERRUPTED, "stopped by the user")
        with suppress(DeviceError):
            if self._bus is not None:
                self._bus.stop()
        close_ports(self._ports)
        return self._finish(writer, scribe, anchor, fault)

    def _streams(self, scribe: Scribe, span: Span) -> list[Stream]:
        machine, tally = self._machine, self._tally
        intake = Intake(scribe, tally, span.origin_s, self._alarm)
        streams: list[Stream] = (
            [StreamingStream(self._ports, intake, span, self._clock)]
            if self._bus is None
            else [BusStream(self._bus, self.stations, intake, span)]
        )
        if machine.camera is not None:
            machine.camera.start(span.origin_s)
            streams.append(CameraStream(machine.camera, scribe, tally, span))
        clock = self._clock
        if self.command_log is not None:
            streams.append(CommandStream(self.command_log, scribe, tally, span, clock))
        own = VirtualClock(clock.epoch, clock.now_s) if isinstance(clock, VirtualClock) else clock
        announced = announcements(self._excitation, machine.motion_known)
        streams.append(AnnouncementStream(announced, own, scribe, span, self.taps))
        return streams

    def _look(self, watch: Watch | None, span: Span) -> Callable[[], None] | None:
        if watch is None:
            return None
        return lambda: watch(self._tally, self._clock.monotonic_s() - span.origin_s)

    def _finish(
        self, writer: RunWriter, scribe: Scribe, anchor: ClockAnchor, fault: ToolkitError | None
    ) -> tuple[StopRecord, ToolkitError | None]:
        scribe.close()
        if fault is None and isinstance(scribe.failure, OSError):
            fault = disk_fault(scribe.failure, writer.folder)
        tally = self._tally
        record_ = StopRecord(
            reason=reason(self._stop, fault),
            t_s=anchor.t_s,
            samples=tally.samples,
            frames=tally.frames,
            lost=tally.lost,
            clock_anchor=anchor,
        )
        try:
            writer.stop(record_)
        except OSError as error:
            fault = fault or disk_fault(error, writer.folder)
        return record_, fault
