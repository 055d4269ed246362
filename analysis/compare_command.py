"""`analysis compare`: a run against its simulation."""

import json
from pathlib import Path
from typing import Annotated

import typer

from cdpr8.terminal import note, progress, say, say_json, say_table


def compare(
    run: Annotated[str, typer.Argument(help="a run folder, or its name", show_default=False)],
    rig: Annotated[
        Path | None, typer.Option(help="simulate this rig file instead of the run's own")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="results as JSON")] = False,
    seed: Annotated[int, typer.Option(help="of the draws that tell what noise allows")] = 0,
    figures: Annotated[bool, typer.Option(help="draw figures into the results folder")] = True,
) -> None:
    """Simulate a run's excitation and tell where it and the recording differ.

    Amplitudes are the paper's: the largest absolute variation about rest in the steady window;
    relative error = |simulated - measured| / measured.

    Example: analysis compare run01
    """
    from analysis.compare import compare as compare_run
    from analysis.comparison_table import as_dictionary, frequency_table, table, verdict
    from analysis.tracking import poses_of
    from cdpr8.crew import USUAL
    from cdpr8.rigfile import load_rig
    from cdpr8.runfolder import find_run, load_run, results_folder
    from model import compile_solver

    chosen = load_rig(rig) if rig is not None else None
    recorded = load_run(find_run(run))
    noticed: list[str] = []
    if recorded.pose is None and recorded.video is not None:
        note(f"{recorded.name} has no pose.csv: tracking its video")
    with progress("tracking", len(recorded.frames)) as step:
        poses = poses_of(recorded, noticed, step, USUAL)
    compile_solver(note)
    comparison = compare_run(recorded, poses, chosen, rig_name=str(rig), notes=noticed, seed=seed)
    results = results_folder(recorded.folder)
    results.mkdir(parents=True, exist_ok=True)
    dictionary = as_dictionary(comparison)
    for warning in comparison.warnings:
        note(f"note: {warning}")
    if as_json:
        say_json(dictionary)
    else:
        say_table(table(comparison))
        say_table(frequency_table(comparison))
        say(verdict(comparison))
    if figures:
        from analysis.comparison_figures import write_figures

        write_figures(comparison, results)
    (results / "compare.json").write_text(json.dumps(dictionary, indent=1) + "\n")
    note(f"results: {results}/compare.json" + (" and compare_*.png, .svg" if figures else ""))
