"""The command `model sweep`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cdpr8 import terminal
from cdpr8.errors import UsageError

if TYPE_CHECKING:
    import pandas as pd

    from cdpr8.rigfile import Rig
    from model.sweep.plan import Plan

RUNS = "runs.jsonl"

SHOWN_ROWS = 24
"""Frequencies in the table on the terminal; all are in the file."""


def sweep(
    rig: Annotated[
        Path | None,
        typer.Option(help="Rig file; default: ./rig.toml, else the packaged CDPR-8."),
    ] = None,
    paper: Annotated[
        bool,
        typer.Option(
            "--paper",
            help="The paper's Section 4: Figs. 4 to 9, Table II, and a page that holds every "
            "published figure beside ours.",
        ),
    ] = False,
    first: Annotated[
        float | None, typer.Option("--from", help="Lowest frequency, Hz; default 2.06.")
    ] = None,
    last: Annotated[
        float | None, typer.Option("--to", help="Highest frequency, Hz; default 20.")
    ] = None,
    points: Annotated[int | None, typer.Option(help="Frequencies; default 73.")] = None,
    axis: Annotated[
        Literal["roll", "pitch", "yaw"] | None, typer.Option(help="Axis of the motion.")
    ] = None,
    amplitude: Annotated[float | None, typer.Option(help="Amplitude, deg.")] = None,
    motion: Annotated[float | None, typer.Option(help="Length of each motion, s.")] = None,
    repetitions: Annotated[
        int | None,
        typer.Option(help="Runs at each frequency, from changed starts; default 16 with --paper."),
    ] = None,
    spread: Annotated[
        float, typer.Option(help="Largest change of an initial offset, as a share of it.")
    ] = 0.1,
    seed: Annotated[int, typer.Option(help="Of the changed starts.")] = 0,
    method: Annotated[
        Literal["dop853", "dp5", "rk4"], typer.Option(help="Integration method.")
    ] = "dop853",
    step: Annotated[float | None, typer.Option(help="Longest step, s.")] = None,
    workers: Annotated[int, typer.Option(help="Processes; -1 takes one for each core.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option(help="Run on the Dask cluster at this address.")
    ] = None,
    out: Annotated[
        Path, typer.Option(help="Folder of the results; a sweep that was stopped goes on there.")
    ] = Path("results/sweep"),
    report: Annotated[
        Path | None,
        typer.Option(help="With --paper: the page (.md), figures beside it; default in --out."),
    ] = None,
    figures: Annotated[
        Literal["png", "svg", "none"], typer.Option(help="Format of the figures.")
    ] = "png",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Amplitudes of platform and cables against frequency: median and range over several starts.

    Example: model sweep --from 2 --to 20 --points 37 --repetitions 4 --workers 2

    Example: model sweep --paper
    """
    if report is not None and (not paper or report.suffix != ".md"):
        raise UsageError(
            f"--report {str(report)!r} is refused", allowed="a name ending in .md, with --paper"
        )
    from cdpr8.rigfile import load_rig
    from model.jobs import Where
    from model.sweep.paper import REPETITIONS

    machine = load_rig(rig)
    plan = _plan(
        machine,
        paper,
        (first, last, points),
        {"axis": axis, "amplitude_deg": amplitude, "motion_s": motion},
        {
            "repetitions": repetitions or (REPETITIONS if paper else 1),
            "spread": spread,
            "seed": seed,
            "method": method,
            "step_s": step,
        },
    )
    out.mkdir(parents=True, exist_ok=True)
    runs = _run(machine, plan, out, Where(workers, scheduler))
    from model.sweep.statistics import by_frequency

    statistics = by_frequency(runs)
    runs.to_csv(out / "runs.csv", index=False, float_format="%.9g")
    statistics.to_csv(out / "amplitudes.csv", index=False, float_format="%.9g")
    written = [out / RUNS, out / "runs.csv", out / "amplitudes.csv"]
    if paper:
        asked = "model sweep --paper" + (f" --rig {rig}" if rig else "")
        page = report or out / "paper.md"
        written += _paper(machine, plan, runs, page, figures, asked)
    elif figures != "none":
        written += _figures(statistics, {}, out, "sweep", figures)
    if as_json:
        terminal.say_json(
            {
                "frequencies": statistics.to_dict(orient="records"),
                "plan": plan.identity() | {"seed": plan.seed},
                "written": [str(path) for path in written],
            }
        )
        return
    _say(machine.name, statistics)
    terminal.say("written: " + ", ".join(str(path) for path in written))


def _plan(
    rig: "Rig",
    paper: bool,
    ends: tuple[float | None, float | None, int | None],
    motion: dict[str, object],
    how: dict[str, Any],
) -> "Plan":
    from pydantic import ValidationError

    from cdpr8.rigfile import Excitation
    from model.sweep.paper import EXCITATION, FREQUENCIES_HZ
    from model.sweep.plan import Plan, grid

    if paper and any(value is not None for value in ends):
        raise UsageError(
            "--paper has its own frequencies", allowed="--from, --to, --points without"
        )
    values = (EXCITATION if paper else rig.excitation).model_dump()
    values |= {key: value for key, value in motion.items() if value is not None}
    try:
        excitation = Excitation.model_validate(values)
    except ValidationError as error:
        fault = error.errors()[0]
        key = ".".join(str(part) for part in fault["loc"]) or "excitation"
        raise UsageError(
            f"{key} {fault['input']!r} is refused" if fault["loc"] else f"{key} is refused",
            allowed=fault["msg"].removeprefix("Value error, "),
        ) from None
    first, last, points = ends
    frequencies = (
        FREQUENCIES_HZ
        if paper
        else grid(
            FREQUENCIES_HZ[0] if first is None else first,
            FREQUENCIES_HZ[-1] if last is None else last,
            len(FREQUENCIES_HZ) if points is None else points,
        )
    )
    return Plan(excitation, frequencies, **how)


def _run(rig: "Rig", plan: "Plan", out: Path, where: Any) -> "pd.DataFrame":
    from model.sweep.run import sweep as runs_of
    from model.sweep.run import warm_up
    from model.sweep.statistics import table

    warm_up(rig, terminal.note)
    count = len(plan.jobs())
    with terminal.progress(f"{count} runs", count) as tick:

        def ticking() -> Any:
            for numbered in runs_of(rig, plan, results=out / RUNS, where=where):
                tick()
                yield numbered

        return table(ticking())


def _figures(
    statistics: "pd.DataFrame", marks: Any, folder: Path, prefix: str, ending: str
) -> list[Path]:
    from model.sweep.figures import cable_figure, platform_figure, write_figure

    folder.mkdir(parents=True, exist_ok=True)
    return [
        write_figure(platform_figure(statistics, marks), folder / f"{prefix}_fig4.{ending}"),
        write_figure(cable_figure(statistics, marks), folder / f"{prefix}_fig5.{ending}"),
    ]


def _paper(
    rig: "Rig",
    plan: "Plan",
    runs: "pd.DataFrame",
    page: Path,
    ending: str,
    asked: str,
) -> list[Path]:
    """Table II and Figs. 6 to 9, and the page that compares."""
    from model.sweep import figures as draw
    from model.sweep.page import marks, text
    from model.sweep.paper import COMPARED_HZ, SHOWN_HZ, run_shown
    from model.sweep.statistics import by_frequency

    shown = run_shown(rig)
    page.parent.mkdir(parents=True, exist_ok=True)
    drawn: list[tuple[str, Path]] = []
    if ending != "none":
        folder = page.parent / "figures"
        four, five = _figures(by_frequency(runs), marks(), folder, "paper", ending)
        drawn = [
            ("Fig. 4: deviation of the platform from X*", four),
            ("Fig. 5: amplitudes of the cables", five),
        ]
        for number, frequency in zip((6, 7), COMPARED_HZ, strict=True):
            caption = f"Fig. {number}: pitch at {frequency:g} Hz"
            figure = draw.pitch_series_figure(
                shown.with_effect[frequency], shown.without_effect[frequency], caption
            )
            path = folder / f"paper_fig{number}.{ending}"
            drawn.append((caption, draw.write_figure(figure, path)))
        violent = {frequency: shown.with_effect[frequency] for frequency in SHOWN_HZ}
        cable = draw.SHOWN_CABLE
        for number, caption, figure in (
            (8, "Fig. 8: phase diagrams of the pitch", draw.pitch_phase_figure(violent)),
            (
                9,
                f"Fig. 9: phase diagrams of cable {cable}",
                draw.cable_phase_figure(violent, cable),
            ),
        ):
            path = folder / f"paper_fig{number}.{ending}"
            drawn.append((caption, draw.write_figure(figure, path)))
    page.write_text(
        text(
            runs,
            shown,
            rig=rig.name,
            command=asked,
            spread=plan.spread,
            figures=[
                (caption, path.relative_to(page.parent).as_posix()) for caption, path in drawn
            ],
        ),
        encoding="utf-8",
    )
    return [page, *(path for _, path in drawn)]


def _say(name: str, statistics: "pd.DataFrame") -> None:
    from rich.table import Table

    runs = int(statistics["runs"].max())
    terminal.say(f"{name}: largest deviations from X*, median (range) of {runs} runs a frequency")
    shown = Table("f, Hz", "displacement, mm", "rotation, deg", "max |pitch|, deg", "cable, mm", "")
    stride = -(-len(statistics) // SHOWN_ROWS)
    for row in statistics.iloc[::stride].to_dict(orient="records"):
        cells = [
            f"{row[f'{name}_median']:.2f}"
            + (f" ({row[f'{name}_low']:.2f} to {row[f'{name}_high']:.2f})" if runs > 1 else "")
            for name in ("displacement_mm", "rotation_deg", "max_pitch_deg", "cable_mm")
        ]
        ended = [f"{row[word]} {word}" for word in ("slack", "blow_up") if row[word]]
        shown.add_row(f"{row['frequency_hz']:g}", *cells, ", ".join(ended))
    terminal.say_table(shown)
