"""`analysis stiffness`: the paper's own step, cable stiffnesses from a low-frequency run."""

from pathlib import Path
from typing import Annotated

import typer

from analysis.recordings import load_recordings
from cdpr8.terminal import note, say, say_json, say_table


def stiffness(
    runs: Annotated[
        list[str],
        typer.Argument(help="run folders, or their names; of one machine", show_default=False),
    ],
    rig: Annotated[
        Path | None,
        typer.Option(help="geometry from this rig file, and the values go into a copy of it"),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="results as JSON")] = False,
) -> None:
    """Cable stiffnesses from tension over elongation, into a rig file.

    The elongation follows from the measured pose. Use a slow run (2 Hz or less) that moves every
    cable; several runs, along other axes or faster, tell more. docs/stiffness.md says what the
    uncertainty holds and what biases the values.

    Example: analysis stiffness run01
    """
    from analysis.stiffness import stiffnesses
    from analysis.stiffness_file import FILE, as_dictionary, table, write_rig
    from cdpr8.rigfile import load_rig
    from cdpr8.runfolder import find_run, results_folder

    chosen = load_rig(rig) if rig is not None else None
    recordings = load_recordings([find_run(name) for name in runs], chosen)
    found = stiffnesses(recordings)
    results = results_folder(recordings[0].run.folder)
    own = rig if rig is not None else recordings[0].run.folder / "rig.toml"
    written = write_rig(found, own, results / FILE)
    if as_json:
        say_json(as_dictionary(found, written))
    else:
        say_table(table(found))
        for text in found.warnings:
            say(f"note: {text}\n")
    note(f"results: {written}")
