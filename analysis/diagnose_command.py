"""`analysis diagnose`: what physics was left out."""

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Annotated

import typer

from analysis.recordings import load_recordings
from cdpr8.crew import USUAL
from cdpr8.terminal import note, say, say_json, say_table, stages

if TYPE_CHECKING:
    from analysis.diagnosis.recording import Recording
    from analysis.diagnosis.results import Result


WIDTH = 100
"""Of a paragraph on a terminal."""


class StopAfter(StrEnum):
    """A stage after which to stop."""

    ALIGN = "align"
    LOCATE = "locate"
    NAME = "name"


def diagnose(
    runs: Annotated[
        list[str],
        typer.Argument(help="run folders, or their names; of one machine", show_default=False),
    ],
    rig: Annotated[
        Path | None, typer.Option(help="simulate this rig file instead of the runs' own")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="results as JSON")] = False,
    stop_after: Annotated[
        StopAfter | None,
        typer.Option(
            help="align: parameters only; locate: where it differs; name: no proof on held-out data"
        ),
    ] = None,
    campaign: Annotated[
        bool,
        typer.Option("--campaign", help="simulate which next experiments would tell most"),
    ] = False,
    effects: Annotated[
        str | None, typer.Option(help="consider these only, with commas between")
    ] = None,
    figures: Annotated[bool, typer.Option(help="draw figures into the results folder")] = True,
    workers: Annotated[int, typer.Option(min=1, help="processes")] = USUAL,
) -> None:
    """Find out what physics the simulation left out, and show that the fit improves.

    Locates where recording and simulation differ, weighs every effect of the library for what it
    explains, names what the runs support (or says that they cannot tell), writes a rig file with it
    switched on, and proves it on data that were held out. docs/diagnose.md has what the words mean.

    Example: analysis diagnose run01
    """
    from analysis.diagnosis.results import write
    from cdpr8.rigfile import load_rig
    from cdpr8.runfolder import find_run, results_folder
    from model import compile_solver

    chosen = _effects(effects)
    machine = load_rig(rig) if rig is not None else None
    folders = [find_run(name) for name in runs]
    recordings = load_recordings(folders, machine, workers)
    compile_solver(note)
    folder = results_folder(recordings[0].run.folder)
    result = run_diagnosis(
        recordings, folder, effects=chosen, stop_after=stop_after, campaign=campaign,
        workers=workers,
    )  # fmt: skip
    write(result, folder)
    if figures and result.pictures is not None:
        from analysis.diagnosis.figures import write_figures

        write_figures(result.statement, result.pictures, folder, workers)
    for text in result.statement["notes"]:
        note(f"note: {text}")
    if as_json:
        say_json(result.statement)
    else:
        _print(result, stop_after)
    note(
        f"results: {folder}/diagnose.json, diagnose.md"
        + (", diagnose_*.png, .svg" if figures else "")
        + (", improved.toml" if result.statement["improved_rig"] else "")
    )


def _effects(asked: str | None) -> list[str] | None:
    """Names of effects, as asked for."""
    if asked is None:
        return None
    from cdpr8.errors import UsageError
    from model.library.discovery import library

    names = [name.strip() for name in asked.split(",") if name.strip()]
    unknown = [name for name in names if name not in library()]
    if unknown or not names:
        raise UsageError(
            f"no effect is called {', '.join(unknown) or repr(asked)}",
            allowed=", ".join(library()),
            where="--effects",
            remedy="`model effects` lists them",
        )
    return names


def run_diagnosis(
    recordings: "Sequence[Recording]",
    folder: Path,
    *,
    effects: Sequence[str] | None = None,
    stop_after: StopAfter | None = None,
    campaign: bool = False,
    workers: int = 2,
) -> "Result":
    """Diagnose with progress shown, and add what words and figures tell.

    Parameters
    ----------
    recordings
        The runs.
    folder
        Takes improved.toml.
    effects, stop_after, campaign, workers
        As the options.
    """
    from analysis.diagnosis.results import complete, with_experiments
    from analysis.diagnosis.run import diagnose_recordings

    with stages() as tell:
        found = diagnose_recordings(
            recordings,
            results=folder,
            effects=effects,
            stop_after=stop_after.value if stop_after else None,
            workers=workers,
            tell=tell,
        )
        result = complete(found)
        judgement = found.diagnosis.judgement
        if judgement is not None:
            from analysis.diagnosis import experiments

            # What cannot be told apart always gets the experiment that would.
            looked = None
            if campaign or judgement.verdict == "ambiguous":
                looked = experiments.survey(found.machine, found.diagnosis, workers, tell)
            result = with_experiments(
                result,
                experiments.next_experiment(found.machine, found.diagnosis, looked, folder),
                experiments.campaign(found.machine, looked, folder) if campaign and looked else [],
            )
    return result


def _print(result: "Result", stop_after: StopAfter | None) -> None:
    from analysis.diagnosis.results import names
    from analysis.diagnosis.tables import located, parameters, tables

    said = result.statement
    if stop_after in (StopAfter.ALIGN, StopAfter.LOCATE):
        say(fill(f"{names(said)}: {said['words'][0]['text']}", WIDTH) + "\n")
        shown = parameters(said) if stop_after is StopAfter.ALIGN else located(said)
        if shown.rows:
            say_table(shown.printed())
        return
    say(f"{names(said)}: {said['verdict']}\n")
    for one in said["words"]:
        say(fill(f"{one['heading']}. {one['text']}", WIDTH) + "\n")
    for table in tables(said):
        say_table(table.printed())
