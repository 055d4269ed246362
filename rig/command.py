"""The `rig` command: what comes before, during and after a run."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdpr8.terminal import alarm, entry, note, say_json
from rig.command_amplifiers import set_address_command, set_baud_command
from rig.command_before import doctor_command, pretension_command, zero_command
from rig.command_runs import export_command, import_command, verify_command
from rig.command_scan import SIMULATED, JsonOption, RigOption, SimulatedOption, load, scan_command

if TYPE_CHECKING:
    from cdpr8.rigfile import Excitation, Rig
    from rig.command_log import CommandLog
    from rig.zeros import Zeros

app = typer.Typer(
    name="rig",
    help="The machine: check it, record runs, verify, export and import them.\n\n"
    "Example: rig record --duration 10 --name first",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
main = entry(app)

LARGEST_SEED = 2**63 - 1


@app.command("record")
def record_command(
    duration: Annotated[
        float | None,
        typer.Option(
            min=0.1,
            max=86400.0,
            help="Whole recording in s: rest, motion, rest.  [default: the rig file's]",
        ),
    ] = None,
    rig: RigOption = None,
    out: Annotated[
        Path | None, typer.Option(help="Run folder, new or empty.  [default: runs/DATE-TIME]")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the run: the folder runs/NAME.")] = None,
    amplitude: Annotated[
        float | None, typer.Option(min=0.0, max=30.0, help="Amplitude of the motion in deg.")
    ] = None,
    frequency: Annotated[
        float | None, typer.Option(min=0.01, max=50.0, help="Frequency of the motion in Hz.")
    ] = None,
    simulated: SimulatedOption = False,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=LARGEST_SEED, help="Seed of the simulated rig's noise."),
    ] = None,
    virtual: Annotated[
        bool,
        typer.Option(
            "--virtual",
            help="Simulated rig only: let time run as fast as it can; a seed repeats the "
            "samples and frames exactly.",
        ),
    ] = False,
    until: Annotated[
        str | None, typer.Option(help="End at this time of day, HH:MM or HH:MM:SS.")
    ] = None,
    zeros: Annotated[
        Path | None,
        typer.Option(help="Zeros of the cells.  [default: zeros.json beside the rig file]"),
    ] = None,
    on_overload: Annotated[
        str | None,
        typer.Option(help="Command to run when a cable is overloaded ($CDPR8_CABLE says which)."),
    ] = None,
    command_log: Annotated[
        str | None,
        typer.Option(
            help="The winch controller's log: a file that grows, or tcp://HOST:PORT that sends "
            "lines."
        ),
    ] = None,
    command_map: Annotated[
        str | None,
        typer.Option(
            help="Which of its columns is what: time=COLUMN,1=COLUMN,2.measured_deg=COLUMN ...  "
            "[default: its columns are those of command.csv]"
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Record tensions and video into a run folder.

    Ctrl-C ends the recording in order; a second one at once. The toolkit records: it has no
    authority over the motion of a real machine.

    Examples: rig record --duration 10;
    rig record --duration 20 --rig lab.toml --name slow --frequency 0.5
    """
    import sys
    from datetime import UTC, datetime

    from cdpr8.clock import RealClock, VirtualClock
    from cdpr8.errors import UsageError
    from cdpr8.rigfile import files_beside
    from rig.alarm import OverloadAlarm
    from rig.live import live_view
    from rig.outcome import show, summary
    from rig.recorder import record
    from rig.run_name import named_run
    from rig.slack import slack_warning
    from rig.stop import StopRequest
    from rig.taps import listen_for_taps
    from rig.until import seconds_until

    if out is not None and name is not None:
        raise UsageError("--out and --name both name the run folder", allowed="one of them")
    rig_path, rig_text, machine = load(rig, simulated)
    now = datetime.now(UTC)
    if until is not None:
        if duration is not None:
            raise UsageError("--until and --duration both end the run", allowed="one of them")
        duration = seconds_until(until, now.astimezone())
    asked = f"--duration {duration:g}" if duration is not None else ""
    if until is not None:
        asked = f"--until {until}, in {duration:.1f} s,"
    excitation = _excitation(machine, duration, asked, amplitude, frequency)
    if (warning := slack_warning(machine, excitation)) is not None:
        note(f"warning: {warning}")
    taken = _zeros(zeros, rig_path)
    folder = out or named_run(name or now.astimezone().strftime("%Y-%m-%dT%H-%M-%S"))
    _announce(machine)
    note("setting up the amplifiers ...")

    def ready() -> None:
        note(f"recording {excitation.duration_s:g} s into {folder}; Ctrl-C ends it in order")
        if sys.stdin.isatty():
            note("tap the platform before and after the motion, and press Enter with each tap")

    log = _command_log(command_log, command_map)
    stop = StopRequest()
    with (
        stop.listening(),
        live_view(machine, excitation.duration_s, folder) as watch,
        listen_for_taps() as taps,
        _saying_what_is_left(folder),
    ):
        recording = record(
            machine,
            rig_text,
            folder,
            excitation=excitation,
            clock=VirtualClock(now) if virtual else RealClock(),
            seed=_fresh_seed() if seed is None else seed,
            rig_file=str(rig_path),
            stop=stop,
            watch=watch,
            alarm=OverloadAlarm(alarm, on_overload),
            zeros=taken,
            taps=taps,
            beside_rig=files_beside(rig_text, rig_path.parent),
            command_log=log,
            warn=lambda words: note(f"warning: {words}"),
            ready=ready,
        )
    if as_json:
        say_json(summary(recording))
    else:
        show(recording)
    if recording.fault is not None:
        raise recording.fault


app.command("scan")(scan_command)
app.command("doctor")(doctor_command)
app.command("zero")(zero_command)
app.command("pretension")(pretension_command)
app.command("set-address")(set_address_command)
app.command("set-baud")(set_baud_command)
app.command("verify")(verify_command)
app.command("export")(export_command)
app.command("import")(import_command)


@contextmanager
def _saying_what_is_left(folder: Path) -> Iterator[None]:
    """Say what there is where a Ctrl-C left it: nothing yet, or a run without a stop record."""
    try:
        yield
    except KeyboardInterrupt:
        if folder.exists():
            note(f"left at once: {folder} has no stop record, and loads as it is")
        else:
            note(f"stopped before anything was recorded; there is no {folder}")
        raise


def _zeros(path: Path | None, rig_path: Path) -> "Zeros | None":
    """The zeros that were named, else those beside the rig file, said aloud."""
    from cdpr8.errors import DataError
    from rig.zeros import default_zeros_path, read_zeros

    found = read_zeros(path or default_zeros_path(rig_path))
    if path is not None and found is None:
        raise DataError("there is no such zeros file", where=str(path))
    if found is not None:
        note(f"zeros of the cells from {path or default_zeros_path(rig_path)}")
    return found


def _announce(machine: "Rig") -> None:
    """Say what is simulated and what is left out."""
    if machine.bus.port == SIMULATED:
        note("recording the simulated rig, no hardware: the run is marked simulated")
        if machine.camera is not None and machine.camera.source != SIMULATED:
            note("the camera is left out beside a simulated port; --simulated simulates both")
    elif machine.camera is not None and machine.camera.source == SIMULATED:
        note("the rig file names no real camera ([camera] source): tensions only, no video")


def _command_log(where: str | None, map_: str | None) -> "CommandLog | None":
    """The winch controller's log, opened."""
    from cdpr8.errors import UsageError
    from rig.command_log import open_command_log

    if where is None:
        if map_ is not None:
            raise UsageError("--command-map without --command-log", allowed="both, or none")
        return None
    log = open_command_log(where, map_)
    if not where.startswith("tcp://") and not Path(where).exists():
        note(f"the command log {where} is not there yet; it is read once it appears")
    return log


def _excitation(
    rig: "Rig",
    duration: float | None,
    asked: str,
    amplitude: float | None,
    frequency: float | None,
) -> "Excitation":
    """The rig file's excitation with what the command line changes."""
    from cdpr8.errors import UsageError

    motion = rig.excitation
    update: dict[str, float] = {}
    if amplitude is not None:
        update["amplitude_deg"] = amplitude
    if frequency is not None:
        update["frequency_hz"] = frequency
    if duration is not None:
        rests_s = motion.duration_s - motion.motion_s
        motion_s = round(duration - rests_s, 9)
        least_s = 2.0 * motion.ramp_s
        if motion_s <= 0.0 or motion_s < least_s:
            raise UsageError(
                f"{asked} leaves {max(0.0, motion_s):g} s for the motion, between "
                f"rests of {motion.start_s:g} s and {motion.rest_s:g} s",
                allowed=f"{'at least' if least_s else 'more than'} {rests_s + least_s:g} s: "
                f"rests, and two ramps of {motion.ramp_s:g} s",
                remedy="a longer recording, or shorter rest_s and ramp_s under [excitation]",
            )
        update["motion_s"] = motion_s
    return motion.model_copy(update=update)


def _fresh_seed() -> int:
    import secrets

    return secrets.randbits(32)
