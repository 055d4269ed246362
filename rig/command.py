"""The `rig` command: record a run, list the amplifiers."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8.terminal import entry, note, say, say_json, say_table

if TYPE_CHECKING:
    from cdpr8.rigfile import Excitation, Rig
    from rig.recorder import Recording

app = typer.Typer(
    name="rig",
    help="The machine: record runs, list amplifiers.\n\n"
    "Example: rig record --duration 10 --name first",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
main = entry(app)

RUNS = Path("runs")
SIMULATED = "simulated"
LARGEST_SEED = 2**63 - 1

RigOption = Annotated[
    Path | None,
    typer.Option("--rig", help="Rig file.  [default: ./rig.toml, else the packaged CDPR-8]"),
]
SimulatedOption = Annotated[
    bool, typer.Option("--simulated", help="Use the simulated rig, whatever port is named.")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


@app.callback()
def _rig() -> None:
    pass


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
    as_json: JsonOption = False,
) -> None:
    """Record tensions and video into a run folder.

    Ctrl-C ends the recording in order; a second one at once. The toolkit records: it has no
    authority over the motion of a real machine.

    Examples: rig record --duration 10;
    rig record --duration 20 --rig lab.toml --name slow --frequency 0.5
    """
    from datetime import UTC, datetime

    from cdpr8.clock import RealClock, VirtualClock
    from cdpr8.errors import UsageError
    from rig.live import live_view
    from rig.recorder import record
    from rig.stop import StopRequest

    if out is not None and name is not None:
        raise UsageError("--out and --name both name the run folder", allowed="one of them")
    rig_path, rig_text, machine = _load(rig, simulated)
    excitation = _excitation(machine, duration, amplitude, frequency)
    now = datetime.now(UTC)
    folder = out or RUNS / (name or now.astimezone().strftime("%Y-%m-%dT%H-%M-%S"))
    if machine.bus.port == SIMULATED:
        note("recording the simulated rig, no hardware: the run is marked simulated")
        if machine.camera is not None and machine.camera.source != SIMULATED:
            note("the camera is left out beside a simulated port; --simulated simulates both")
    elif machine.camera is not None and machine.camera.source == SIMULATED:
        note("the rig file names no real camera ([camera] source): tensions only, no video")
    note(f"recording {excitation.duration_s:g} s into {folder}; Ctrl-C ends it in order")
    stop = StopRequest()
    with stop.listening(), live_view(machine, excitation.duration_s) as watch:
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
        )
    if as_json:
        say_json(_summary(recording))
    else:
        _show(recording)
    if recording.fault is not None:
        raise recording.fault


@app.command("scan")
def scan_command(
    rig: RigOption = None, simulated: SimulatedOption = False, as_json: JsonOption = False
) -> None:
    """List the amplifiers that answer on the bus, with their settings.

    Example: rig scan --rig lab.toml
    """
    from rich.table import Table

    from cdpr8.clock import RealClock
    from cdpr8.errors import DeviceError
    from rig.assignment import amplifiers
    from rig.machine import open_machine
    from rig.scan import SHOWN, scan

    _, __, machine = _load(rig, simulated)
    cables = {amplifier.address: cable for cable, amplifier in amplifiers(machine).items()}
    opened = open_machine(machine, machine.excitation, RealClock())
    try:
        found = list(scan(opened.transport))
    finally:
        opened.close()
    if as_json:
        say_json(
            [
                {
                    "address": node.address,
                    "cable": cables.get(node.address),
                    "identity": node.identity.text if node.identity else None,
                    "settings": node.settings,
                    "trouble": node.trouble or None,
                }
                for node in found
            ]
        )
    elif found:
        table = Table(title=f"{len(found)} amplifiers on {opened.transport.name}")
        for heading in ("address", "cable", "type", "serial", *SHOWN, "trouble"):
            table.add_column(heading)
        for node in found:
            who = node.identity
            table.add_row(
                f"{node.address:02d}",
                str(cables.get(node.address, "-")),
                who.type if who else "?",
                who.serial_number if who else "?",
                *(node.settings.get(name, "") for name in SHOWN),
                node.trouble,
            )
        say_table(table)
    if not found:
        raise DeviceError(
            f"no amplifier answers at {opened.transport.line}",
            where=opened.transport.name,
            remedy="check power and wiring, and baud and parity under [bus] in the rig file",
        )


def _load(path: Path | None, simulated: bool) -> "tuple[Path, str, Rig]":
    """The rig file's path and text, and the rig, simulated where that was asked for."""
    from cdpr8.rigfile import find_rig_file, load_rig

    path = find_rig_file(path)
    rig = load_rig(path)
    text = path.read_text(encoding="utf-8")
    if simulated:
        update: dict[str, Any] = {"bus": rig.bus.model_copy(update={"port": SIMULATED})}
        if rig.camera is not None:
            update["camera"] = rig.camera.model_copy(update={"source": SIMULATED})
        rig = rig.model_copy(update=update)
    return path, text, rig


def _excitation(
    rig: "Rig", duration: float | None, amplitude: float | None, frequency: float | None
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
        rests_s = motion.start_s + motion.rest_s
        motion_s = round(duration - rests_s, 9)
        least_s = 2.0 * motion.ramp_s
        if motion_s <= 0.0 or motion_s < least_s:
            raise UsageError(
                f"--duration {duration:g} leaves {max(0.0, motion_s):g} s for the motion, between "
                f"rests of {motion.start_s:g} s and {motion.rest_s:g} s",
                allowed=f"{'at least' if least_s else 'more than'} {rests_s + least_s:g} s: "
                f"rests, and two ramps of {motion.ramp_s:g} s",
                remedy="a longer --duration, or shorter rest_s and ramp_s under [excitation]",
            )
        update["motion_s"] = motion_s
    return motion.model_copy(update=update)


def _fresh_seed() -> int:
    import secrets

    return secrets.randbits(32)


def _summary(recording: "Recording") -> dict[str, Any]:
    stop = recording.stop
    return {
        "run": str(recording.folder),
        "simulated": recording.start.simulated,
        "seed": recording.start.seed,
        "reason": stop.reason,
        "duration_s": stop.t_s,
        "samples": stop.samples,
        "rate_per_s": {cable: round(recording.rate_per_s(cable), 2) for cable in stop.samples},
        "frames": stop.frames,
        "lost": stop.lost,
        "fault": recording.fault.sentence() if recording.fault else None,
        "next": _next_commands(recording),
    }


def _show(recording: "Recording") -> None:
    from rich.table import Table

    start, stop = recording.start, recording.stop
    kind = "simulated " if start.simulated else ""
    say(f"{kind}run {recording.folder}: {stop.t_s:.1f} s, ended by {_REASONS[stop.reason]}")
    table = Table()
    for heading in ("cable", "samples", "rate 1/s"):
        table.add_column(heading, justify="right")
    for cable, count in stop.samples.items():
        table.add_row(str(cable), str(count), f"{recording.rate_per_s(cable):.1f}")
    say_table(table)
    camera = start.camera
    say(f"frames: {stop.frames}" + (f" at {camera.fps:g}/s" if camera else " (no camera)"))
    lost = (f"{_LOST.get(what, what)} {count}" for what, count in stop.lost.items())
    say("lost:   " + (", ".join(lost) or "nothing"))
    for line in _next_commands(recording):
        say(f"next:   {line}")


def _next_commands(recording: "Recording") -> list[str]:
    import shlex

    run = shlex.quote(str(recording.folder))
    return [f"vision track {run}", f"analysis compare {run}"]


_REASONS = {
    "duration": "the end of its duration",
    "interrupted": "the user",
    "stopped_at_once": "the user, at once",
    "device": "a device fault",
    "disk_full": "the disk",
}

_LOST = {
    "bad_frame": "bad values",
    "no_answer": "requests without answer",
    "node_lost": "amplifiers gone silent",
    "frame_dropped": "frames dropped",
    "camera_lost": "camera gone",
    "flagged": "samples flagged",
}
