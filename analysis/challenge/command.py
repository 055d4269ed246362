"""`analysis challenge`: make runs with concealed physics, diagnose them blind, score."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from cdpr8.terminal import note, progress, say, say_json, say_table

app = typer.Typer(
    no_args_is_help=True,
    help="Blind tests of the diagnosis. Example: analysis challenge make --n 24 --seed 1 OUT",
)

Folder = Annotated[Path, typer.Argument(help="folder of the challenge", show_default=False)]
Workers = Annotated[int, typer.Option(help="processes; -1: one for each core")]
Scheduler = Annotated[str | None, typer.Option(help="address of a Dask scheduler")]


@app.command()
def make(
    out: Folder,
    n: Annotated[int, typer.Option(min=1, help="number of cases")] = 240,
    seed: Annotated[int, typer.Option(min=0, help="all the randomness")] = 0,
    plant: Annotated[
        Literal["mujoco", "outsider"], typer.Option(help="which of two independent plants")
    ] = "mujoco",
    rivals: Annotated[
        bool, typer.Option(help="find out which effects could be told apart (takes half the time)")
    ] = True,
    kind: Annotated[
        Literal["both", "single", "campaign"], typer.Option(help="single runs, campaigns or both")
    ] = "both",
    workers: Workers = 1,
    scheduler: Scheduler = None,
) -> None:
    """Make runs with concealed effects; what they are is sealed.

    Example: analysis challenge make --n 24 --seed 1 challenge
    """
    if plant == "mujoco":
        _engine_there()
    from analysis.challenge.draw import KINDS
    from analysis.challenge.make import make as make_all
    from model.jobs import Where

    kinds = KINDS if kind == "both" else (kind,)
    where = Where(workers, scheduler)
    with progress("making", n) as step:
        digest = make_all(
            out, n, seed, plant=plant, rivals=rivals, kinds=kinds, where=where, step=step
        )
    say(f"{n} cases in {out}; the truth is sealed with SHA-256 {digest}")


def _engine_there() -> None:
    """The first plant needs MuJoCo, which is an extra."""
    from importlib.util import find_spec

    from cdpr8.errors import UsageError

    if find_spec("mujoco") is None:
        raise UsageError(
            "the plant needs MuJoCo, which is not installed",
            remedy="pip install 'cdpr8[challenge]', or --plant outsider",
        )


@app.command()
def run(
    out: Folder,
    seed: Annotated[int, typer.Option(min=0, help="of the diagnosis")] = 0,
    workers: Workers = 1,
    scheduler: Scheduler = None,
    again: Annotated[bool, typer.Option("--again", help="forget the answers there are")] = False,
) -> None:
    """Diagnose every case blind; go on where it was interrupted.

    Example: analysis challenge run challenge --workers -1
    """
    from analysis.challenge.run import run as run_all
    from analysis.challenge.seal import read_index
    from model.jobs import Where

    count = len(read_index(out)["cases"])
    with progress("diagnosing", count) as step:
        failed = run_all(out, where=Where(workers, scheduler), seed=seed, again=again, step=step)
    say(f"{count} cases diagnosed" + (f", {failed} of them ended in an error" if failed else ""))


@app.command()
def score(
    out: Folder,
    report: Annotated[Path | None, typer.Option(help="write the page of the proof here")] = None,
    remark: Annotated[str, typer.Option(help="what readers of that page must know")] = "",
    keep: Annotated[
        Path | None, typer.Option(help="keep truth and answers in this file, for `pool`")
    ] = None,
    engine: Annotated[str, typer.Option(help="what diagnosed them, for that file")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="results as JSON")] = False,
) -> None:
    """Open the seal and hold the answers against the truth.

    Example: analysis challenge score challenge --report docs/proof.md
    """
    from analysis.challenge.score import as_dictionary, write_score
    from analysis.challenge.score import score as score_all

    found = score_all(out)
    written = write_score(found, out)
    if report is not None:
        from analysis.challenge.report import write_report

        written += write_report(found, report, remark)
    if keep is not None:
        from analysis.challenge.kept import keep as keep_all

        keep_all(out, keep, engine)
        written.append(keep)
    if as_json:
        say_json(as_dictionary(found))
    else:
        from analysis.challenge.table import printed

        say_table(printed(found.rows))
    note("written: " + ", ".join(str(path) for path in written))


@app.command()
def pool(
    files: Annotated[list[Path], typer.Argument(help="sets kept by score --keep, oldest first")],
    report: Annotated[Path | None, typer.Option(help="write the page of all sets here")] = None,
) -> None:
    """Grade all sets that were kept, together.

    Example: analysis challenge pool docs/proof/*.json --report docs/proof-pooled.md
    """
    from analysis.challenge.kept import read_kept
    from analysis.challenge.pool import pooled, write_page
    from analysis.challenge.table import printed

    sets = [read_kept(file) for file in files]
    say_table(printed(pooled(sets)))
    if report is not None:
        note("written: " + ", ".join(str(path) for path in write_page(sets, report)))
