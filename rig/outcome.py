"""How a recording ended, told to people and to machines."""

from collections.abc import Mapping
from typing import Any

from cdpr8.terminal import say, say_table
from rig.ending import Recording


def summary(recording: Recording) -> dict[str, Any]:
    """The outcome for machines."""
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
        "commands": recording.commands,
        "lost": stop.lost,
        "fault": recording.fault.sentence() if recording.fault else None,
        "next": _next_commands(recording),
    }


def show(recording: Recording) -> None:
    """The outcome for people."""
    from rich.table import Table

    start, stop = recording.start, recording.stop
    kind = "simulated " if start.simulated else ""
    say(f"{kind}run {recording.folder}: {stop.t_s:.1f} s, ended by {REASONS[stop.reason]}")
    table = Table()
    for heading in ("cable", "samples", "rate 1/s"):
        table.add_column(heading, justify="right")
    for cable, count in stop.samples.items():
        table.add_row(str(cable), str(count), f"{recording.rate_per_s(cable):.1f}")
    say_table(table)
    camera = start.camera
    say(f"frames: {stop.frames}" + (f" at {camera.fps:g}/s" if camera else " (no camera)"))
    if recording.commands is not None:
        say(f"command log: {recording.commands} rows from {start.command_log}")
    say("lost:   " + in_words(stop.lost))
    for line in _next_commands(recording):
        say(f"next:   {line}")


def in_words(lost: Mapping[str, int]) -> str:
    """What a run lost, as people read it; samples without a time are flagged too, and told once."""
    lost = {**lost, "flagged": lost.get("flagged", 0) - lost.get("untimed", 0)}
    words = (f"{_LOST.get(what, what)} {count}" for what, count in lost.items() if count > 0)
    return ", ".join(words) or "nothing"


def _next_commands(recording: Recording) -> list[str]:
    import shlex

    run = shlex.quote(str(recording.folder))
    return [f"rig verify {run}", f"vision track {run}", f"analysis compare {run}"]


REASONS = {
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
    "frame_repeated": "frames repeated",
    "camera_lost": "camera gone",
    "flagged": "samples flagged otherwise",
    "unconfirmed": "jumps not confirmed",
    "untimed": "samples too late to be timed",
    "line_lost": "times the line was gone",
    "missing": "values missing in streams",
    "restart": "streams started anew",
    "command_line": "lines of the command log not understood",
    "command_log_lost": "times the command log was gone",
    "pause": "times the computer stood still",
}
