"""The `model` command: reads files, calls the model, prints. Heavy imports wait until used."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cdpr8 import terminal
from cdpr8.errors import CheckError, UsageError
from model.reconstruct.command import reconstruct
from model.sweep.command import sweep

if TYPE_CHECKING:
    from collections.abc import Mapping

    from cdpr8.rigfile import Excitation
    from model.check import Check
    from model.motion import Motion
    from model.simulation import Simulation
    from model.summary import Summary

PAPER_MOTION = {"rest_s": 0.0, "motion_start_s": None, "motion_s": 10.0, "ramp_s": 0.0}
"""Section 4.1: the run starts in the state X*, X*', and ..."""

PAPER_OFFSETS = {"platform_offset_m": (1e-4, 0.0, 0.0), "cable_offset_m": 1e-4}
"""... with the initial disturbances X_p0 = X_w0 = 0.1 mm."""

PAPER_SINE = {"axis": "pitch", "amplitude_deg": 2.0, "frequency_hz": 2.06}
"""Eq. 20."""

app = typer.Typer(
    name="model",
    help="Simulate the machine a rig file describes.\n\nExample: model simulate --paper",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
)
app.command()(sweep)
app.command()(reconstruct)
main = terminal.entry(app)


@app.callback()
def _commands() -> None:
    """Keeps `model simulate` a command of its own while it is the only one."""


@app.command()
def simulate(
    rig: Annotated[
        Path | None,
        typer.Option(help="Rig file; default: ./rig.toml, else the packaged CDPR-8."),
    ] = None,
    paper: Annotated[
        bool,
        typer.Option(
            "--paper",
            help="The paper's case: 2 deg pitch at 2.06 Hz for 10 s, no rest, no ramp, 0.1 mm "
            "offsets; the options below change it.",
        ),
    ] = False,
    axis: Annotated[
        Literal["roll", "pitch", "yaw"] | None, typer.Option(help="Axis of the motion.")
    ] = None,
    amplitude: Annotated[float | None, typer.Option(help="Amplitude, deg.")] = None,
    frequency: Annotated[float | None, typer.Option(help="Frequency, Hz.")] = None,
    motion: Annotated[
        float | None, typer.Option(help="Length of the motion with its ramps, s.")
    ] = None,
    ramp: Annotated[
        float | None, typer.Option(help="Rise and fall of the amplitude, s; 0 starts in motion.")
    ] = None,
    rest: Annotated[float | None, typer.Option(help="Rest before and after, s.")] = None,
    excitation_effect: Annotated[
        bool,
        typer.Option(
            "--excitation-effect/--no-excitation-effect",
            help="Without it X_w = 0 and nothing is disturbed.",
        ),
    ] = True,
    method: Annotated[
        Literal["dop853", "dp5", "rk4"], typer.Option(help="Integration method.")
    ] = "dop853",
    step: Annotated[
        float | None, typer.Option(help="Longest step, s; default: what the machine needs.")
    ] = None,
    rate: Annotated[float, typer.Option(help="Output rate, Hz.")] = 1000.0,
    drive: Annotated[
        Literal["wrench", "winch"] | None,
        typer.Option(help="What drives the platform; default: the rig file's."),
    ] = None,
    effects: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            help="Switch on a left-out effect (see `model effects`), as in "
            "pulley_coulomb:coulomb_n=0.3@1,2; repeat for more. Adds to the rig file's.",
        ),
    ] = None,
    follow: Annotated[
        str | None,
        typer.Option(
            help="Any other motion in place of the sine, as in multisine:yaw=1,base=0.5,highest=5; "
            "sine, multisine, steps, decay or csv:FILE, along x, y, z (m), roll, pitch, yaw (deg).",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Of the random phases of a multisine.")] = 0,
    out: Annotated[Path | None, typer.Option(help="Write the series to this file (.csv).")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    check: Annotated[
        bool,
        typer.Option("--check", help="Repeat with half the step, and test energy; exit code 1."),
    ] = False,
) -> None:
    """Simulate one motion: pitch, tensions and cable vibration (Eqs. 1 to 18 of the paper).

    Example: model simulate --frequency 4 --amplitude 1 --out run.csv
    """
    if out is not None:
        _check_writable(out)
    from cdpr8.rigfile import load_rig
    from model.simulator import simulate as solve
    from model.summary import summarise

    machine = load_rig(rig)
    changes: dict[str, object] = {
        "axis": axis,
        "amplitude_deg": amplitude,
        "frequency_hz": frequency,
        "motion_s": motion,
        "ramp_s": ramp,
        "rest_s": rest,
    }
    excitation = _excitation(machine.excitation, paper, changes)
    how: dict[str, Any] = {
        "excitation_effect": excitation_effect,
        "method": method,
        "output_rate_hz": rate,
        "drive": drive,
        "effects": _effects(machine.physics, effects or []),
        "motion": _motion(follow, seed),
    }
    simulation = solve(machine, excitation, **how, step_s=step, announce=terminal.note)
    checks: tuple[Check, ...] = ()
    if check:
        from model.check import free_energy, step_halving

        checks = (
            step_halving(machine, simulation, excitation, **how),
            free_energy(machine, method=method, step_s=step),
        )
    if out is not None:
        simulation.to_frame().to_csv(out, index=False, float_format="%.10g")
    summary = summarise(simulation)
    if as_json:
        _say_json(simulation, summary, checks, out, follow)
    else:
        spoken = f"{excitation.axis} {excitation.amplitude_deg:g} deg at "
        spoken += f"{excitation.frequency_hz:g} Hz"
        _say_table(machine.name, follow or spoken, simulation, summary)
        for one in checks:
            terminal.say(one.sentence())
        if out is not None:
            terminal.say(f"{len(simulation.t_s)} rows written to {out}")
    failed = [one.sentence() for one in checks if not one.passed]
    if failed:
        raise CheckError(
            "; ".join(failed),
            remedy="take a shorter --step; large vibration is chaotic, and no step repeats it",
        )


@app.command("effects")
def list_effects(
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the page docs/effects.md.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the left-out effects: equations, parameters, plausible ranges.

    Example: model effects
    """
    from model.library import document
    from model.library.discovery import library

    if as_json:
        terminal.say_json({"effects": document.as_json()})
        return
    if markdown:
        terminal.say(document.markdown().rstrip("\n"))
        return
    from rich.table import Table

    table = Table("effect", "acts on", "equation", "parameters (default; plausible range)")
    for effect in library().values():
        numbers = (
            f"{one.name} = {one.default:g} {one.unit} ({one.low:g} to {one.high:g})"
            for one in effect.parameters
        )
        table.add_row(effect.name, effect.acts.value, effect.equation, "\n".join(numbers))
    terminal.say_table(table)


def _effects(physics: "Mapping[str, Mapping[str, object]]", asked: list[str]) -> list[Any]:
    """Those of the rig file, and those asked for in their place or beside them."""
    from model.library.selection import ActiveEffect, of_rig

    named = {one.name: one for one in of_rig(physics)}
    named |= {one.name: one for one in map(ActiveEffect.from_text, asked)}
    return list(named.values())


def _check_writable(out: Path) -> None:
    """Refuse early what would fail after the work."""
    if out.suffix.lower() != ".csv":
        raise UsageError(f"--out {str(out)!r} is not a .csv file", allowed="a name ending in .csv")
    if not out.parent.is_dir():
        raise UsageError(
            f"no folder {str(out.parent)!r} for --out", remedy=f"mkdir -p {out.parent}"
        )


def _motion(words: str | None, seed: int) -> "Motion | None":
    """The motion asked for in words, where there is one."""
    if words is None:
        return None
    import numpy as np

    from model.motions import motion_of

    motion: Motion = motion_of(words, np.random.default_rng(seed))
    return motion


def _excitation(default: "Excitation", paper: bool, changes: dict[str, object]) -> "Excitation":
    """The rig's excitation, or the paper's, with what was asked for changed."""
    from pydantic import ValidationError

    from cdpr8.rigfile import Excitation

    values = default.model_dump()
    if paper:
        values |= PAPER_MOTION | PAPER_OFFSETS | PAPER_SINE
    asked = {key: value for key, value in changes.items() if value is not None}
    if "rest_s" in asked:
        values["motion_start_s"] = None
    try:
        return Excitation.model_validate(values | asked)
    except ValidationError as error:
        fault = error.errors()[0]
        key = ".".join(str(part) for part in fault["loc"]) or "excitation"
        shown = f" {fault['input']!r}" if fault["loc"] else ""
        raise UsageError(
            f"{key}{shown} is refused", allowed=fault["msg"].removeprefix("Value error, ")
        ) from None


def _say_table(
    rig_name: str,
    motion: str,
    simulation: "Simulation",
    summary: "Summary | None",
) -> None:
    from rich.table import Table

    first, last = simulation.steady_window_s
    terminal.say(
        f"{rig_name}: {motion}; amplitudes over {first:g} to {last:g} s; "
        f"{simulation.stats.method}, {simulation.stats.steps} steps"
    )
    if summary is not None:
        platform = Table("platform", "value", "unit")
        for name, value, unit in (
            ("max |roll|", f"{summary.max_roll_deg:.2f}", "deg"),
            ("max |pitch|", f"{summary.max_pitch_deg:.2f}", "deg"),
            ("max |yaw|", f"{summary.max_yaw_deg:.2f}", "deg"),
            ("displacement from X*", f"{summary.displacement_mm:.2f}", "mm"),
            ("rotation from X*", f"{summary.rotation_deg:.2f}", "deg"),
            ("lowest tension", f"{summary.min_tension_n:.2f}", "N"),
            ("... in cable", f"{summary.min_tension_cable}", ""),
        ):
            platform.add_row(name, value, unit)
        terminal.say_table(platform)
        cables = Table("cable", "max |T - T0|, N", "max |X_w|, mm")
        for number, (force, offset) in enumerate(
            zip(summary.tension_variation_n, summary.cable_amplitude_mm, strict=True), start=1
        ):
            cables.add_row(str(number), f"{force:.2f}", f"{offset:.2f}")
        terminal.say_table(cables)
    terminal.say(simulation.outcome.sentence())


def _say_json(
    simulation: "Simulation",
    summary: "Summary | None",
    checks: "tuple[Check, ...]",
    out: Path | None,
    follow: str | None,
) -> None:
    from dataclasses import asdict

    terminal.say_json(
        {
            "summary": summary and summary.as_dict(),
            "steady_window_s": simulation.steady_window_s,
            "outcome": asdict(simulation.outcome) | {"sentence": simulation.outcome.sentence()},
            "checks": [asdict(one) | {"passed": one.passed} for one in checks],
            "stats": asdict(simulation.stats),
            "provenance": dict(simulation.provenance),
            "follow": follow,
            "written": str(out) if out else None,
        }
    )
