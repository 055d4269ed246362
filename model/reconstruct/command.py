"""The command `model reconstruct`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8 import terminal
from cdpr8.errors import UsageError

if TYPE_CHECKING:
    from model.reconstruct.journal import Member
    from model.reconstruct.layout import Layout
    from model.sweep.report import Line

JOURNAL = "journal.jsonl"
WRITTEN = "reconstructed.toml"

FINALISTS = 8
"""So many of the best are judged again, with as many runs as the sweep has; the best is kept."""


def reconstruct(
    start: Annotated[
        list[Path] | None,
        typer.Option(
            help="Rig files to start from; what is not mechanical is taken from the first. "
            "Default: the packaged CDPR-8."
        ),
    ] = None,
    budget: Annotated[float, typer.Option(help="Time to search, s.")] = 600.0,
    generations: Annotated[
        int | None, typer.Option(help="Most generations; default: as the time allows.")
    ] = None,
    population: Annotated[int, typer.Option(help="Machines kept.")] = 64,
    repetitions: Annotated[
        int, typer.Option(help="Runs at 10 and at 14 Hz, from changed starts; the median counts.")
    ] = 3,
    seed: Annotated[int, typer.Option(help="Of the search.")] = 0,
    out: Annotated[
        Path, typer.Option(help="Folder of the results; a search that was stopped goes on there.")
    ] = Path("results/reconstruct"),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Search for the machine of the paper's missing Table I: the one that gives its figures.

    Free are geometry, mass, inertia, pretension, line density and damping of a rig whose sides
    mirror each other, within bounds of what can be built; the published stiffnesses are kept. The
    best machine is written as a rig file, and its figures are shown beside the published ones.

    Example: model reconstruct --budget 1500 --seed 1
    """
    if budget < 0 or population < 8 or repetitions < 1:
        raise UsageError(
            f"budget {budget:g} s, population {population}, {repetitions} runs",
            allowed="a budget of at least 0 s, a population of at least 8, at least 1 run",
        )
    from cdpr8.rigfile import load_rig, packaged_rig_path
    from model.machine import Machine
    from model.reconstruct.layout import Layout
    from model.reconstruct.misfit import Judge
    from model.reconstruct.search import Plan, search, settled
    from model.sweep.paper import REPETITIONS
    from model.sweep.run import warm_up

    starts = start or [packaged_rig_path()]
    rigs = [load_rig(path) for path in starts]
    layouts = [Layout.of_machine(Machine.from_rig(rig)) for rig in rigs]
    out.mkdir(parents=True, exist_ok=True)
    warm_up(rigs[0], terminal.note)
    plan = Plan(Judge(rigs[0], repetitions), budget, population, seed, generations)
    members = search(layouts, plan, out / JOURNAL, _tell)
    finalists = settled(members[:FINALISTS], Judge(rigs[0], REPETITIONS), layouts[0])
    best = finalists[0]
    text = _rig_text(best, starts[0], seed)
    (out / WRITTEN).write_text(text, encoding="utf-8")
    lines = _looked_at_again(out / WRITTEN)
    nearest = _nearest(members)
    if as_json:
        terminal.say_json(
            {
                "misfit": best.cost,
                "terms": best.terms,
                "figures": [line.as_dict() for line in lines],
                "nearest_of_any": nearest,
                "written": [str(out / WRITTEN), str(out / JOURNAL)],
            }
        )
        return
    _say(best, lines, nearest)
    terminal.say(f"written: {out / WRITTEN}, {out / JOURNAL}")


def _tell(generation: int, best: "Member") -> None:
    terminal.note(f"generation {generation}: misfit {best.cost:.2f}")


def layout_of(member: "Member") -> "Layout":
    """The machine of a member of the population."""
    import numpy as np

    from model.reconstruct.layout import Layout

    return Layout.of_vector(np.array(member.vector), *member.reach)


def _rig_text(best: "Member", pattern: Path, seed: int) -> str:
    from model.reconstruct.rig_text import rig_text

    return rig_text(
        layout_of(best),
        pattern.read_text(encoding="utf-8"),
        name="CDPR-8",
        origin=f"Seed {seed}, misfit {best.cost:.2f}; docs/paper.md has the figures.",
    )


def _looked_at_again(path: Path) -> "list[Line]":
    """The published figures beside those of the rig file as written, solved with care."""
    from cdpr8.rigfile import load_rig
    from model.reconstruct.published import LOW_HZ, PEAKS_HZ
    from model.sweep import Plan, by_frequency, sweep
    from model.sweep.paper import EXCITATION, REPETITIONS
    from model.sweep.report import single_figures
    from model.sweep.statistics import table

    plan = Plan(EXCITATION, (LOW_HZ, *PEAKS_HZ), REPETITIONS)
    return single_figures(by_frequency(table(sweep(load_rig(path), plan))))


def _nearest(members: "list[Member]") -> dict[str, float]:
    """For each violent figure, the ratio nearest to 1 that any machine of the population has."""
    from model.reconstruct.published import VIOLENT

    nearest: dict[str, float] = {}
    for figure in VIOLENT:
        ratios = [
            member.figures[str(figure.frequency_hz)][figure.quantity] / figure.value
            for member in members
            if str(figure.frequency_hz) in member.figures
        ]
        if ratios:
            name = f"{figure.quantity} at {figure.frequency_hz:g} Hz"
            nearest[name] = min(ratios, key=lambda ratio: abs(ratio - 1.0))
    return nearest


def _say(best: "Member", lines: "list[Line]", nearest: dict[str, Any]) -> None:
    from rich.table import Table

    shown = Table("published figure", "paper", "median", "range", "median/paper", "met")
    for line in lines:
        ratio = "" if line.ratio is None else f"{line.ratio:.3f}"
        spread = f"{line.low} to {line.high}"
        shown.add_row(
            line.what.replace("\\", ""),
            line.published,
            line.median,
            spread,
            ratio,
            "yes" if line.met else "no",
        )
    terminal.say_table(shown)
    costly = sorted(best.terms.items(), key=lambda term: -term[1])
    told = ", ".join(f"{name} {cost:.1f}" for name, cost in costly if cost > 0.5)
    terminal.say(f"misfit {best.cost:.2f}: {told or 'nothing above 0.5'}")
    missed = {name: ratio for name, ratio in nearest.items() if abs(ratio - 1.0) > 0.1}
    for name, ratio in missed.items():
        terminal.say(f"no machine of the population gives {name}: the nearest is {ratio:.3g} times")
